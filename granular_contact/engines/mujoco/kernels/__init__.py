"""Compiled code of forces that are implicit in a step of MuJoCo.

added_mass, planar_added_mass, space_added_mass, floor_added_mass, facets_added_mass    inertia that the sand adds
held_step                                                                               the order of a step
"""
