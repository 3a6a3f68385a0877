"""Geometry without bodies: points and lines in the plane, triangles and rotations in space.

polygon, surface      polygons; the free surface
catmull_rom           splines through the points of a map of heights
mesh, mesh_quality    triangles and their files; checks of meshes: closed, outward, in one piece
rotations             rotation matrices, roll-pitch-yaw angles, quaternions
"""
