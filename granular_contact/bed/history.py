"""Rows of a history while it grows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from granular_contact.kernels.law import TERMS
from granular_contact.kernels.runs import COARSER, DEPTH, FIRST, LEFT, LOWEST, RIGHT, SPEED, TIME
from granular_contact.multibody.history import LoadHistory, Vector


class Ledger:
    """Table with the first columns of `kernels.runs`, then the power of each medium, its terms, and bodies.

    blank: a row before anything is added to it.
    """

    def __init__(self, terms: list[int], bodies: int, floor: bool = False) -> None:
        """Terms of each medium, number of bodies; floor: whether the last of the media is the contact of the floor."""
        self.media = len(terms)
        self._floor = floor
        self._terms, self._bodies = terms, bodies
        self.first_term = FIRST + self.media
        self.first_body = self.first_term + 3 * TERMS * self.media
        self.blank = np.zeros(self.first_body + 3 * bodies)
        self.blank[[DEPTH, LOWEST, LEFT, RIGHT]] = -np.inf, np.inf, np.inf, -np.inf
        self._rows = np.zeros((256, len(self.blank)))
        self._work: Vector | None = None
        self._summed = 0, 0.0  # a row, and the work up to it
        self.length = 0

    def columns(self, medium: int, body: int) -> Vector:
        """Where `kernels.runs.accept` adds the power of a medium, its terms and the resultant of a body."""
        return np.array([FIRST + medium, self.first_term + 3 * TERMS * medium, self.first_body + 3 * body])

    def new_row(self, time: float) -> Vector:
        """A blank row at the end, for this time (s)."""
        if self.length == len(self._rows):
            self._rows = np.vstack([self._rows, np.zeros_like(self._rows)])
        if self.length == 0:
            self._summed = 0, 0.0
        row: Vector = self._rows[self.length]
        row[:] = self.blank
        row[TIME] = time
        self.length += 1
        return row

    def adopt(self, rows: Vector, work: Vector) -> None:
        """Take on rows that were filled elsewhere, with the work (n,) J of all media as it was found there."""
        self._rows, self._work, self.length = rows, work, len(rows)

    def last(self, term_names: tuple[str, ...], body_names: tuple[str, ...]) -> LoadHistory:
        """The last row alone, with the work up to it; none where there is none. Does not read the others again."""
        if self._work is not None or self.length < 3:
            return self.history(term_names, body_names).at_end()
        first, before = self._summed
        rows = self._rows[first : self.length]
        work = before + _integral(self._power(rows), rows[:, TIME])
        self._summed = self.length - 2, float(work[-2])  # the last row may be taken back
        return replace(self._read(self._rows[self.length - 1 : self.length], term_names, body_names), work=work[-1:])

    def _power(self, rows: Vector) -> Vector:
        power: Vector = rows[:, FIRST : FIRST + self.media - self._floor].sum(axis=1)
        return power

    def history(self, term_names: tuple[str, ...], body_names: tuple[str, ...]) -> LoadHistory:
        """All rows so far; works that were not brought along are integrals of the power by the trapezoidal rule."""
        return self._read(self._rows[: self.length].copy(), term_names, body_names)

    def _read(self, rows: Vector, term_names: tuple[str, ...], body_names: tuple[str, ...]) -> LoadHistory:
        time, sand, power = rows[:, TIME], FIRST + self.media - self._floor, self._power(rows)
        used = [TERMS * i + k for i, count in enumerate(self._terms) for k in range(count)]
        return LoadHistory(
            time=time,
            work=_integral(power, time) if self._work is None else self._work,
            power=power,
            floor_work=_integral(rows[:, sand : self.first_term].sum(axis=1), time),
            depth=rows[:, DEPTH],
            coarser=rows[:, COARSER : COARSER + 3],
            speed=rows[:, SPEED],
            lowest=rows[:, LOWEST],
            left=rows[:, LEFT],
            right=rows[:, RIGHT],
            terms=rows[:, self.first_term : self.first_body].reshape(len(rows), TERMS * self.media, 3)[:, used],
            bodies=rows[:, self.first_body :].reshape(len(rows), self._bodies, 3),
            term_names=term_names,
            body_names=body_names,
        )


def _integral(power: Vector, time: Vector) -> Vector:
    """Work (n,) J done since the first row by a power (n,) W."""
    steps = 0.5 * np.diff(time) * (power[1:] + power[:-1])
    work: Vector = np.cumsum(np.concatenate([np.zeros(min(len(time), 1)), steps]))
    return work
