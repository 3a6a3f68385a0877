"""Granular load on bodies that move in space: surfaces, bars and balls on rigid bodies.

In this example a cube of 0.1 m is pressed 30 mm deep into sand at 0.1 m/s:

    >>> import numpy as np
    >>> from granular_contact import Rft3d
    >>> from granular_contact.sand.contact_lines import Body
    >>> from granular_contact.sand.space.load import SpatialLoad
    >>> from granular_contact.sand.space.shapes import Box
    >>> load = SpatialLoad(Rft3d(1600, 0.5, 0.3), surface=0.0)
    >>> cube = Body("cube", [0, 1, 2, 3, 4, 5, 6])  # places of its position and four Euler parameters
    >>> load.add_shape(cube, Box((0.1, 0.1, 0.1)))
    >>> pose, velocity = np.array([0, 0, 0.05, 1.0, 0, 0, 0]), np.array([0, 0, -0.1, 0, 0, 0, 0])
    >>> load.start(pose)
    >>> load.accept(0.0, pose, velocity)
    >>> for i in range(300):
    ...     pose += 1e-3 * velocity
    ...     load.accept((i + 1) * 1e-3, pose, velocity)
    >>> print(f"force {load.force(pose, velocity, np.zeros(7))[2]:.2f} N, work {load.history.work[-1]:.4f} J")
    force 246.19 N, work -3.6929 J

shapes      base class of shapes; box, plate, bar; a new shape is a class here. round_shapes: cylinder, sphere, capsule,
            cone; mesh_shape: meshes
beam_shape  pieces of links that bend; cables: pieces of the beams of an engine
elements    rows and clusters of the elements of a shape, as the kernels read them
facets      triangles, parallelograms and patches of round surfaces, and their size
facet_comparison  estimate of the error of a load by its facets
revolution  rings and patches of surfaces of revolution
triangles   cutting of triangles; clusters of neighbours (checks of meshes, and mesh files: `geometry`)
batch       elements of one kind in one medium, evaluated in one compiled call
heights     map of heights of the surface
load        as `sand.load`, in space; from_scene: the load of a scene
"""
