"""The engine Exudyn: the only room that imports it. Scene -> System -> Trajectory -> Observation.

door      bed                               `GranularBed`, for Exudyn scripts of any kind
          bodies, coupling, overlay         which bodies can carry a bed; how its forces get into a system, and when
building  build, joints, mass_and_gravity   Scene -> System: bodies, joints, weights
          system, omissions                 what is where in it; what it leaves out
joints    coordinates, constraints          their coordinates, what they hold
          joint_actions, joint_loads, reactions   springs, stops, friction, drives; forces of prescribed motions
solving   settings, scheme, stepping        tolerances; the integrator; choice of steps
          predictor                         where Newton's method begins
          solve, recorder, ending           the steps; what is kept of each, and when it ends; how it ended
          engine_checks                     what the engine lets us do, tried once
          settle, balance                   static equilibrium before the start
          state, tangent, views             pauses and going back; the engine's Jacobian; its vectors
reading   kinematics, senses, depths        positions and rates of a trajectory, of an instant; depths
          freedoms                          how a mechanism can depart from its motion
          observe, mechanism, wheels        Trajectory -> Observation; what mechanisms and wheels have besides
          joint_history, beam_energy                energies and works
          accuracy, drive_error, strip_error        warnings about steps, drives and strips
          strip_departure                   what strips of another length would change
          view                              Exudyn's own viewer
space     mechanisms in space: the same names again, where they differ
"""
