"""Points and lines in the plane, triangles and rotations in space, of no body in particular.

polygon, surface      outlines; the free surface
mesh, mesh_quality    triangles and their files; closed, outward, in one piece
rotations             matrices, roll-pitch-yaw, quaternions
"""
