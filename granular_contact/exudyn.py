"""Importing this module adds the method `CreateGranularBed` to Exudyn's systems, beside `CreateRigidBody`.

import granular_contact.exudyn

bed = mbs.CreateGranularBed("play_sand", surface=0.0)  # a GranularBed
"""

from granular_contact.engines.exudyn.bed import GranularBed
from granular_contact.engines.exudyn.created import bind

__all__ = ["GranularBed"]

bind()
