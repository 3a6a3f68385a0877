"""Laws of resistance: one law is one file and one line in `catalogue`.

law, functions, kinds          what a law is; check of its functions; kinds of shape that it acts on
coefficients, validity         coefficients of a law; the range in which they were measured
scalar, surface_pressure       base classes of laws of balls, and of laws of pressure and sinkage
floor, layer, static_friction  the other parts of a bed
gravity                        scaling of coefficients with gravity, and the evidence for it
repose                         slopes that are steeper than the angle of repose
scatter                        scatter of the resistance, from measured scatter of a force
probe                          forces of a law in steady motion, for figures
presets                        media as YAML files
"""
