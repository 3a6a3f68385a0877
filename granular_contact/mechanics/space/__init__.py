"""Mechanisms in space: rigid bodies with Euler parameters, joints between them, flexible links of such bodies.

system        the System in space, with the handles of its bodies
coordinates   coordinates of hinges, sliders and ball joints, along which springs, stops, friction and drives act
kinematics    positions, orientations, rates of bodies and joints along a trajectory
beams         flexible links: rotations between their elements, energies, deflection
constraints   constraints of joints on accelerations
wheels        slip, sinkage and forces of wheels
facet_departure   error of a motion by the size of facets
freedoms      degrees of freedom along a motion
mode_error    error of links in a few modes
facet_sizes   sizes of facets and their error, for summaries
observe, sensors   Trajectory, or one instant, in columns of three dimensions

The solve itself, step-size control, recording and the detection of rest are those of the plane.
"""
