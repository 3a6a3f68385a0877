"""Mechanics of a mechanism that all engines share, without any engine.

the mechanism   system                  parts in the coordinates of an engine; trajectories
                kinematics, sensors      positions and rates along a trajectory, at an instant
                coordinates, constraints    joint coordinates; constraints on accelerations
                mass_and_gravity, freedoms  mass matrix and weight; degrees of freedom
                joint_loads, reactions  springs, stops, friction, drives; reactions of prescribed motions
the solve       equilibrium             static equilibrium as a start
                scheme, stepping        spectral radius and tolerance; step-size control
                ending                  status at the end of a solve
observation     observe, mechanism, wheels            Trajectory -> Observation
                joint_history, beam_energy            energies and works
                strains                               strains and stresses of flexible links
                accuracy, drive_error, strip_error    warnings about steps, rest, drives, strips
                departure, strip_departure            error of a motion by the length of strips
                omissions                             what a run leaves out
kernels   compiled code
space     the same names in space, where they differ
"""
