"""Coefficients from measurements: configs and data of many runs -> parameters, their errors, and warnings about them.

specification             a fit file, or the command line in its place -> what is asked for
measurements              names and units of what was measured; CSV files; how faults of all steps are gathered
force_tests               the same of force tests: tables of forces against depth or speed, checked by the law
law_alone                 a force test by the law, without a run
parameters                keys of a config -> start, bounds and scale
prepare, checks           all of it read and checked -> Problem
problem, responses        parameters -> curves of every run
solve                     least squares from many starts, weighted by the noise that is left; central differences
uncertainty, goodness     errors, what can't be distinguished; whether residuals are noise
diagnostics               estimates of noise, and other checks of the data
scatter                   scatter of grains, separated from noise and coefficients in force tests
fitting                   Fit, and what is implausible about it: units, media that differ
writing                   the medium found; fit.json, medium.yaml, residuals.csv and figures
"""

from granular_contact.studies.fit.fitting import Fit, fit
from granular_contact.studies.fit.prepare import prepare
from granular_contact.studies.fit.specification import Specification, load_specification, specification
from granular_contact.studies.fit.writing import write

__all__ = ["Fit", "Specification", "fit", "load_specification", "prepare", "specification", "write"]
