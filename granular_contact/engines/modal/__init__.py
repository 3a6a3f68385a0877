"""The pendulum in a few coordinates: the angle of a rigid root, and modes of the one flexible link clamped to it.

model     Scene -> Model: whether a scene can be reduced, and its parts in coordinates at the pivot
modes     clamped-free modes and their integrals
arrays    Model -> records and stations for the kernels
marching  state of a solve, marched by an embedded Runge-Kutta pair
solve     Model -> Trajectory: from regime to regime of the static law
batch     many models -> their summaries, by one compiled call
extremes  rows of runs -> greatest depths and deflections, and touches
energies  rows of runs -> energies
observe   Trajectory -> the columns that runs of the engine have

Equations: `kernels.pendulum`; the true sign and its regimes: `kernels.slip`; forces of the medium: package `sand`.
"""
