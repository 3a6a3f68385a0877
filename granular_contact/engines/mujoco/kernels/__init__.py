"""Compiled kernels of forces that are implicit in a step of MuJoCo.

added_mass          the equations: force at the end of a step, and the inertia that the sand adds to a body
planar_added_mass   forces and added inertia of contact lines in a plane
space_added_mass    the same of facets, bars and balls in space; facets_added_mass for all facets of a cluster
floor_added_mass    the same of a floor in space
held_bodies         records of the bodies in sand, and the motion of a body in a step
held_step           the parts of a step, one kernel for each call
"""
