"""Many runs for one answer: compared, swept, fitted.

compare, compare_media   one config by several models, in several media
processes                workers on this machine
sweep                    cases of a config on these, or on a cluster
ensemble, optimise       seeds of scatter; the best numbers: on the workers of sweeps
fit                      coefficients from measurements
"""
