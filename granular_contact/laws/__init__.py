"""Laws of resistance: one law, one file, one line in `catalogue`.

law, functions, kinds          what a law is, whether kernels can call it, what it can act on
coefficients, validity         tables of numbers in a law; the range that it was measured in
scalar, surface_pressure       what several laws of balls, and of pressed surfaces, share
floor, layer, static_friction  what else a bed has
gravity                        how coefficients scale with gravity, and what that rests on
repose                         slopes that a medium does not keep
scatter                        the scatter of a medium from a measured force
probe                          forces of a law for figures
presets                        media in files
"""
