"""Points and lines in the plane and triangles in space, of no body in particular.

polygon, surface                 outlines; the free surface
mesh, mesh_file, mesh_quality    triangles; their files; closed, outward, in one piece
"""
