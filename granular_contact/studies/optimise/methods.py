"""Which numbers are tried next. All parameters run from 0 to 1 here, over their ranges and on their scales."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from importlib import metadata
from typing import Any

import numpy as np

from granular_contact.config.schema.optimise import OptimiseFile
from granular_contact.errors import MissingPackageError

SPREAD = 0.25  # of the first generation of CMA, a quarter of each range
MISSING = "method: cma needs the package cma: pip install 'granular-contact[optimise]', or take differential_evolution"
Generation = Sequence[Sequence[float]]
Evaluate = Callable[[Generation], list[float]]


class Spent(Exception):
    """All runs that a search may take are taken."""


def packages(file: OptimiseFile) -> dict[str, str]:
    """Versions of what draws the numbers; another version would draw others.

    Raises
    ------
    MissingPackageError
        The method's package is not there.
    """
    if file.method == "differential_evolution":
        return {"scipy": metadata.version("scipy")}
    try:
        return {"cma": metadata.version("cma")}
    except metadata.PackageNotFoundError:
        raise MissingPackageError(MISSING) from None


def look(file: OptimiseFile, start: Sequence[float], evaluate: Evaluate) -> str:
    """Let the method of a search look from a start, until `evaluate` raises Spent; or why it ended before."""
    method = {"cma": _cma, "differential_evolution": _differential_evolution}[file.method]
    try:
        return method(np.array(start), file.size, file.seed, evaluate)
    except Spent:
        return ""


def _cma(start: Any, size: int, seed: int, evaluate: Evaluate) -> str:
    """Covariance matrix adaptation (Hansen & Ostermeier 2001), by the package of its author."""
    cma: Any = importlib.import_module("cma")
    options = {
        "bounds": [0.0, 1.0],
        "popsize": size,
        "seed": seed + 1,  # 0 is the time of day there
        "maxfevals": np.inf,
        "maxiter": np.inf,
        "verbose": -9,
    }
    before = np.random.get_state()  # noqa: NPY002 (the package draws from it)
    try:
        strategy = cma.CMAEvolutionStrategy(start, SPREAD, options)
        while not strategy.stop():
            asked = strategy.ask()
            strategy.tell(asked, evaluate([list(map(float, one)) for one in asked]))
    finally:
        np.random.set_state(before)  # noqa: NPY002
    return f"cma found nothing better to try ({', '.join(strategy.stop())})"


def _differential_evolution(start: Any, size: int, seed: int, evaluate: Evaluate) -> str:
    """Differential evolution (Storn & Price 1997), by scipy; the start is one of the first generation."""
    from scipy.optimize import differential_evolution
    from scipy.stats import qmc

    random = np.random.default_rng(seed)
    first = qmc.LatinHypercube(len(start), rng=random).random(size)
    first[0] = start
    differential_evolution(
        lambda columns: np.array(evaluate(columns.T.tolist())),
        [(0.0, 1.0)] * len(start),
        init=first,
        maxiter=10**9,
        tol=0.0,
        polish=False,
        updating="deferred",
        vectorized=True,
        rng=random,
    )
    return "all of a generation are worth the same"
