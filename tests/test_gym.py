"""Environments for agents: as Gymnasium asks for them, with seeds and states that hold."""

from __future__ import annotations

import multiprocessing
import pickle
import warnings
from typing import Any

import numpy as np
import pytest
from support_runs import scenario_of

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402

import granular_contact.gym  # noqa: E402
from granular_contact.errors import ControlError  # noqa: E402
from granular_contact.gym import CONFIG, HEXAPOD, RUNNER, GranularEnv  # noqa: E402
from granular_contact.gym.hexapod import HIPS  # noqa: E402

BAR = "type: link, length_m: 0.1, diameter_m: 0.01, density_kg_m3: 2700"
DRIVE = "{type: external, torque_Nm: 0, range: [-0.1, 0.3]}"
ARM = f"""
model:
  name: arm
  bodies: {{bar: {{{BAR}}}}}
  joints: {{hinge: {{type: hinge, parent: ground, child: bar}}}}
medium: play_sand
bed: {{height_m: -0.05}}
initial: {{joints: {{hinge: {{angle_deg: 20}}}}}}
drives: {{hinge: {DRIVE}}}
solver: {{end_time_s: 0.1, step_s: 1e-3}}
load: {{strips_per_rigid_part: 4}}
"""
NAMES = ("hinge_angle_rad", "hinge_rate_rad_s", "bar_depth_m")


def arm(**options: Any) -> GranularEnv:
    given: dict[str, Any] = {"observation": NAMES, "reward": lambda before, after: after["depth_m"] - before["depth_m"]}
    return GranularEnv(scenario_of(ARM), **(given | {"control_rate_Hz": 100} | options))


def test_gymnasium_finds_nothing_but_that_positions_have_no_bounds() -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check_env(gymnasium.make(RUNNER, end_time_s=0.05).unwrapped)
    assert all("A Box observation space m" in str(warning.message) for warning in caught), [
        str(warning.message) for warning in caught
    ]


def test_an_episode_is_cut_at_the_end_and_rewarded_by_the_way() -> None:
    env = arm()
    _, info = env.reset(seed=1)
    start, total, steps, cut = env.simulation.observe()["depth_m"], 0.0, 0, False
    while not cut:
        _, reward, ended, cut, info = env.step(np.array([1.0], np.float32))
        assert not ended
        total, steps = total + reward, steps + 1
    assert steps == 10
    assert info["status"] == "end time 0.1 s reached"
    assert total == pytest.approx(env.simulation.observe()["depth_m"] - start)
    with pytest.raises(ControlError, match="the run is over"):
        env.step(np.zeros(1))
    results = env.simulation.results()
    np.testing.assert_allclose(results["hinge_torque_Nm"], 0.3)  # 1 is the end of its range
    assert not any("beyond its range" in warning for warning in results.warnings)
    env.reset(seed=1)
    env.step(np.array([-3.0]))  # as of a policy without bounds
    results = env.simulation.results()
    assert results["hinge_torque_Nm"][-1] == -0.1
    assert any(
        "hinge_torque_Nm was given beyond its range, -0.1 to 0.3, once" in warning for warning in results.warnings
    )
    fallen = arm(terminated=lambda seen: seen["hinge_angle_deg"] > 20.1)
    fallen.reset(seed=1)
    *_, ended, cut, _ = fallen.step(np.ones(1))
    assert ended
    assert not cut


def test_an_observation_named_as_reward_gives_its_increase() -> None:
    """As the function of the other tests, by the id that makes an environment of any config."""
    options = {"observation": NAMES, "control_rate_Hz": 100}
    named = gymnasium.make(CONFIG, config=scenario_of(ARM), reward="depth_m", **options)
    for env in (named, arm()):
        env.reset(seed=1)
    action = np.array([1.0], np.float32)
    assert [named.step(action)[1] for _ in range(3)] == [env.step(action)[1] for _ in range(3)]
    with pytest.raises(KeyError, match="no observation 'depht_m'"):
        arm(reward="depht_m")


def test_seeds_hold_for_what_is_drawn_at_resets() -> None:
    vary = {"medium.eta_d": (4.0, 9.0), "initial.joints.hinge.angle_deg": lambda random: random.normal(20.0, 3.0)}

    def seen(env: GranularEnv, seed: int | None) -> list[float]:
        first, _ = env.reset(seed=seed)
        return [*first, *env.step(np.zeros(1))[0], env.simulation.scenario.medium.eta_d]

    env = arm(vary=vary)
    seeded, next_draw = seen(env, 5), seen(env, None)
    assert seeded != next_draw
    assert seen(env, 5) == seeded
    assert seen(arm(vary=vary), 5) == seeded
    env.reset(seed=5, options={"medium.eta_d": 7.5})
    assert env.simulation.scenario.medium.eta_d == 7.5


def test_a_state_of_mid_episode_goes_on_as_it_did() -> None:
    env, random = arm(), np.random.default_rng(2)
    env.reset(seed=1)
    for action in random.uniform(-1, 1, (5, 1)):
        env.step(action)
    kept, actions = pickle.dumps(env.state()), random.uniform(-1, 1, (5, 1))
    future = [env.step(action)[:4] for action in actions]
    other = arm()
    other.restore(pickle.loads(kept))
    for (seen, *rest), action in zip(future, actions, strict=True):
        restored = other.step(action)
        np.testing.assert_array_equal(restored[0], seen)
        assert list(restored[1:4]) == rest
    assert max(outcome[0][2] for outcome in future) > 0.0  # in the sand


def test_a_picture_shows_the_mechanism_and_the_sand() -> None:
    env = arm(render_mode="rgb_array")
    env.reset(seed=1)
    picture = env.render()
    assert picture.dtype == np.uint8
    assert picture.ndim == 3
    sand, sky = picture[-5:].reshape(-1, 3).mean(axis=0), picture[:5].reshape(-1, 3).mean(axis=0)
    assert sky[2] > sand[2] + 20  # bluer
    env.step(np.ones(1))
    assert (env.render() != picture).any()
    assert arm().render() is None


def test_environments_in_processes_are_the_same() -> None:
    # Forked ones have loaded all that this process has, kernels too.
    context = "fork" if "fork" in multiprocessing.get_all_start_methods() else "spawn"
    options: dict[str, Any] = {"end_time_s": 0.04, "vary": {"initial.joints.trunk.y_m": (0.045, 0.046)}}
    env = gymnasium.make(RUNNER, **options)
    first = env.reset(seed=4)[0]
    alone = env.step(np.full(4, 0.5, np.float32))
    envs = gymnasium.make_vec(
        RUNNER, num_envs=2, vectorization_mode="async", vector_kwargs={"context": context}, **options
    )
    try:
        seen, _ = envs.reset(seed=[3, 4])
        np.testing.assert_array_equal(seen[1], first)
        assert (seen[0] != seen[1]).any()
        seen, rewards, _, cut, _ = envs.step(np.full((2, 4), 0.5, np.float32))
        np.testing.assert_array_equal(seen[1], alone[0])
        assert rewards[1] == alone[1]
        assert not cut.any()
        assert envs.step(np.zeros((2, 4), np.float32))[3].all()
    finally:
        envs.close()


def test_the_hexapod_walks_ahead_with_its_legs_and_not_without() -> None:
    env = gymnasium.make(HEXAPOD, end_time_s=0.5)
    ways = []
    for rate in (-1.0, 0.5):
        seen, _ = env.reset(seed=1)
        total, ended = 0.0, False
        while not ended:
            seen, reward, fell, ended, _ = env.step(np.full(6, rate, np.float32))
            assert not fell
            total += float(reward)
        ways.append(total)
    # Legs of 60 mm that turn at 9 rad/s for 0.5 s: at most 270 mm. Held fast, it settles from the drop on its feet.
    assert abs(ways[0]) < 0.06
    assert 0.06 < ways[1] < 0.27
    walker = env.unwrapped.simulation.observe()
    assert seen.shape == (34,)
    assert seen[0] == pytest.approx(10.0 * walker["trunk_z_m"], rel=1e-6)
    assert seen[22] == pytest.approx(0.1 * walker["hip_front_left_rate_rad_s"], rel=1e-5)
    assert list(seen[28:] > 0.5) == [walker[f"{hip.replace('hip', 'leg')}_contact"] > 0.5 for hip in HIPS]


def test_an_action_turns_the_leg_whose_angle_is_seen_at_its_place() -> None:
    """Place k of the action, of the sines, of the rates and of the contacts are of one leg, for both robots."""
    # Numbers of the trunk, 10 and 5, then sines, cosines and rates of the hips.
    for name, rates in ((HEXAPOD, slice(22, 28)), (RUNNER, slice(13, 17))):
        env = gymnasium.make(name, end_time_s=0.5)
        controls = env.unwrapped.simulation.controls
        count = env.action_space.shape[0]
        for k in range(count):
            env.reset(seed=1)
            action = np.full(count, -1.0, np.float32)  # held fast
            action[k] = 1.0
            seen = env.step(action)[0]
            turned = env.unwrapped.simulation.observe()
            fastest = int(np.argmax([abs(turned[control]) for control in controls]))
            assert fastest == k
            assert int(np.argmax(np.abs(seen[rates]))) == k


def test_impossible_controls_are_reported() -> None:
    with pytest.raises(ControlError, match="without a range: hinge_torque_Nm"):
        GranularEnv(
            scenario_of(ARM, "drives.hinge={type: external, torque_Nm: 0}"), observation=NAMES, reward=lambda *_: 0.0
        )
    with pytest.raises(ControlError, match="none is in this scene"):
        GranularEnv(scenario_of("pendulum"), observation=("time_s",), reward=lambda *_: 0.0)
    with pytest.raises(KeyError, match="no observation 'knee'"):
        arm(observation=("knee",))
    with pytest.raises(ControlError, match="render_mode"):
        arm(render_mode="human")
    for rate in (0, -5.0, np.nan, "50"):
        with pytest.raises(ControlError, match=f"control_rate_Hz: got {rate!r}, allowed is a finite number above 0"):
            arm(control_rate_Hz=rate)
    for how in (3, (1.0,), (0.4, np.nan), (0.6, 0.4)):
        with pytest.raises(ControlError, match=r"vary: medium.zeta: got .* allowed is"):
            arm(vary={"medium.zeta": how})
    env = arm()
    env.reset(seed=1)
    for action in ("left", [[1.0], [2.0, 3.0]]):
        with pytest.raises(ControlError, match=r"action: got .* allowed is an array of numbers"):
            env.step(action)  # type: ignore[arg-type]
    with pytest.raises(ControlError, match=r"action: got the shape \(2,\), allowed is \(1,\)"):
        env.step(np.zeros(2))
    for bad in (np.nan, np.inf):
        with pytest.raises(ControlError, match=f"hinge_torque_Nm: got {bad}"):
            env.step(np.array([bad]))
    assert env.simulation.time == 0.0
    assert granular_contact.gym.runner_env().action_space.shape == (4,)
