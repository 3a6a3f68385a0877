"""Results of a granular load in an Exudyn system: accepted states, history, work and forces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.exudyn.coupling import Coupling
from granular_contact.sand.history import LoadHistory

Vector = NDArray[np.float64]


class Attached:
    """Granular load in an Exudyn system; its properties can be read at any time, during a solve or after it.

    The system's current state counts as accepted for what is read. Vectors are in the frame of the engine: forces in N,
    moments in N m about its origin, right-handed (in the plane positive counter-clockwise).
    """

    coupling: Coupling
    in_space: bool

    @property
    def load_calls(self) -> int:
        """Number of times that the forces of the load were computed."""
        return self.coupling.load_calls

    def accept(self) -> None:
        """Accept the current state of the system as the end of a step; for a post-step function, which knows that."""
        self.coupling.accept()

    def accept_state(self, t: float, q: Vector, v: Vector) -> None:
        """Accept a given state, as `accept` does, without reading it from the engine.

        Parameters
        ----------
        t : float
            Time (s).
        q, v : (n,) array
            All coordinates and rates of the system, float64 and contiguous, as the engine keeps them; not checked.
        """
        self.coupling.accept_state(t, q, v)

    @property
    def history(self) -> LoadHistory:
        """All steps up to the system's current state, which counts as accepted; reading it changes nothing."""
        with self.coupling.present():
            return self.coupling.load.history

    @property
    def accepted(self) -> LoadHistory:
        """The steps accepted so far; safe to read while a solve is under way."""
        return self.coupling.load.history

    @property
    def _last_entry(self) -> LoadHistory:
        """The last entry of the history; the other entries are not copied."""
        with self.coupling.present():
            return self.coupling.load.last

    @property
    def work(self) -> float:
        """Work done by the medium on the bodies (J); its negative is the energy dissipated in the medium."""
        work = self._last_entry.work
        return float(work[-1]) if len(work) else 0.0

    @property
    def terms(self) -> dict[str, Vector]:
        """Resultant x, y (N) and moment about the origin (N m) of each term of the laws: (3,) each, in space (6,)."""
        entry = self._last_entry
        return _by_name(entry.terms, entry.term_names)

    @property
    def bodies(self) -> dict[str, Vector]:
        """Resultant x, y (N) and moment about the origin (N m) on each body: (3,) each, in space (6,)."""
        entry = self._last_entry
        return _by_name(entry.bodies, entry.body_names)

    @property
    def force(self) -> Vector:
        """Resultant force (N) of the medium on all bodies: (2,), in space (3,)."""
        return np.asarray(np.sum([*self.terms.values()], axis=0)[: 3 if self.in_space else 2])


def _by_name(rows: Vector, names: tuple[str, ...]) -> dict[str, Vector]:
    """The last row, with the name of each of its entries; zeros if there is no row."""
    return dict(zip(names, rows[-1] if len(rows) else np.zeros(rows.shape[1:]), strict=True))
