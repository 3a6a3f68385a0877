"""Interpolating splines of Catmull and Rom (1974), for numbers and for arrays; kernels compile the same functions."""

from __future__ import annotations

from typing import Any


def weights(t: Any) -> tuple[Any, Any, Any, Any]:
    """Weights of four neighbouring points at a share t of their middle interval."""
    return (
        0.5 * t * (-1.0 + t * (2.0 - t)),
        1.0 + 0.5 * t * t * (3.0 * t - 5.0),
        0.5 * t * (1.0 + t * (4.0 - 3.0 * t)),
        0.5 * t * t * (t - 1.0),
    )


def slopes(t: Any) -> tuple[Any, Any, Any, Any]:
    """Derivatives of `weights` by t."""
    return (
        0.5 * (-1.0 + t * (4.0 - 3.0 * t)),
        0.5 * t * (9.0 * t - 10.0),
        0.5 * (1.0 + t * (8.0 - 9.0 * t)),
        0.5 * t * (3.0 * t - 2.0),
    )
