"""Granular bed for MuJoCo models of users (extra `[mujoco]`); the only room that imports MuJoCo.

    bed = MujocoBed(model, preset("rft3d_sand"), surface=0.0)
    bed.add_geoms("leg_.*")
    while data.time < 10.0:
        data.ctrl[:] = ...
        bed.apply(data)                # once a step, after the controls; or bed.install(), once, before the loop
        mujoco.mj_step(model, data)
    print(bed.of(data).work, bed.of(data).wrenches["leg_1"])

bed           `MujocoBed`: the bodies that the sand acts on, `apply`, `install`
geoms         geoms of a model -> shapes in space, or sections in the plane
checks        warnings of a model in which rigid contacts stand in for the sand, or joints keep bodies from moving
load          the load of `sand` for a bed, and the same with other facets
sand, shared  elements or lines with their kernels, and all else that the data of a model share
bed_data      `BedData`: a bed with one MjData, its steps, forces and work
state         saved states, and the history
step, trial   loads of a step, implicit in it; trial steps of MuJoCo
callback      the bed as MuJoCo's passive callback
facet_error   estimate of the error that the size of facets makes in the work
engine        MuJoCo itself, or how to install it
"""

from granular_contact.engines.mujoco.bed import MujocoBed
from granular_contact.engines.mujoco.bed_data import BedData
from granular_contact.engines.mujoco.state import BedState, History

__all__ = ["BedData", "BedState", "History", "MujocoBed"]
