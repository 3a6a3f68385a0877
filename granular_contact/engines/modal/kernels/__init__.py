"""Compiled code of the modal pendulum.

modal, modal_motion, modal_load, modal_calls, pendulum, slip, events    its equations
runge_kutta, march, modal_extremes                                      steps, time integration, extremes of the motion
"""
