"""Constants of generalised-alpha, modified Newton and Anderson acceleration, the same for every engine and scene.

Scheme: Chung and Hulbert (1993) in the form of Arnold and Bruels (2007), second order. Modified Newton keeps its
Jacobian over steps. All constants are without unit. `validation/numerics.py` changes most of them and measures
what they do; its page is in docs/studies. Constants of step-size control: `mechanics.stepping` and `step_choice`.
"""

from __future__ import annotations

# ---- scheme ----

# Spectral radius at infinite frequency, for fixed steps.
SPECTRAL_RADIUS = 0.9
# The same where the step size is controlled, or a signal prescribes a motion. Both excite an oscillation of the
# accelerations, which decays by the spectral radius in each step. At 0.9 a chain of 8 links takes 1520 steps in place
# of 325, because the step-size control takes the oscillation for jumps of the force.
DAMPED_SPECTRAL_RADIUS = 0.5
# The same for links whose elastic forces have a round-off above 1e-3 of all forces: their accelerations are noise.
NOISE_SPECTRAL_RADIUS = 0.0

# ---- modified Newton ----

# Residual that the engine allows in space, over the residual in the plane. It holds for constraints of positions and
# directions too, and their residual over the step length is an error of the speed. With 1 in its place shipped runs
# take 0.4 to 0.7 times the iterations and move alike, but the energy imbalance of thrown bodies is 3e-4 in place of
# below 1e-4.
CLOSER = 1e-3
# Residual allowed at the end of a step, over the forces of the scene.
TOLERANCE = 1e-5
# The same over `solver.accuracy`, where the step size is controlled; the engine takes TOLERANCE if that is smaller. The
# residual is much the same from step to step, so it acts like a force. With 1 in its place a double pendulum by the
# engine had 1.5 times the error asked for, and a free tree in space 12 times. Of 196 random trees at accuracy 1e-2 two
# to four miss the accuracy, depending on rounding; with 0.1 five miss it, at 9 % fewer iterations.
OF_ACCURACY = 2e-2
# Ratio of two successive changes (in the engine: residuals) above which the Jacobian is renewed. With 0.25 (links that
# bend) or 0.6 (rigid links) shipped runs take -2 to 8 % more iterations.
CONTRACTION = 0.5
# Iterations after which a step is halved.
MOST_ITERATIONS = 20
# Shortest step after failed iterations or refused steps, over the usual step.
SHORTEST = 1e-4

# ---- Anderson acceleration ----

# Greatest number of pairs of iterations that are kept.
DEPTH = 6
# Regularisation of the least-squares problem, over the squared length of each column.
REGULARISATION = 1e-3
# Differences smaller than this share of the present change are left out. Where two iterations agree in all motion to
# round-off but not yet in constraint forces, the extrapolated constraint forces would diverge.
LEAST_DIFFERENCE = 0.1
