"""What every engine needs of a mechanism, without any engine.

the mechanism   system                  its parts among the coordinates of an engine; trajectories
                kinematics, sensors      positions and rates of a trajectory, of an instant
                coordinates, constraints    coordinates of joints; what they hold
                mass_and_gravity, freedoms  mass and weight; how a mechanism can depart from its motion
                joint_loads, reactions  springs, stops, friction, drives; forces of prescribed motions
the solve       scheme, stepping        the spectral radius of the integrator; choice of steps
                ending                  how a solve ended
what is seen    observe, mechanism, wheels, depths    Trajectory -> Observation
                joint_history, beam_energy            energies and works
                strains                               strains and stresses of links that bend
                accuracy, drive_error, strip_error    warnings about steps, drives and strips
                creep                                 what motion is left when a run ends at rest
                departure, strip_departure            what strips of another length would change
                omissions                             what a run leaves out
kernels   compiled code
space     the same names in space, where they differ
"""
