"""Granular load without an engine: poses and velocities of bodies in, wrenches out, accepted steps, a history.

All engines use it, and a script may use it by itself. In this example a plate of 0.1 m by 0.1 m is pressed 20 mm deep
into poppy seeds at 0.1 m/s:

    >>> import numpy as np
    >>> from granular_contact import preset
    >>> from granular_contact.sand.contact_lines import Body, polyline
    >>> from granular_contact.sand.load import GranularLoad
    >>> load = GranularLoad(preset("poppy_seeds_loose"), surface=0.0)
    >>> plate = Body("plate", [0, 1, 2])  # places of its x, y and angle among the coordinates
    >>> load.add(polyline(plate, [[-0.05, 0.0], [0.05, 0.0]], width=0.1))
    >>> pose, velocity, step = np.zeros(3), np.array([0.0, -0.1, 0.0]), 1e-3
    >>> load.start(pose)
    >>> load.accept(0.0, pose, velocity)
    >>> for i in range(200):
    ...     pose += step * velocity
    ...     load.accept((i + 1) * step, pose, velocity)
    >>> wrench = load.force(pose, velocity, np.zeros(3))
    >>> print(f"force {wrench[1]:.2f} N, work {load.history.work[-1]:.4f} J")
    force 50.80 N, work -0.5080 J

contact_lines   stations along the boundaries of shapes in the plane; a new shape is a function here
line_checks     checks of sizes and points
batch           contact lines in one medium, evaluated in one compiled call
load            all batches: forces, tangent, accepted steps; compiled_load: the functions that it calls
history, state  rows of accepted steps; everything on which a later step depends
work            correction of the work of a history, from the motion
bed_arguments   checks of the arguments of a bed
from_scene      the load of a scene
steady          force on a body in steady motion, without a run
rolling         start of a single-wheel test, in steady rolling
space           bodies in space
"""
