"""The granular load without an engine: poses and velocities of bodies in, wrenches out, steps accepted, a history kept.

Doors to engines stand on it (`multibody`, `minimal`), and a script may use it as it is. A plate of 0.1 m by
0.1 m, pressed 20 mm deep into poppy seeds at 0.1 m/s:

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

contact_lines   shapes -> stations along what the medium meets; a new shape is a function here
batch           lines of one kind in one compiled call; other elements (facets in space) would be batches of their own
load            all batches: force, tangent, accepted steps
history, state  what was done, step by step; all that a later step depends on
work            what steps leave open, from a history and the motion
given, of_scene     what a bed is made of, from arguments and from a scene
steady          the force on a body that moves steadily, without a run
rolling         the start of a single-wheel test, in steady motion
space           bodies in space
"""
