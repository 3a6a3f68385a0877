"""Importing this gives systems of Exudyn a method that makes a `GranularBed`, beside `CreateRigidBody`.

import granular_contact.exudyn

bed = mbs.CreateGranularBed("play_sand", surface=0.0)
"""

from granular_contact.engines.exudyn.bed import GranularBed
from granular_contact.engines.exudyn.created import bind

__all__ = ["GranularBed"]

bind()
