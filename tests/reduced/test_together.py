"""Runs of the reduced model that one compiled call marches in a batch: each equals its single run to round-off."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support_refusals import faults_of
from support_runs import ROOT

from granular_contact import load
from granular_contact.config import load_sweep
from granular_contact.engines.modal import batch, observe
from granular_contact.engines.modal.model import Model
from granular_contact.errors import GranularContactError
from granular_contact.run import summaries_of, summary_of
from granular_contact.scene import Scene, build
from granular_contact.scene.variants import Builder
from granular_contact.studies.sweep import Journal, WorkerPool, run, runner, worker

UNTOLD = {"cost.solve_s": None, "cost.load_calls": None}  # one more where the table of rows gets longer


def scenes(modes: int, static: str, count: int = 5) -> list[Scene]:
    """Of several blows, media, links and end times."""
    base = load("pendulum", method={"reduced": {"modes": modes, "static": static}}).scenario
    rng = np.random.default_rng(modes)
    built = []
    for i in range(count):
        changes = {
            "medium.eta_d": float(rng.uniform(0, 9)),
            "medium.eta_h": float(rng.uniform(0, 16)),
            "initial.impact_angle_deg": float(rng.uniform(22, 60)),
            "initial.impact_speed_rad_s": 0.0 if i == 0 else float(rng.uniform(1, 9)),
            "solver.end_time_s": (0.5, 0.03)[i % 2],
            "model.bodies.link.length_m": (0.24, 0.2)[i % 2],
        }
        built.append(build(base.replace(changes)))
    return built


def comparable(summary: dict[str, object] | Exception) -> dict[str, object]:
    """Flat, without the time that it took; a balance is a difference of nearly equal numbers."""
    assert isinstance(summary, dict), summary
    flat = dict(worker._flat(summary))
    flat["energy.imbalance_relative"] = pytest.approx(flat["energy.imbalance_relative"], abs=1e-13)
    near = {key: pytest.approx(x, rel=1e-12, abs=1e-16) for key, x in flat.items() if isinstance(x, float)}
    return flat | near | UNTOLD


@pytest.mark.parametrize(("modes", "static"), [(0, "true_sign"), (2, "elastoplastic"), (2, "true_sign")])
def test_runs_in_a_batch_equal_single_runs(modes, static, monkeypatch):
    several = scenes(modes, static)
    monkeypatch.setattr(batch, "MOST_ROWS", 40)  # so that tables grow on the way
    for summary, scene in zip(summaries_of(several), several, strict=True):
        assert dict(worker._flat(summary)) | UNTOLD == comparable(summary_of(scene))


def test_models_of_different_sizes_and_methods_go_together():
    several = [scenes(modes, "elastoplastic", 1)[0] for modes in (0, 2, 0)]
    several.insert(1, build(load("pendulum_rigid", solver={"end_time_s": 0.001}).scenario))
    assert [summary["cost"]["steps"] for summary in summaries_of(several)] == [
        summary_of(scene)["cost"]["steps"] for scene in several
    ]


def test_a_failure_in_a_batch_stays_with_its_own_run(monkeypatch):
    several = scenes(0, "true_sign", 3)
    whole, broken = summaries_of(several), several[1]
    begin = batch.known

    def breaks(models: list[Model], *more: object) -> object:
        if any(model.scene is broken for model in models):
            raise ArithmeticError("no such number")
        return begin(models, *more)

    monkeypatch.setattr(batch, "known", breaks)
    monkeypatch.setattr(observe, "known", breaks)
    summaries = summaries_of(several)
    assert isinstance(summaries[1], ArithmeticError)
    for i in (0, 2):
        assert dict(worker._flat(summaries[i])) | UNTOLD == comparable(whole[i])


# ---- scenes one after another ----


@pytest.mark.parametrize("modes", [0, 3])
def test_scenes_built_from_a_similar_scene_are_equal_to_new_scenes(modes):
    base = load("pendulum", method={"reduced": {"modes": modes}}).scenario
    builder, rng = Builder(base), np.random.default_rng(1)
    for medium in ("play_sand", "play_sand", None, "play_sand"):
        changes = {
            "medium": medium,
            "initial.impact_angle_deg": float(rng.uniform(22, 60)),
            "initial.impact_speed_rad_s": float(rng.uniform(2, 9)),
        }
        scenario = base.replace(changes)
        anew, made = build(scenario), builder(scenario)
        assert made.scenario is scenario
        for first, second in zip((*made.bodies, *made.joints), (*anew.bodies, *anew.joints), strict=True):
            for field, value in vars(second).items():
                assert_alike(vars(first)[field], value)
        assert_alike(made.surface, anew.surface)
        assert_alike(made.force_scale, anew.force_scale)
        assert made.media == anew.media


def test_faulty_scenes_are_refused_when_derived_from_a_valid_scene():
    base = load("pendulum", method="reduced").scenario
    builder = Builder(base)
    # A law for spheres alone, and a start beyond all numbers.
    for changes in (
        {"medium": {"law": "bingham", "yield_force_N": 1, "viscosity_N_s_m": 1}},
        {"initial.impact_speed_rad_s": 1e40},
    ):
        scenario = base.replace(changes)
        faults = [faults_of(GranularContactError, make, scenario) for make in (build, builder)]
        assert faults[0] == faults[1]


def assert_alike(first: object, second: object) -> None:
    """The same up to round-off of metres, radians and their rates."""
    if isinstance(second, float | np.ndarray):
        np.testing.assert_allclose(first, second, rtol=1e-12, atol=1e-13)
    elif isinstance(second, tuple):
        for mine, theirs in zip(first, second, strict=True):
            assert_alike(mine, theirs)
    elif hasattr(second, "__dataclass_fields__"):
        for key in second.__dataclass_fields__:
            assert_alike(getattr(first, key), getattr(second, key))
    else:
        assert first == second


# ---- in a sweep ----


def sweep_file(folder: Path, count: int) -> Path:
    path = folder / "many.yaml"
    ranges = "medium.eta_d: [4, 9], initial.impact_angle_deg: [22, 60], initial.impact_speed_rad_s: [2, 9]"
    text = f"sample: {{method: latin_hypercube, count: {count}, ranges: {{{ranges}}}}}\n"
    config = ROOT / "configs" / "pendulum.yaml"
    path.write_text(f"config: {config}\nset: {{method: {{reduced: {{modes: 0}}}}}}\n{text}", encoding="utf-8")
    return path


def test_a_sweep_marches_its_cases_together_and_keeps_each(tmp_path, monkeypatch):
    sweep = load_sweep(sweep_file(tmp_path, 40), probe=Builder())
    calls = []
    march = batch.march
    monkeypatch.setattr(batch, "march", lambda group: (calls.append(len(group)), march(group))[1])
    (tmp_path / "journal").mkdir()
    journal = Journal(tmp_path / "journal")
    with WorkerPool(2, no_processes) as pool:
        rows = list(run(sweep, pool, journal=journal, done={3}))
    assert sum(calls) > 20  # but for chunks of one
    assert max(calls) > 1
    assert sorted(row.index for row in rows) == sorted(journal.done()) == [i for i in range(40) if i != 3]
    alone = summary_of(build(sweep.scenario(sweep.cases[7])))
    row = next(row for row in rows if row.index == 7)
    for key in ("stopping_time_s", "angle_at_stop_deg", "max_depth_m"):
        assert row.summary[key] == pytest.approx(alone[key], rel=1e-12)


def no_processes(workers: int) -> None:
    raise AssertionError(f"{workers} processes were started for a few short runs")


@pytest.mark.parametrize("more", [{"solver.end_time_s": 1e3}, {"method": "engine"}])
def test_long_runs_and_others_go_into_processes(more, tmp_path):
    sweep = load_sweep(sweep_file(tmp_path, 2))
    base = sweep.base.replace(more)
    with WorkerPool(1, no_processes) as pool:
        cases = runner.CaseRunner(type(sweep)(**{**vars(sweep), "base": base}), pool)
        with pytest.raises(AssertionError, match="processes were started"):
            list(cases.rows(iter(runner._tasks(sweep, ())), 2))
