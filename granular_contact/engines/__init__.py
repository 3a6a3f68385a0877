"""Engines: each builds a system of a scene, solves it, and hands back an observation. None imports another.

exudyn   any mechanism, by the engine of that name
tree     trees of rigid bodies in the plane, in one coordinate a joint
modal    the pendulum in modal coordinates
mujoco   the bed in a MuJoCo model of the user's own
"""
