"""The bed in a MuJoCo model of the user's own, see `granular_contact.engines.mujoco` (extra `[mujoco]`)."""

from granular_contact.engines.mujoco import BedData, BedState, History, MujocoBed

__all__ = ["BedData", "BedState", "History", "MujocoBed"]
