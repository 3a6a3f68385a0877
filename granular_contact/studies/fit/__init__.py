"""Fit coefficients to measurements of one or many runs: parameters, standard errors, and warnings about both.

specification             the requested fit, from a fit file or the command line
measurements              names and units of measured columns; tables as numbers; collection of faults
force_tests               the same for force tests: tables of forces against depth or speed, checked with the law
law_alone                 forces of a force test by the law, without a run
parameters                start, bounds and scale of the keys of a config that are fitted
prepare, checks           all inputs read and checked: the `Problem`
problem, responses        curves of every run for given parameters
solve                     weighted least squares from many starting points; derivatives by central differences
uncertainty, goodness     standard errors, parameters that the data can't distinguish; whether residuals are noise
step_bias                 change of the parameters with finer time steps
diagnostics               estimates of noise, and other checks of the data
scatter                   scatter of grains, separated from noise and coefficients in force tests
fitting                   the `Fit`, and warnings about units and media that differ
writing                   the fitted medium; fit.json, medium.yaml, residuals.csv and figures
"""

from granular_contact.studies.fit.fitting import Fit, fit
from granular_contact.studies.fit.prepare import prepare
from granular_contact.studies.fit.specification import Specification, load_specification, specification
from granular_contact.studies.fit.writing import write

__all__ = ["Fit", "Specification", "fit", "load_specification", "prepare", "specification", "write"]
