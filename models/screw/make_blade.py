"""Writes blade.stl, the helical blade of the screw: a thin sheet around z, right-handed.

python models/screw/make_blade.py
"""

from __future__ import annotations

import math
import struct
from pathlib import Path

INNER, OUTER, PITCH, TURNS, EACH = 0.005, 0.02, 0.025, 3, 24  # m, m, m, turns, pieces of a turn


def corner(step: int, radius: float) -> tuple[float, float, float]:
    """Point (m) of the blade after so many pieces, at a radius (m)."""
    angle = 2.0 * math.pi * step / EACH
    x, y = (round(radius * ratio, 12) + 0.0 for ratio in (math.cos(angle), math.sin(angle)))  # no round-off, no -0
    return x, y, PITCH * step / EACH


def main() -> None:
    """Write the file beside this one, as binary STL in metres."""
    faces = []
    for step in range(TURNS * EACH):
        a, b = corner(step, INNER), corner(step, OUTER)
        c, d = corner(step + 1, OUTER), corner(step + 1, INNER)
        faces += [(a, b, c), (a, c, d)]
    rows = [struct.pack("<12fH", 0.0, 0.0, 0.0, *(x for point in face for x in point), 0) for face in faces]
    head = b"helical blade, written by make_blade.py; metres".ljust(80)
    Path(__file__).with_name("blade.stl").write_bytes(head + struct.pack("<I", len(rows)) + b"".join(rows))


if __name__ == "__main__":
    main()
