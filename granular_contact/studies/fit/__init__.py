"""Coefficients from measurements: configs and data of many runs -> parameters, their errors, and warnings about them.

specification, request             a fit file, or the command line in its place -> what is asked for
faults                             how those of all steps are gathered
columns, measurements              names and units of what was measured; CSV files
force_tests, force_checks          the same of force tests: tables of forces against depth or speed
law_alone                          a force test by the law, without a run
parameters                         keys of a config -> start, bounds and scale
prepare, checks                    all of it read and checked -> Problem
problem, responses                 parameters -> curves of every run
jacobian, noise, solve             least squares from many starts, weighted by the noise that is left
uncertainty, goodness, diagnostics errors, what can't be distinguished; whether residuals are noise; other checks
scatter                            scatter of grains, separated from noise and coefficients in force tests
plausible                          coefficients beyond all published ones, forces beyond the law's: units
media_of_runs                      whose medium the coefficients go into, and in what else the media differ
fitting, medium, writing           Fit; the medium found; fit.json, medium.yaml, residuals.csv and figures
"""

from granular_contact.studies.fit.fitting import Fit, fit
from granular_contact.studies.fit.prepare import prepare
from granular_contact.studies.fit.request import Specification
from granular_contact.studies.fit.specification import load_specification, specification
from granular_contact.studies.fit.writing import write

__all__ = ["Fit", "Specification", "fit", "load_specification", "prepare", "specification", "write"]
