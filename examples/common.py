"""What the examples share: where their picture goes, and its look."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure


def panels(count: int, **options: Any) -> tuple[Figure, Any]:
    """A figure of some panels side by side."""
    figure = Figure(figsize=(3.6 * count, 2.8), layout="constrained", dpi=120)
    return figure, figure.subplots(1, count, **options)


def save(figure: Figure) -> None:
    """Write the picture of the example that runs, into the folder of --out."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--out", type=Path, default=Path(), help="folder of the picture (the current one)")
    folder = parser.parse_args().out
    figure.savefig(folder / f"{Path(sys.argv[0]).stem}.png")
