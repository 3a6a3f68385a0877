"""Compiled code of trees.

tree_arrays, tree, tree_load         arrays; equations and forces in the plane
space_tree, space_elimination, space_ball_joints, space_load    the same in space
space_modes                          trees in space whose links bend in a few modes
tree_joints                          efforts along coordinates, in both
tree_newton, tree_march, tree_calls  one step; time integration; functions called by address
"""
