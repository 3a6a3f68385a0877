"""Figures that are drawn sooner, where nobody looks at what is on them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from matplotlib.figure import Figure


def _unlaid(figure: Figure) -> Figure:
    """The figure without a layout, which takes as long as drawing it."""
    figure.set_layout_engine("none")
    return figure


@contextmanager
def sketched(dpi: int = 30) -> Iterator[None]:
    """Figures of runs and of studies have few pixels and no layout meanwhile."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("granular_contact.report.figures.DPI", dpi)
        patched.setattr("granular_contact.report.figures._laid_out", _unlaid)
        patched.setattr(
            "granular_contact.report.figures.panels.save", lambda figure, file: _unlaid(figure).savefig(file, dpi=dpi)
        )
        yield
