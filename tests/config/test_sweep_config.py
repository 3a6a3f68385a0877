"""Sweep files: the cases they describe, and each kind of fault at its line."""

from __future__ import annotations

import math
import pickle
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from support_config import GOOD
from support_refusals import faults_of
from support_runs import ROOT

from granular_contact.config import Sweep, is_sweep, load, load_optimise, load_sweep
from granular_contact.config.sweep import MOST_FAULTS
from granular_contact.errors import ConfigError, Fault, scene_error


@pytest.fixture
def read(tmp_path: Path):
    """Reads a sweep of the text, on the config run.yaml beside it."""
    (tmp_path / "run.yaml").write_text(GOOD)

    def of(text: str, **options) -> Sweep:
        (tmp_path / "many.yaml").write_text(text)
        return load_sweep(tmp_path / "many.yaml", **options)

    return of


@pytest.fixture
def faults(read, tmp_path):
    """Faults of a sweep of the text; files are named relative to its folder."""

    def of(text: str, **options) -> list[Fault]:
        prefix = f"{tmp_path}/"
        reported = faults_of(ConfigError, read, text, **options)
        return [Fault(f.file.removeprefix(prefix), f.line, f.key, f.message) for f in reported]

    return of


def named(cases: str) -> str:
    return "config: run.yaml\ncases:\n" + cases


def vary(lines: str, more: str = "") -> str:
    return f"config: run.yaml\n{more}vary:\n{lines}"


def sample(lines: str, ranges: str = "{initial.impact_speed_rad_s: [1, 9]}") -> str:
    return f"config: run.yaml\nsample:\n{lines}  ranges: {ranges}\n"


SOBOL = "  method: sobol\n  count: 4\n"
SPEED, ANGLE = "initial.impact_speed_rad_s", "initial.impact_angle_deg"
# text, line, key, words that the message must hold
FAULTS = {
    "no config": ("cases: {a: {}}\n", 1, "config", ["is missing", "the path of a config"]),
    "config not there": ("config: no.yaml\ncases: {a: {}}\n", 1, "config", ["'no.yaml'", "no file", "no.yaml"]),
    "config is a folder": ("config: .\ncases: {a: {}}\n", 1, "config", ["got '.'", "no file"]),
    "config is an empty text": ("config: ''\ncases: {a: {}}\n", 1, "config", ["got ''", "no file"]),
    "config is a number": ("config: 3\ncases: {a: {}}\n", 1, "config", ["the number 3", "the path of a config"]),
    "config is null": ("config:\ncases: {a: {}}\n", 1, "config", ["null", "the path of a config"]),
    "config is a list": ("config: [run.yaml]\ncases: {a: {}}\n", 1, "config", ["a list of 1 item"]),
    "config is the sweep": ("config: many.yaml\ncases: {a: {}}\n", 1, "config", ["stands in a sweep only"]),
    "a plain config": (GOOD, 1, "", ["the config of one run", "under config"]),
    "a list": ("- 1\n", 1, "", ["a list of 1 item", "config, set, cases, vary, combine, sample"]),
    "empty": ("", 1, "", ["is empty"]),
    "unknown key": (named("  a: {}\ncolour: red\n"), 4, "colour", ["unknown key", "config, set, cases"]),
    "nearly a key": (named("  a: {}\nsett: {}\n"), 4, "sett", ["did you mean set?"]),
    "neither": ("config: run.yaml\n", 1, "", ["none of cases, vary and sample", "exactly one"]),
    "both": (named("  a: {}\nvary: {solver.step_s: [1e-3]}\n"), 1, "", ["both of cases and vary"]),
    "set is a list": (named("  a: {}\nset: [1]\n"), 4, "set", ["a list of 1 item", "dotted keys"]),
    "combine with cases": (named("  a: {}\ncombine: grid\n"), 4, "combine", ["not cases"]),
    # cases
    "no cases": ("config: run.yaml\ncases: {}\n", 2, "cases", ["empty mapping", "one case or more"]),
    "no listed cases": ("config: run.yaml\ncases: []\n", 2, "cases", ["a list of 0 items", "one case or more"]),
    "cases null": ("config: run.yaml\ncases:\n", 2, "cases", ["null", "one case or more"]),
    "case null": (named("  a:\n"), 3, "cases.a", ["null", "dotted keys"]),
    "case is a number": (named("  a: 3\n"), 3, "cases.a", ["the number 3"]),
    "name with a slash": (named("  a/b: {}\n"), 3, "cases.a/b", ["'a/b'", "a letter or digit"]),
    "name with dots": (named("  ..: {}\n"), 3, "cases...", ["'..'"]),
    "hidden name": (named("  .a: {}\n"), 3, "cases..a", ["'.a'"]),
    "name is a number": (named("  '1e3': {}\n"), 3, "cases.1e3", ["'1e3'", "no number"]),
    "number as key": (named("  12: {}\n  a: {}\n"), 3, "cases", ["the key 12", "quote it"]),
    "long name": (named(f"  {'a' * 101}: {{}}\n"), 3, f"cases.{'a' * 101}", ["at most 100"]),
    "same key": (named("  a: {}\n  b: {}\n  a: {}\n"), 5, "cases.a", ["in lines 3 and 5"]),
    "same folder": (named("  a: {}\n  A: {}\n"), 4, "cases.A", ["'A'", "line 3"]),
    "same name": (named("  - name: a\n  - {name: a}\n"), 4, "cases.1", ["'a'", "line 3", "its own"]),
    "no name": (named("  - {solver.step_s: 1e-4}\n"), 3, "cases.0.name", ["is missing"]),
    "name of 3": (named("  - name: 3\n"), 3, "cases.0.name", ["the number 3", "allowed is text"]),
    "item is a text": (named("  - a\n"), 3, "cases.0", ["the text 'a'", "with a name"]),
    # dotted keys and what they hold, at the line of the sweep
    "unknown dotted": (named("  a: {medium.eta_q: 1}\n"), 3, "medium.eta_q", ["unknown key", "did you mean eta_"]),
    "unknown part": (named("  a:\n    mediun.eta_h: 1\n"), 4, "mediun", ["did you mean medium?"]),
    "unknown in a body": (named("  a: {model.bodies.arm.lenght_m: 1}\n"), 3, "model.bodies.arm.lenght_m", ["length_m"]),
    "below a number": (named("  a: {gravity_m_s2.x: 1}\n"), 3, "gravity_m_s2.x", ["has no keys"]),
    "empty part": (named("  a: {medium..eta_h: 1}\n"), 3, "", ["'medium..eta_h'", "not a dotted key"]),
    "bad value": (named("  a: {}\n  b:\n    medium.eta_h: -1\n"), 5, "medium.eta_h", ["-1", "of at least 0"]),
    "bad model": (named("  a: {model: horse}\n"), 3, "model", ["'horse'", "no such model"]),
    "bad set": (named("  a: {}\nset: {medium.eta_q: 1}\n"), 4, "medium.eta_q", ["unknown key"]),
    "no effect": (named("  a: {medium.eta_h: 1, medium: null}\n"), 3, "medium.eta_h", ["no effect", "line 3"]),
    # vary
    "vary nothing": ("config: run.yaml\nvary: {}\n", 2, "vary", ["an empty mapping", "one dotted key or more"]),
    "vary a list": ("config: run.yaml\nvary: [1]\n", 2, "vary", ["a list of 1 item", "dotted keys"]),
    "no values": (vary(f"  {SPEED}: []\n"), 3, f"vary.{SPEED}", ["a list of 0 items", "list of values"]),
    "one value": (vary(f"  {SPEED}: 3\n"), 3, f"vary.{SPEED}", ["the number 3", "from, to, count and scale"]),
    "empty range": (vary(f"  {SPEED}: {{}}\n"), 3, f"vary.{SPEED}", ["an empty mapping"]),
    "bad in a list": (vary(f"  {ANGLE}:\n    - 10\n    - 100\n"), 5, ANGLE, ["100", "from -90 to 90"]),
    "unknown dotted in vary": (vary("  medium.eta_q: [1, 2]\n"), 3, "medium.eta_q", ["unknown key"]),
    "no count": (vary(f"  {SPEED}: {{from: 1, to: 2}}\n"), 3, f"vary.{SPEED}.count", ["is missing", "2 to 100000"]),
    "no from": (vary(f"  {SPEED}: {{to: 2, count: 3}}\n"), 3, f"vary.{SPEED}.from", ["is missing", "finite number"]),
    "count 1": (vary(f"  {SPEED}: {{from: 1, to: 2, count: 1}}\n"), 3, f"vary.{SPEED}.count", ["the number 1;"]),
    "count 2.5": (vary(f"  {SPEED}: {{from: 1, to: 2, count: 2.5}}\n"), 3, f"vary.{SPEED}.count", ["2.5", "whole"]),
    "count true": (vary(f"  {SPEED}: {{from: 1, to: 2, count: true}}\n"), 3, f"vary.{SPEED}.count", ["boolean"]),
    "from text": (vary(f"  {SPEED}: {{from: x, to: 2, count: 3}}\n"), 3, f"vary.{SPEED}.from", ["the text 'x'"]),
    "to infinity": (vary(f"  {SPEED}: {{from: 1, to: .inf, count: 3}}\n"), 3, f"vary.{SPEED}.to", [".inf", "finite"]),
    "from is to": (vary(f"  {SPEED}: {{from: 2, to: 2.0, count: 3}}\n"), 3, f"vary.{SPEED}.to", ["the same as from"]),
    "log of 0": (vary(f"  {SPEED}: {{from: 0, to: 2, count: 3, scale: log}}\n"), 3, f"vary.{SPEED}", ["above 0"]),
    "scale": (vary(f"  {SPEED}: {{from: 1, to: 2, count: 3, scale: lg}}\n"), 3, f"vary.{SPEED}.scale", ["linear, log"]),
    "step": (vary(f"  {SPEED}: {{from: 1, to: 2, count: 3, step: 1}}\n"), 3, f"vary.{SPEED}.step", ["unknown key"]),
    "bad in a range": (vary(f"  {ANGLE}: {{from: 80, to: 100, count: 2}}\n"), 3, ANGLE, ["100", "-90 to 90"]),
    "combine": (vary(f"  {SPEED}: [1]\n", "combine: mix\n"), 2, "combine", ["'mix'", "grid, zip"]),
    "zip of 2 and 3": (
        vary(f"  {SPEED}: [1, 2]\n  {ANGLE}: [1, 2, 3]\n", "combine: zip\n"), 3, "vary",
        [f"2 of {SPEED}, 3 of {ANGLE}", "equally many"],
    ),
    "huge grid": (
        vary(f"  {SPEED}: {{from: 1, to: 2, count: 1000}}\n  {ANGLE}: {{from: 1, to: 2, count: 101}}\n"), 2, "vary",
        ["101000 cases", "1000 x 101", "at most 100000"],
    ),
    "huge range": (
        vary(f"  {SPEED}: {{from: 1, to: 2, count: 100001}}\n"), 3, f"vary.{SPEED}.count", ["100001", "to 100000"],
    ),
    # sample
    "sample a list": ("config: run.yaml\nsample: [1]\n", 2, "sample", ["a list of 1 item", "method, count, seed"]),
    "sample and vary": (sample(SOBOL) + f"vary: {{{SPEED}: [1]}}\n", 1, "", ["both of vary and sample", "exactly one"]),
    "sample and combine": (sample(SOBOL) + "combine: grid\n", 6, "combine", ["not sample"]),
    "no method": (sample("  count: 4\n"), 2, "sample.method", ["is missing", "latin_hypercube, sobol"]),
    "method": (sample("  method: random\n  count: 4\n"), 3, "sample.method", ["'random'", "one_at_a_time, saltelli"]),
    "no sample count": (sample("  method: sobol\n"), 2, "sample.count", ["is missing", "from 2 to 100000"]),
    "sample count 0": (sample("  method: sobol\n  count: 0\n"), 4, "sample.count", ["the number 0"]),
    "no power of two": (
        sample("  method: sobol\n  count: 100\n"), 4, "sample.count", ["got 100", "powers of two", "64 or 128"],
    ),
    "no power of two either": (sample("  method: saltelli\n  count: 7\n"), 4, "sample.count", ["take 4 or 8"]),
    "too many": (sample("  method: saltelli\n  count: 65536\n"), 4, "sample.count", ["got 196608 cases", "100000"]),
    "seed": (sample(f"{SOBOL}  seed: -1\n"), 5, "sample.seed", ["the number -1", "from 0 to"]),
    "seed of nothing": (
        sample("  method: one_at_a_time\n  count: 4\n  seed: 1\n"), 5, "sample.seed", ["no effect", "draws nothing"],
    ),
    "unknown in sample": (sample(f"{SOBOL}  sed: 1\n"), 5, "sample.sed", ["unknown key", "did you mean seed?"]),
    "no ranges": ("config: run.yaml\nsample:\n" + SOBOL, 2, "sample.ranges", ["is missing", "dotted key"]),
    "empty ranges": (sample(SOBOL, "{}"), 5, "sample.ranges", ["an empty mapping", "dotted key"]),
    "three ends": (sample(SOBOL, f"{{{SPEED}: [1, 2, 3]}}"), 5, f"sample.ranges.{SPEED}", ["3 items", "[from, to]"]),
    "range is text": (sample(SOBOL, f"{{{SPEED}: all}}"), 5, f"sample.ranges.{SPEED}", ["'all'", "[from, to]"]),
    "end is text": (sample(SOBOL, f"{{{SPEED}: [1, x]}}"), 5, f"sample.ranges.{SPEED}.to", ["'x'", "finite"]),
    "equal ends": (sample(SOBOL, f"{{{SPEED}: [2, 2]}}"), 5, f"sample.ranges.{SPEED}.to", ["the same as from"]),
    "log of -1": (
        sample(SOBOL, f"{{{SPEED}: {{from: -1, to: 2, scale: log}}}}"), 5, f"sample.ranges.{SPEED}", ["above 0"],
    ),
    "count of a key": (
        sample(SOBOL, f"{{{SPEED}: {{from: 1, to: 2, count: 3}}}}"), 5, f"sample.ranges.{SPEED}.count", ["e.count"],
    ),
    "outputs of sobol": (
        sample(f"{SOBOL}  outputs: [stopping_time_s]\n"), 5, "sample.outputs", ["no effect with sobol", "saltelli"],
    ),
    "outputs is text": (
        sample("  method: saltelli\n  count: 4\n  outputs: x\n"), 5, "sample.outputs", ["'x'", "a list of different"],
    ),
    "unknown key in ranges": (sample(SOBOL, "{medium.eta_q: [1, 2]}"), 5, "medium.eta_q", ["unknown key"]),
    "a range out of bounds is one fault": (sample(SOBOL, f"{{{ANGLE}: [95, 99]}}"), 5, ANGLE, ["from -90 to 90"]),
    "vary what vary hides": (vary("  medium.eta_h: [1]\n  medium: [null]\n"), 3, "medium.eta_h", ["swap them"]),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("case", FAULTS)
def test_one_fault_at_its_line(faults, case):
    text, line, key, message = FAULTS[case]
    reported = faults(text)
    assert [(fault.file, fault.line, fault.key) for fault in reported] == [("many.yaml", line, key)]
    assert [word for word in message if word not in reported[0].message] == []
    assert "\n" not in reported[0].message


def test_all_faults_at_once(faults, tmp_path):
    (tmp_path / "run.yaml").write_text(GOOD)
    reported = faults(
        "config: run.yaml\n"
        "colour: red\n"
        "cases:\n"
        "  a b: {}\n"
        "  slow: {medium.eta_h: -1, medium.eta_q: 1}\n"
        "  fast: {initial.impact_angle_deg: steep, solver.step_s: !!float 1}\n"
        "  slow: {}\n"
    )
    assert [(f.line, f.key) for f in reported] == [
        (2, "colour"),
        (4, "cases.a b"),
        (5, "medium.eta_h"),
        (5, "medium.eta_q"),
        (6, "cases.fast.solver.step_s"),
        (6, "initial.impact_angle_deg"),
        (7, "cases.slow"),
    ]


def test_a_faulty_config_is_reported_once_and_in_its_own_lines(faults, tmp_path):
    text = named("  a: {medium.eta_h: 1}\n  b: {}\n")
    (tmp_path / "run.yaml").write_text(GOOD.replace("eta_d: 6.5", "eta_d: -6.5"))
    assert [(f.file, f.line, f.key) for f in faults(text)] == [("run.yaml", 25, "medium.eta_d")]


def test_a_fault_of_two_values_names_the_case(faults):
    """The step of the config, 1 ms, exceeds an end time that two of the cases set."""
    [first, second] = faults(named("  a: {solver.end_time_s: 1e-4}\n  b: {}\n  c: {solver.end_time_s: 1e-5}\n"))
    assert (first.file, first.line, first.key) == ("run.yaml", 38, "solver.step_s")
    assert first.message.endswith("exceeds end_time_s, 0.0001 (in case a)")
    assert second.message.endswith("exceeds end_time_s, 1e-05 (in case c)")
    [first] = faults(vary("  solver.end_time_s: [1e-4, 1]\n"))
    assert first.message.endswith("(in case case_1, solver.end_time_s = 0.0001)")


def test_faults_of_the_geometry_are_reported_by_case(faults):
    def probe(scenario):
        if scenario.gravity_m_s2 > 10:
            raise scene_error("gravity_m_s2", "is too much")
        if scenario.initial.impact_speed_rad_s > 8:
            raise scene_error("solver.step_s", "is too long")

    reported = faults(named(f"  a: {{gravity_m_s2: 9}}\n  b: {{gravity_m_s2: 11}}\n  c: {{{SPEED}: 9}}\n"), probe=probe)
    assert [(f.file, f.line, f.key, f.message) for f in reported] == [
        ("many.yaml", 4, "gravity_m_s2", "is too much"),
        ("run.yaml", 38, "solver.step_s", "is too long (in case c)"),
    ]


def test_only_the_first_of_many_faults_are_reported(faults):
    cases = "".join(f"  c{i}: {{medium.eta_h: -{i + 1}}}\n" for i in range(MOST_FAULTS + 7))
    reported = faults(named(cases))
    assert len(reported) == MOST_FAULTS + 1
    assert reported[0].line == 3
    assert "7 more faults" in reported[-1].message


def test_a_sweep_is_no_config(tmp_path):
    (tmp_path / "many.yaml").write_text(named("  a: {}\n"))
    [fault] = faults_of(ConfigError, load, tmp_path / "many.yaml")
    assert (fault.line, fault.key) == (1, "config")
    assert "the config of one run is needed" in fault.message


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        (named("  a: {}\n"), True),
        ("cases: 3\n", True),
        ("vary: {}\n", True),
        (GOOD, False),
        ("- 1\n", False),
        ("", False),
    ],
)
def test_sweep_files_are_distinguished_from_other_files(tmp_path, text, answer):
    (tmp_path / "some.yaml").write_text(text)
    assert is_sweep(tmp_path / "some.yaml") is answer
    assert is_sweep(tmp_path / "none.yaml") is False


def speeds(sweep: Sweep) -> list[float]:
    return [sweep.scenario(case).initial.impact_speed_rad_s for case in sweep.cases]


@pytest.mark.parametrize(
    "text",
    [
        named(f"  slow: {{{SPEED}: 1}}\n  as_is: {{}}\n  fast: {{{SPEED}: 9}}\n"),
        named(f"  - {{name: slow, {SPEED}: 1}}\n  - name: as_is\n  - {{name: fast, {SPEED}: 9}}\n"),
    ],
)
def test_named_cases_in_both_forms(read, text):
    sweep = read(text)
    assert [case.name for case in sweep.cases] == ["slow", "as_is", "fast"]
    assert sweep.keys == (SPEED,)
    assert speeds(sweep) == [1, 6, 9]
    assert [sweep.values(case, sweep.scenario(case)) for case in sweep.cases] == [{SPEED: v} for v in (1, 6.0, 9)]
    assert sweep.base.name == "strike"


def test_a_case_is_the_config_with_overrides(read, tmp_path):
    """`--set` of the same keys gives an equal scenario, whatever kind of key it is."""
    sweep = read(
        "config: run.yaml\nset: {medium: play_sand, medium.eta_h: 9}\ncases:\n"
        "  plain: {}\n"
        "  own: {medium.eta_h: 7, model.bodies.hub.shapes.0.diameter_m: 0.03}\n"
        "  other: {medium: null, model: compound_pendulum, load.friction: {type: elastoplastic}}\n"
    )
    common = ["medium=play_sand", "medium.eta_h=9"]
    overrides = ["medium.eta_h=7", "model.bodies.hub.shapes.0.diameter_m=0.03"]
    other = ["medium=null", "model=compound_pendulum", "load.friction={type: elastoplastic}"]
    expected = [load(tmp_path / "run.yaml", common + more).scenario for more in ([], overrides, other)]
    assert [sweep.scenario(case) for case in sweep.cases] == expected
    assert len({str(scenario) for scenario in expected}) == 3


def test_a_config_inside(read):
    inner = "config:\n" + "".join(f"  {line}\n" for line in GOOD.splitlines())
    assert speeds(read(f"{inner}cases:\n  a: {{{SPEED}: 1}}\n  b: {{}}\n")) == [1, 6]


def test_grid_and_zip(read):
    lines = f"  {ANGLE}: [10, 20]\n  {SPEED}: [1, 2]\n"
    grid, zipped = read(vary(lines)), read(vary(lines, "combine: zip\n"))
    pairs = [[tuple(case.values.values()) for case in sweep.cases] for sweep in (grid, zipped)]
    assert pairs == [[(10, 1), (10, 2), (20, 1), (20, 2)], [(10, 1), (20, 2)]]
    assert [case.name for case in grid.cases] == ["case_1", "case_2", "case_3", "case_4"]


def values(read, text: str) -> list[float]:
    return [case.values[SPEED] for case in read(vary(f"  {SPEED}: {text}\n")).cases]


def test_ranges(read):
    assert values(read, "{from: 1, to: 2, count: 5}") == [1.0, 1.25, 1.5, 1.75, 2.0]
    assert values(read, "{from: 3, to: -1, count: 5}") == [3, 2, 1, 0, -1]
    numbers = values(read, "{from: 0.1, to: 1e3, count: 81, scale: log}")
    assert (numbers[0], numbers[-1], len(numbers)) == (0.1, 1e3, 81)
    # Equal ratios, to a few roundings of a power.
    assert all(math.isclose(b / a, 10 ** (4 / 80), rel_tol=1e-14) for a, b in pairwise(numbers))


def test_a_range_of_whole_numbers_fits_whole_numbers(read):
    key = "model.bodies.arm.flexible.elements"
    sweep = read(vary(f"  {key}: {{from: 2, to: 32, count: 5, scale: log}}\n"))
    assert [sweep.scenario(case).model.bodies["arm"].flexible.elements for case in sweep.cases] == [2, 4, 8, 16, 32]


def sampled(read, method: str, count: int, more: str = "", ranges: str = "") -> np.ndarray:
    """Values of the keys in each case."""
    ranges = ranges or f"{{{SPEED}: [2, 10], medium.eta_d: {{from: 1, to: 100, scale: log}}}}"
    sweep = read(sample(f"  method: {method}\n  count: {count}\n{more}", ranges))
    return np.array([list(case.values.values()) for case in sweep.cases], dtype=float)


def strata(values: np.ndarray, count: int) -> list[list[int]]:
    """How many values of each key lie in each of `count` equal parts of its range."""
    fractions = np.column_stack([(values[:, 0] - 2) / 8, np.log10(values[:, 1]) / 2])
    return [np.bincount((column * count).astype(int), minlength=count).tolist() for column in fractions.T]


def test_a_latin_hypercube_has_one_case_in_each_stratum(read):
    assert strata(sampled(read, "latin_hypercube", 100), 100) == [[1] * 100] * 2


def test_sobol_points_are_even_in_powers_of_two(read):
    values = sampled(read, "sobol", 64)
    assert strata(values, 64) == [[1] * 64] * 2
    # In both keys at once too, which a Latin hypercube does not promise.
    squares = np.floor(values[:, 0] - 2).astype(int) * 8 + np.floor(4 * np.log10(values[:, 1])).astype(int)
    assert sorted(squares) == list(range(64))


@pytest.mark.parametrize("method", ["latin_hypercube", "sobol", "saltelli"])
def test_a_seed_gives_the_same_cases(read, method):
    original, same, other = (sampled(read, method, 16, f"  seed: {seed}\n") for seed in (1, 1, 2))
    assert np.array_equal(original, same)
    assert not np.isclose(original, other).all(axis=1).any()
    assert np.array_equal(sampled(read, method, 16), sampled(read, method, 16, "  seed: 0\n"))


def test_one_at_a_time_varies_each_key_alone(read):
    key = "model.bodies.arm.flexible.elements"
    ranges = f"{{{SPEED}: [2, 10], {key}: {{from: 2, to: 8, scale: log}}}}"
    sweep = read(sample("  method: one_at_a_time\n  count: 3\n", ranges))
    varied = [case.values for case in sweep.cases]
    assert varied == [{}, {SPEED: 2}, {SPEED: 6}, {SPEED: 10}, {key: 2}, {key: 4}, {key: 8}]
    assert sweep.keys == (SPEED, key)
    assert sweep.scenario(sweep.cases[0]) == sweep.base
    assert sweep.scenario(sweep.cases[-1]).model.bodies["arm"].flexible.elements == 8


def test_saltelli_mixes_two_samples(read):
    values = sampled(read, "saltelli", 8)
    a, b, first, second = values.reshape(4, 8, 2)
    assert not np.isclose(a, b).any()
    assert np.array_equal(first, np.column_stack([b[:, 0], a[:, 1]]))
    assert np.array_equal(second, np.column_stack([a[:, 0], b[:, 1]]))
    assert strata(a, 8) == strata(b, 8) == [[1] * 8] * 2


def test_a_sample_is_written_back_unchanged(read):
    sweep = read(sample("  method: sobol\n  count: 4\n  seed: 3\n", f"{{{SPEED}: {{from: 1, to: 9, scale: log}}}}"))
    ranges = {SPEED: {"from": 1, "to": 9, "scale": "log"}}
    assert sweep.sample.plain() == {"method": "sobol", "count": 4, "seed": 3, "ranges": ranges}
    assert read(vary(f"  {SPEED}: [1]\n")).sample is None


def test_cases_without_own_files_can_be_sent_to_other_machines(read, tmp_path):
    """Of cases that name files themselves the scenario has to be sent."""
    (tmp_path / "arm.yaml").write_text((ROOT / "models" / "compound_pendulum.yaml").read_text().replace("7700", "2700"))
    initial = f"initial: {{{SPEED[8:]}: 6, {ANGLE[8:]}: 31}}"
    (tmp_path / "arm_run.yaml").write_text(f"model: arm.yaml\nmedium: play_sand\n{initial}\n")
    sweep = read(
        "config: arm_run.yaml\nset: {medium.eta_h: 9, gravity_m_s2: 9}\ncases:\n"
        "  a: {}\n  b: {solver.step_s: 1e-4}\n  c: {model.bodies.link.diameter_m: 0.005}\n"
        "  d: {model: compound_pendulum}\n  e: {medium: null}\n"
    )
    assert [sweep.needs_files(case) for case in sweep.cases] == [False, False, False, True, True]
    sent = pickle.dumps((sweep.without_cases(), sweep.cases[:3]))
    expected = [sweep.scenario(case) for case in sweep.cases[:3]]
    (tmp_path / "arm.yaml").unlink()
    elsewhere, cases = pickle.loads(sent)
    assert len(elsewhere.cases) == 0
    assert [elsewhere.scenario(case) for case in cases] == expected
    assert len({str(scenario) for scenario in expected}) == 3
    with pytest.raises(ConfigError, match=r"no file .*arm\.yaml"):
        read("config: arm_run.yaml\ncases: {a: {}}\n")


def test_the_twelve_cases_are_those_of_the_paper():
    sweep = load_sweep(ROOT / "configs" / "paper_cases.yaml")
    table = {22: (1.75, 3.38, 4.66), 31: (3.31, 6.24, 8.41), 45: (2.66, 6.47, 9.06), 61.5: (2.70, 6.54, 9.17)}
    assert [tuple(case.values.values()) for case in sweep.cases] == [(a, s) for a in table for s in table[a]]
    assert sweep.keys == (ANGLE, SPEED)
    # Two of them are what the other configs say.
    start = load(ROOT / "configs" / "pendulum.yaml").scenario
    assert start in [sweep.scenario(case) for case in sweep.cases]


def test_a_thousand_cases_are_read(read):
    sweep = read(vary(f"  {ANGLE}: {{from: 1, to: 60, count: 50}}\n  {SPEED}: {{from: 1, to: 9, count: 20}}\n"))
    assert len(sweep.cases) == 1000
    assert (sweep.cases[0].name, sweep.cases[-1].name) == ("case_0001", "case_1000")


def test_shipped_files_are_found_by_name(tmp_path, monkeypatch) -> None:
    """A config by a sweep, and sweeps and searches themselves; a file of that name beside them comes first."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.yaml").write_text("config: hexapod\nvary: {bed.slope_deg: [0, 5]}\n", encoding="utf-8")
    assert load_sweep("mine.yaml").base.name == "hexapod"
    assert load_sweep("wheel_slip").base.name == "wheel"
    assert load_optimise("optimise_c_leg").sweep.base.name == "runner"
    config = (ROOT / "configs" / "pendulum.yaml").read_text(encoding="utf-8")
    (tmp_path / "hexapod").write_text(
        config.replace("model: compound_pendulum", "name: own\nmodel: compound_pendulum"), encoding="utf-8"
    )
    assert load_sweep("mine.yaml").base.name == "own"


def test_a_config_that_is_like_a_shipped_one_is_asked_about(tmp_path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text("config: hexapot\nvary: {bed.slope_deg: [0, 5]}\n", encoding="utf-8")
    with pytest.raises(ConfigError, match="did you mean hexapod"):
        load_sweep(file)
