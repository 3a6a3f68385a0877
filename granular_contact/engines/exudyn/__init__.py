"""The engine Exudyn: the only room that imports it.

bed, attached                     `GranularBed`, for Exudyn scripts of any kind; what is read of it while it acts
created                           the same as a method of Exudyn's systems: `mbs.CreateGranularBed`
bodies, beams, coupling, overlay  which bodies can carry a bed; how its forces get into a system, and when
build, build_in_space, joints     Scene -> System
joint_actions                     what joints do at an instant
settings, step_control            tolerances; steps that are chosen
predictor                         start of a step, Anderson acceleration
solve, recorder                   the steps; what is kept of each, and when it ends
engine_checks                     what the engine lets us do, tried once
settle, balance                   static equilibrium before the start
state, tangent, views             pauses and going back; the engine's Jacobian; its vectors
viewer                            Exudyn's own viewer
"""
