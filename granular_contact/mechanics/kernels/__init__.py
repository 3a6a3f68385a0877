"""Compiled code of mechanics.

joint_coordinates, joint_laws, joint_loads, space_joints    joint coordinates and forces along them
space_rotations, bending                                    rotations; moments between elements of a link, in space
signal_tables                                               signals of drives
numerics, iterations, anderson    constants of the scheme and of Newton's method; acceleration
step_error, step_choice                                     step-size control
"""
