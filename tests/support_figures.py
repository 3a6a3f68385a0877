"""Fast drawing of figures, for tests that do not look at their content."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from matplotlib.figure import Figure


def _unlaid(figure: Figure) -> Figure:
    """Remove the layout engine, which takes as long as drawing the figure."""
    figure.set_layout_engine("none")
    return figure


@contextmanager
def sketched(dpi: int = 30) -> Iterator[None]:
    """Draw figures of runs and studies with few pixels and without layout inside the `with` block."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("granular_contact.report.figures.DPI", dpi)
        patched.setattr("granular_contact.report.figures._laid_out", _unlaid)
        patched.setattr(
            "granular_contact.report.figures.panels.save", lambda figure, file: _unlaid(figure).savefig(file, dpi=dpi)
        )
        yield
