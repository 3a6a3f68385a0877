"""A scenario in space -> the scene that the engine gets, as in the plane with three dimensions.

types       bodies, joints and the scene, as frozen plain data
shapes      shapes of a config -> what the medium meets, triangles to draw; mass_properties: their mass
section     sections of links, their stiffness, elements of links that bend
beams       links that bend -> elements and joints between them
modes       which links can bend in a few of their natural modes, and their shapes
layout      frames and twists of all bodies in a state of the joints; initial states
loops       kinematic loops at the start, and which of their constraints are needed
bed         as in the plane, or a surface from a file of heights
bodies, build   as in `scene`
"""
