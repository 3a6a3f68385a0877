"""Mechanisms in space in the engine: rigid bodies with Euler parameters and joints between them.

build         Scene -> System: bodies, joints, what acts in them, the granular load
system        the System of space, with the handles of its bodies
coordinates   coordinates of hinges and sliders, along which springs, stops, friction and drives act
kinematics    positions, orientations, rates of bodies and joints along a trajectory
beams         links that bend: what is between their elements, energies, deflection
constraints   what joints ask of accelerations
wheels        slip, sinkage and forces of wheels
facet_departure   what larger facets would change
facet_sizes   facets that bodies have, and their error, as they are told
observe, sensors   Trajectory, or one instant, in columns of three dimensions

The solve itself, its choice of steps, what is recorded and finding rest are those of the plane.
"""
