"""Granular bed for MuJoCo models of users (extra `[mujoco]`); an example is in `granular_contact.engines.mujoco`."""

from granular_contact.engines.mujoco import BedData, BedState, History, MujocoBed

__all__ = ["BedData", "BedState", "History", "MujocoBed"]
