"""A second door: the bed in a MuJoCo model of the user's own (extra `[mujoco]`).

    bed = MujocoBed(model, preset("rft3d_sand"), surface=0.0)
    bed.add_geoms("leg_.*")
    while data.time < 10.0:
        data.ctrl[:] = ...
        bed.apply(data)                # once a step, after the controls; or bed.install() before the loop
        mujoco.mj_step(model, data)
    print(bed.of(data).work, bed.of(data).wrenches["leg_1"])

bed         the door: what the sand acts on, `apply`, `install`
load        the load of a bed, and once more with other facets
callback    the bed as MuJoCo's passive callback
of_data     what a bed keeps for one MjData: when its steps begin and end, what is read, state and restore
step        the forces of one step, implicit in it
facet_error   what the facets falsify of the work of the sand
trial       a step of MuJoCo that is taken back, with bodies heavier by what the sand adds
shared      what is the same for all data of a model
sand        elements in space and lines in the plane, with the kernels that both doors call
geoms       geoms of a model -> shapes in space, sections in the plane
engine      MuJoCo itself, or how to install it
checks      what of a model doubles the sand, or keeps it from acting
"""

from granular_contact.engines.mujoco.bed import MujocoBed
from granular_contact.engines.mujoco.of_data import BedData
from granular_contact.engines.mujoco.state import BedState, History

__all__ = ["BedData", "BedState", "History", "MujocoBed"]
