"""Compiled code of trees.

tree_arrays, tree, tree_load         their equations
tree_newton, tree_march, tree_calls  their steps
"""
