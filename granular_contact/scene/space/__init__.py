"""Scenario in space -> the scene that an engine gets, as in the plane.

types       bodies, joints and the scene, as frozen plain data
shapes      shapes of a config -> shapes for the medium, triangles to draw; mass_properties: their mass properties
section     sections of links, their stiffness, elements of links that bend
beams       links that bend -> elements and joints between them
modes       links that bend in a few of their natural modes: which ones can, and the modes
layout      poses and velocities of all bodies in a state of the joints; initial states
loops       kinematic loops at the start, and the independent constraints of their closures
bed         surface, layers, floor and container, as in the plane; also a surface from a file of heights
bodies, build   as in `scene`
"""
