"""The pendulum in a few coordinates: the angle of a rigid root, and modes of the one flexible link clamped to it.

model     Scene -> Model: what can be reduced, parts seen from the pivot
modes     clamped-free modes and their integrals
arrays    Model -> records and stations for the kernels
marching  a solve under way, with the project's stepper or one of scipy's
solve     Model -> Trajectory: from regime to regime of the static law
batch     many models -> their summaries, marched by one compiled call
extremes  rows of runs -> greatest depths and deflections, and touches
energies  rows of runs -> energies
observe   Trajectory -> the columns that the engine's runs have

Equations: `kernels.pendulum`; the true sign and its regimes: `kernels.slip`; the medium is that of the engine.
"""
