"""Writes blade.obj, the helical blade of the screw: a thin sheet around z, right-handed.

    python models/screw/make_blade.py
"""

from __future__ import annotations

import math
from pathlib import Path

INNER, OUTER, PITCH, TURNS, EACH = 0.005, 0.02, 0.025, 3, 24  # m, m, m, turns, pieces of a turn


def main() -> None:
    """Write the file beside this one."""
    lines = ["# helical blade, written by make_blade.py; metres"]
    count = TURNS * EACH
    for i in range(count + 1):
        angle, height = 2.0 * math.pi * i / EACH, PITCH * i / EACH
        for radius in (INNER, OUTER):
            lines.append(f"v {radius * math.cos(angle):.7f} {radius * math.sin(angle):.7f} {height:.7f}")
    for i in range(count):
        a, b, c, d = (2 * i + k for k in (1, 2, 4, 3))
        lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    Path(__file__).with_name("blade.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
