"""A granular load once it is in an Exudyn system: which states it takes as accepted, and what can be read of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.exudyn.coupling import Coupling
from granular_contact.sand.history import LoadHistory

Vector = NDArray[np.float64]


class Attached:
    """A load in an Exudyn system; it can be read at any time, during a solve or after it."""

    coupling: Coupling
    in_space: bool

    @property
    def load_calls(self) -> int:
        """How often the engine asked for forces."""
        return self.coupling.load_calls

    def accept(self) -> None:
        """Take the current state of the system as accepted; for callers that know it is (a post-step function)."""
        self.coupling.accept()

    def accept_state(self, t: float, q: Vector, v: Vector) -> None:
        """`accept`, for callers that have the time (s) and all coordinates and rates of the system at hand.

        Parameters
        ----------
        t : float
            Time (s).
        q, v : (n,) array
            Coordinates and rates of the system, float64 and contiguous, as the engine keeps them; not checked.
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
    def _now(self) -> LoadHistory:
        """The last entry of the history, at no more than the cost of one."""
        with self.coupling.present():
            return self.coupling.load.last

    @property
    def work(self) -> float:
        """Work done by the medium on the bodies (J); its negative is the energy dissipated in the medium."""
        work = self._now.work
        return float(work[-1]) if len(work) else 0.0

    @property
    def terms(self) -> dict[str, Vector]:
        """Each term's resultant x, y (N) and moment about the origin (N m) at the end, (3,) each; in space (6,).

        Right-handed about z, as the engine has moments: counter-clockwise is positive. So is all else that a bed gives.
        """
        now = self._now
        return _last(now.terms, now.term_names)

    @property
    def bodies(self) -> dict[str, Vector]:
        """Resultant x, y (N) and moment about the origin (N m) on each named body at the end, (3,), in space (6,)."""
        now = self._now
        return _last(now.bodies, now.body_names)

    @property
    def force(self) -> Vector:
        """Resultant (2,) N, in space (3,), of the medium on all named bodies at the end."""
        return np.asarray(np.sum([*self.terms.values()], axis=0)[: 3 if self.in_space else 2])


def _last(rows: Vector, names: tuple[str, ...]) -> dict[str, Vector]:
    return dict(zip(names, rows[-1] if len(rows) else np.zeros(rows.shape[1:]), strict=True))
