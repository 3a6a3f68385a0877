"""The engine Exudyn: the only room that imports it.

bed, attached                  `GranularBed`, for any Exudyn script; what can be read of it during and after a solve
created                        `GranularBed` as a method of Exudyn's systems, `mbs.CreateGranularBed`
coupling, overlay              coordinates of the engine -> load -> generalised forces in the system; accepted steps
bodies, beams                  bodies and beams of the system that a bed can act on
build, build_in_space, joints  Scene -> System
joint_actions                  forces in joints, and prescribed motions of hinges
settings, step_control         tolerances of Newton's method; steps that are chosen by their error
predictor                      start value of a step, Anderson acceleration
solve, recorder                time integration; accepted states, and when a run stops
engine_checks                  test of undocumented behaviour of Exudyn, once in a process
settle, balance                static equilibrium before the start
state, tangent, views          saved states; the state of the last Jacobian; views of the engine's vectors
viewer                         playback in Exudyn's viewer
"""
