"""Friction states of MuJoCo beds: when they advance, several data of one model, restored states, callback, threads."""

from __future__ import annotations

import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from itertools import cycle
from typing import Any

import numpy as np
import pytest
from support_mujoco import SAND, go, model_of, thrown

from granular_contact.errors import SceneError

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
from granular_contact.mujoco import MujocoBed  # noqa: E402

INTEGRATORS = {  # `discrete` from 3.13 on
    name: getattr(mujoco.mjtIntegrator, f"mjINT_{name}")
    for name in ("EULER", "RK4", "IMPLICIT", "IMPLICITFAST", "DISCRETE")
    if hasattr(mujoco.mjtIntegrator, f"mjINT_{name}")
}


def box(step: float = 1e-3, **options: Any) -> tuple[Any, Any, Any]:
    model = model_of(step=step)
    bed = MujocoBed(model, SAND, **options)
    bed.add_geoms("box")
    return model, thrown(model), bed


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_the_callback_does_what_a_call_before_each_step_does(integrator: str) -> None:
    model, data, bed = box()
    model.opt.integrator = INTEGRATORS[integrator]
    go(model, data, bed, 0.12)
    other = thrown(model)
    with bed.install(other):
        mujoco.mj_step(model, other, nstep=60)
        for _ in range(3):
            mujoco.mj_forward(model, other)  # looks at the state, and is no step
        mujoco.mj_step(model, other, nstep=60)
    assert mujoco.get_mjcb_passive() is None
    assert bed.of(other).accepted == bed.of(data).accepted == 119
    np.testing.assert_array_equal(other.qpos, data.qpos)
    assert bed.of(other).work == bed.of(data).work < -0.1


def test_a_restored_state_has_the_same_future_in_any_data() -> None:
    model, data, bed = box(record=True)
    first = data.qpos.copy()
    go(model, data, bed, 0.1)
    kept, whole = bed.of(data).state, mujoco.mjtState.mjSTATE_INTEGRATION
    physics = np.zeros(mujoco.mj_stateSize(model, whole))
    mujoco.mj_getState(model, data, physics, whole)
    go(model, data, bed, 0.05)
    end, work, rows = data.qpos.copy(), bed.of(data).work, bed.of(data).history
    for restored in (data, mujoco.MjData(model)):
        mujoco.mj_setState(model, restored, physics, whole)
        bed.of(restored).restore(kept)
        go(model, restored, bed, 0.05)
        np.testing.assert_array_equal(restored.qpos, end)
        assert bed.of(restored).work == work
        np.testing.assert_array_equal(bed.of(restored).history.work, rows.work)
    # As rollouts have it: time goes back to that of the state.
    mujoco.mj_setState(model, data, physics, whole)
    go(model, data, bed, 0.05)
    np.testing.assert_array_equal(data.qpos, end)
    # A reset begins anew, wherever time was.
    mujoco.mj_resetData(model, data)
    data.qpos[:], data.qvel[:] = first, thrown(model).qvel
    go(model, data, bed, 0.1)
    mujoco.mj_getState(model, data, physics2 := physics.copy(), whole)
    np.testing.assert_array_equal(physics2, physics)


def test_a_copy_goes_on_as_its_original() -> None:
    import copy

    model, data, bed = box()
    go(model, data, bed, 0.1)
    other = copy.copy(data)
    bed.copy(data, other)
    for simulated in (data, other):
        go(model, simulated, bed, 0.05)
    np.testing.assert_array_equal(data.qpos, other.qpos)
    # Without the friction state it begins anew, yet the forces on the original are none of its own.
    third = copy.copy(data)
    bed.apply(third)
    np.testing.assert_allclose(third.xfrc_applied[1, :3], bed.of(third).force)


def test_forces_of_others_stay() -> None:
    model, data, bed = box()
    go(model, data, bed, 0.15)
    push = np.array([3.0, -1.0, 2.0, 0.0, 0.1, 0.0])
    for size in (1.0, 0.5):
        data.xfrc_applied[1] = size * push
        for _ in range(3):
            bed.apply(data)
            np.testing.assert_allclose(data.xfrc_applied[1, :3], bed.of(data).force + size * push[:3], atol=1e-12)
            mujoco.mj_step(model, data)


def test_data_in_threads_are_stepped_as_one_after_the_other() -> None:
    robot = mujoco.MjModel.from_xml_string(
        '<mujoco><option timestep="0.002"/><worldbody><body name="a" pos="0 0 0.06"><freejoint/>'
        '<geom name="box" type="box" size="0.05 0.04 0.03"/>'
        '<body name="b" pos="0.06 0 0"><joint axis="0 1 0" damping="0.01"/>'
        '<geom name="tail" type="capsule" size="0.01 0.04"/></body></body></worldbody></mujoco>'
    )
    bed = MujocoBed(robot, SAND)
    bed.add_geoms("box|tail", facet_size=0.05)

    def run(speed: float) -> np.ndarray:
        data = mujoco.MjData(robot)
        data.qvel[:3] = speed, 0.0, -0.5
        go(robot, data, bed, 0.2)
        return data.qpos.copy()

    speeds = [0.1, 0.4, 0.7, 1.0]
    alone = [run(speed) for speed in speeds]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(run, speeds))
    np.testing.assert_array_equal(together, alone)
    assert len({*np.round(np.array(alone)[:, 0], 6)}) == 4


def test_nothing_is_written_into_the_model_while_it_is_in_use() -> None:
    """A passive callback of the user's sees the model as other threads do, also within the bed's own calls."""
    model, data, bed = box()
    size = mujoco.mj_sizeModel(model)

    def bytes_of_model() -> bytes:
        held = np.zeros(size, np.uint8)
        mujoco.mj_saveModel(model, None, held)
        return held.tobytes()

    before, seen = bytes_of_model(), []
    mujoco.set_mjcb_passive(lambda of, _: seen.append(of is model and bytes_of_model() == before))
    try:
        go(model, data, bed, 0.1)
    finally:
        mujoco.set_mjcb_passive(None)
    assert len(seen) > 100  # more than once a step, while the box is in the sand
    assert all(seen)


@pytest.mark.slow
@pytest.mark.parametrize(("integrator", "cone"), [*zip(INTEGRATORS, cycle(("pyramidal", "elliptic")), strict=False)])
def test_leg_with_servo_friction_and_stop_stands_with_any_integrator(integrator: str, cone: str) -> None:
    """Constraints that push in every step: those of dry friction and of the stop."""
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="0.002" cone="{cone}"/><worldbody><body name="trunk" pos="0 0 0.16">'
        '<joint name="up" type="slide" axis="0 0 1"/><geom type="box" size="0.05 0.03 0.02" mass="1.5"/>'
        '<body name="leg" pos="0 0 -0.02"><joint name="hip" axis="0 1 0" range="-20 5" damping="0.02" '
        'frictionloss="0.05"/><geom name="leg" type="capsule" fromto="0 0 0 0.02 0 -0.12" size="0.01" mass="0.05"/>'
        '<geom name="foot" type="box" pos="0.02 0 -0.13" size="0.03 0.02 0.01" mass="0.02"/>'
        '</body></body></worldbody><actuator><position joint="hip" kp="20" kv="0.5"/></actuator></mujoco>'
    )
    model.opt.integrator = INTEGRATORS[integrator]
    bed, data = MujocoBed(model, SAND), mujoco.MjData(model)
    bed.add_geoms("leg|foot")
    data.ctrl[0] = 0.2  # beyond the stop
    go(model, data, bed, 1.0)
    before = data.qpos.copy()
    go(model, data, bed, 0.3)
    assert data.nefc > 0
    np.testing.assert_allclose(data.qpos, before, rtol=0, atol=1e-6)
    assert bed.of(data).force[2] == pytest.approx(9.81 * model.body_mass.sum(), rel=1e-3)


def test_other_threads_run_while_forces_are_computed() -> None:
    """This thread counts; another looks whether it did so within one call that computes forces."""
    model = model_of('<geom name="box" type="sphere" size="0.1"/>', place="0 0 -0.1")
    bed, data = MujocoBed(model, SAND), mujoco.MjData(model)
    bed.add_geoms("box", facet_size=0.004)
    (act,) = bed.apply(data)._step._force_calls
    counted, within = [0], []

    def look() -> None:
        for _ in range(100):
            before = counted[0]
            act()
            within.append(counted[0] - before)

    often, thread = sys.getswitchinterval(), threading.Thread(target=look)
    sys.setswitchinterval(60.0)  # so that a thread has its turn when the other gives it up, and at no other time
    try:
        thread.start()
        while thread.is_alive():
            counted[0] += 1
            time.sleep(0.0)
    finally:
        sys.setswitchinterval(often)
        thread.join()
    assert any(within)


def test_a_rollout_of_mujoco_is_one_in_sand() -> None:
    rollout = pytest.importorskip("mujoco.rollout")
    model, data, bed = box()
    starts = []
    for speed in (0.2, 0.6):
        data.qvel[0] = speed
        state = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
        mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        starts.append(state)
    datas = [mujoco.MjData(model) for _ in starts]
    with bed.install():
        states, _ = rollout.rollout(model, datas, np.array(starts), nstep=120)
    for start, path in zip(starts, states, strict=True):
        mujoco.mj_setState(model, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        bed.of(data).restart()
        go(model, data, bed, 0.12)
        np.testing.assert_allclose(path[-1, 1:8], data.qpos, atol=1e-12)
        assert data.qpos[2] < 0.05


def test_steps_without_a_call_are_reported() -> None:
    model, data, bed = box()
    bed.apply(data)
    mujoco.mj_step(model, data, nstep=3)
    with pytest.raises(SceneError, match=r"3 steps were made since the last call: call apply before each mj_step"):
        bed.apply(data)
    model, data, bed = box(lenient=True)
    bed.apply(data)
    mujoco.mj_step(model, data, nstep=3)
    bed.apply(data)


def test_rigid_contact_and_sand_share_a_step_with_either_solver() -> None:
    """A slab on sand under a heavy ball: what the sand bears is the weight of both, however the contact is solved."""
    for solver in ("Newton", "PGS"):
        model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option timestep="0.002" solver="{solver}"/><worldbody>'
            '<body name="slab" pos="0 0 0.005"><freejoint/>'
            '<geom name="slab" type="box" size="0.1 0.1 0.01" mass="0.2"/></body><body name="ball" pos="0 0 0.066">'
            '<joint type="slide" axis="0 0 1"/><geom type="sphere" size="0.05" mass="2"/></body></worldbody></mujoco>'
        )
        bed = MujocoBed(model, SAND)
        bed.add_geoms("slab")
        data = mujoco.MjData(model)
        go(model, data, bed, 1.0)
        before = data.qpos.copy()
        go(model, data, bed, 0.5)
        np.testing.assert_allclose(data.qpos, before, rtol=0, atol=1e-6)
        np.testing.assert_allclose(bed.of(data).force[2], 2.2 * 9.81, rtol=1e-3)
