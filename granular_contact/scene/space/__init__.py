"""A scenario in space -> the scene that the engine gets, as in the plane with three dimensions.

types       bodies, joints and the scene, as frozen plain data
shapes      shapes of a config -> what the medium meets, triangles to draw, mass properties
layout      frames and twists of all bodies in a state of the joints
start       initial states of joints
loops       kinematic loops at the start, and which of their constraints are needed
height_map  a surface from a file of heights
bodies, joints, bed, build   as in `scene`
"""
