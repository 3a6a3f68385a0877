"""Figures of the examples: their size, and the file that they are written to."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure


def panels(count: int, **options: Any) -> tuple[Figure, Any]:
    """A figure with `count` panels side by side, and their axes."""
    figure = Figure(figsize=(3.6 * count, 2.8), layout="constrained", dpi=120)
    return figure, figure.subplots(1, count, **options)


def save(figure: Figure) -> None:
    """Write the picture of the running example into the folder of --out."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--out", type=Path, default=Path(), help="folder of the picture (the current one)")
    folder = parser.parse_args().out
    figure.savefig(folder / f"{Path(sys.argv[0]).stem}.png")
