"""Ensembles: one run with many seeds of its medium's scatter, on the workers of sweeps; mean, quantiles, bands.

calls        a run -> the sweep over its seeds; an ensemble from Python
runs         one member in a worker
statistics   rows -> mean, spread, quantiles, bands; these as files and figures
"""

from __future__ import annotations

from granular_contact.studies.ensemble.calls import cases, ensemble
from granular_contact.studies.ensemble.runs import observed
from granular_contact.studies.ensemble.statistics import Numbers, Summary, of_rows

__all__ = ["Numbers", "Summary", "cases", "ensemble", "observed", "of_rows"]
