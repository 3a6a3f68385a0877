"""Rows of a history while it grows."""

from __future__ import annotations

import numpy as np

from granular_contact.kernels.law import TERMS
from granular_contact.kernels.runs import DEPTH, FIRST, LEFT, LOWEST, RIGHT, SPEED, TIME
from granular_contact.multibody.history import LoadHistory, Vector


class Ledger:
    """Table with the first columns of `kernels.runs`, then work and power of each medium, its terms, and bodies."""

    def __init__(self, terms: list[int], bodies: int, floor: bool = False) -> None:
        """Terms of each medium, number of bodies; floor: whether the last of the media is the contact of the floor."""
        self.media = len(terms)
        self._floor = floor
        self._terms, self._bodies = terms, bodies
        self.first_power = FIRST + self.media
        self.first_term = self.first_power + self.media
        self.first_body = self.first_term + 3 * TERMS * self.media
        self._rows = np.zeros((256, self.first_body + 3 * bodies))
        self.length = 0

    def columns(self, medium: int, body: int) -> Vector:
        """Where `kernels.runs.accept` adds the power of a medium, its terms and the resultant of a body."""
        return np.array([self.first_power + medium, self.first_term + 3 * TERMS * medium, self.first_body + 3 * body])

    def new_row(self) -> Vector:
        """An empty row at the end."""
        if self.length == len(self._rows):
            self._rows = np.vstack([self._rows, np.zeros_like(self._rows)])
        row: Vector = self._rows[self.length]
        row[:] = 0.0
        row[DEPTH], row[LOWEST], row[LEFT], row[RIGHT] = -np.inf, np.inf, np.inf, -np.inf
        self.length += 1
        return row

    def close_row(self, time: float) -> None:
        """Date the last row (s) and add up the work done since the row before it, by the trapezoidal rule."""
        row = self._rows[self.length - 1]
        row[TIME] = time
        if self.length > 1:
            last = self._rows[self.length - 2]
            half = 0.5 * (time - last[TIME])
            for work in range(FIRST, self.first_power):
                power = work + self.media
                row[work] = last[work] + half * (row[power] + last[power])

    def adopt(self, rows: Vector) -> None:
        """Take on rows that were filled elsewhere."""
        self._rows, self.length = rows, len(rows)

    def history(self, term_names: tuple[str, ...], body_names: tuple[str, ...]) -> LoadHistory:
        """All rows so far."""
        rows = self._rows[: self.length].copy()
        work, power = rows[:, FIRST : self.first_power], rows[:, self.first_power : self.first_term]
        sand = self.media - self._floor
        used = [TERMS * i + k for i, count in enumerate(self._terms) for k in range(count)]
        return LoadHistory(
            time=rows[:, TIME],
            work=work[:, :sand].sum(axis=1),
            power=power[:, :sand].sum(axis=1),
            floor_work=work[:, -1] if self._floor else np.zeros(self.length),
            depth=rows[:, DEPTH],
            speed=rows[:, SPEED],
            lowest=rows[:, LOWEST],
            left=rows[:, LEFT],
            right=rows[:, RIGHT],
            terms=rows[:, self.first_term : self.first_body].reshape(self.length, TERMS * self.media, 3)[:, used],
            bodies=rows[:, self.first_body :].reshape(self.length, self._bodies, 3),
            term_names=term_names,
            body_names=body_names,
        )
