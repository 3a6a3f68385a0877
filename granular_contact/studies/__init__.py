"""Studies of many runs: comparisons, sweeps, ensembles, optimisation and fits.

compare, compare_media   one config with several models, or in several media
processes                worker processes on this machine
sweep                    cases of a config, run by worker processes or a Dask cluster
ensemble, optimise       runs with many seeds of scatter; the best parameters; both on the workers of sweeps
fit                      coefficients from measurements
"""
