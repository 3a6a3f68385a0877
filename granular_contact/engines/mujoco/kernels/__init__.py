"""Compiled code of forces that are implicit in a step of MuJoCo.

added_mass, planar_added_mass, space_added_mass, floor_added_mass, facets_added_mass    what the sand adds to inertia
held_bodies    what is kept of a body, its motion in a step
held_step      the order of a step
"""
