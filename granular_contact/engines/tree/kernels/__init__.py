"""Compiled code of trees.

tree_arrays, tree, tree_load         equations in the plane
space_tree, space_fold, space_ball_joints, space_load    the same in space
space_modes                          trees in space whose links bend in a few modes
tree_joints                          what acts along coordinates, in both
tree_newton, tree_march, tree_calls  their steps
"""
