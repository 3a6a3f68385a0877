"""Ensembles: a scenario with many seeds of the scatter of its medium, run on the workers of sweeps.

calls        the sweep over the seeds of a scenario; an ensemble from Python
runs         one member of the ensemble, in a worker
statistics   mean, standard deviation, quantiles and bands of the rows; their files and figures
"""

from __future__ import annotations

from granular_contact.studies.ensemble.calls import cases, ensemble
from granular_contact.studies.ensemble.runs import observed
from granular_contact.studies.ensemble.statistics import Numbers, Summary, of_rows

__all__ = ["Numbers", "Summary", "cases", "ensemble", "observed", "of_rows"]
