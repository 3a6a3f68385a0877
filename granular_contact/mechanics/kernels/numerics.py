"""Constants of generalised-alpha, of modified Newton and of Anderson acceleration: all, for every engine and scene.

Scheme: Chung and Hulbert (1993) in the form of Arnold and Bruels (2007), second order. Modified Newton keeps its
Jacobian over steps. None of the constants has a unit. Where `validation/numerics.py` can change one, its page in
docs/studies has the measurement. Constants of the choice of steps: `mechanics.stepping` and `step_choice`.
"""

from __future__ import annotations

# ---- scheme ----

# Spectral radius at infinite frequency, of fixed steps.
SPECTRAL_RADIUS = 0.9
# The same where steps are chosen, or a signal prescribes a motion: both leave an oscillation in the accelerations,
# which fades by the spectral radius a step. At 0.9 a chain of 8 takes 1520 steps in place of 325, as the control takes
# the oscillation for jumps of the force.
DAMPED_SPECTRAL_RADIUS = 0.5
# The same of links whose round-off of elastic forces is above 1e-3 of all forces, so that accelerations are noise.
NOISE_SPECTRAL_RADIUS = 0.0

# ---- modified Newton ----

# In space: residual allowed by the engine, over that in the plane. Constraints of positions and directions share it:
# what is left of them over a step is a speed. With 1 shipped runs take 0.4 to 0.7 times the iterations and move alike,
# but of bodies that are thrown the energy's imbalance is 3e-4 in place of below 1e-4.
CLOSER = 1e-3
# Residual that a step may leave, over the forces of the scene.
TOLERANCE = 1e-5
# The same over `solver.accuracy` where steps are chosen, in minimal coordinates; by the engine at most. What is left is
# much the same from step to step and acts like a force: at once the accuracy a double pendulum by the engine was 1.5
# times off what was asked, a free tree in space 12 times. Of 196 random trees at 1e-2 two to four are off by more than
# is asked, as rounding decides, with 0.1 five, for 9 % of the iterations less.
OF_ACCURACY = 2e-2
# How much of the change before (in the engine: of the residual) an iteration may leave, or the Jacobian is renewed. By
# 0.25 for links that bend and 0.6 for rigid ones iterations of shipped runs change by -2 to 8 %.
CONTRACTION = 0.5
# Iterations after which a step is halved.
MOST_ITERATIONS = 20
# Shortest step that a failing iteration or a refused step may come down to, over the usual one.
SHORTEST = 1e-4

# ---- Anderson acceleration ----

# Pairs of iterations that are kept.
DEPTH = 6
# Regularisation of the least squares, over the square of each difference.
REGULARISATION = 1e-3
# Differences below this share of the present change do not count: where motions agree to round-off and constraint
# forces do not yet, these would run away.
LEAST_DIFFERENCE = 0.1
