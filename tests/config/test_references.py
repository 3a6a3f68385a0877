"""Models and media by name, by path and with `from`; overrides."""

from pathlib import Path

import pytest
import yaml
from support_config import GOOD, changed
from support_refusals import faults_of

from granular_contact.config import is_run, load, scenario_to_dict
from granular_contact.config.load import preset
from granular_contact.errors import ConfigError

START = "initial: {impact_angle_deg: 31}\n"
ARM = GOOD[GOOD.index("model:") : GOOD.index("medium:")].removeprefix("model:\n")
ARM = "".join(line.removeprefix("  ") for line in ARM.splitlines(keepends=True))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("configs/models", "models"):
        (tmp_path / name).mkdir(parents=True)
    return tmp_path


def run(folder: Path, text: str, *overrides: str):
    (folder / "configs" / "run.yaml").write_text(text)
    return load(folder / "configs" / "run.yaml", overrides)


@pytest.mark.parametrize("place", ["models", "configs/models", "configs"])
def test_a_model_is_found_near_the_config(folder, place):
    (folder / place / "arm.yaml").write_text(ARM)
    assert run(folder, START + "model: arm\n").scenario.model.bodies["arm"].length_m == 0.2


def test_a_model_beside_the_config_goes_before_the_installed_one(folder):
    (folder / "models" / "compound_pendulum.yaml").write_text(ARM)
    scenario, sources = run(folder, START + "model: compound_pendulum\n")
    assert scenario.model.name == "arm"
    assert sources.locate("model.bodies.arm.length_m") == (str(folder / "models/compound_pendulum.yaml"), 11)


def test_a_config_named_like_a_shipped_model_is_not_taken_for_the_model(folder):
    (folder / "configs" / "compound_pendulum.yaml").write_text(START + "model: compound_pendulum\n")
    scenario = run(folder, START + "model: compound_pendulum\nmedium: play_sand\n").scenario
    assert list(scenario.model.bodies) == ["RB1", "RB2", "link"]


def test_the_installed_model_is_found_from_anywhere(folder):
    scenario = run(folder, START + "model: compound_pendulum\nmedium: play_sand\n").scenario
    assert list(scenario.model.bodies) == ["RB1", "RB2", "link"]
    assert scenario.medium.plunging.lambda_ == 1.1
    assert scenario.medium.withdrawing is scenario.medium.plunging


def test_a_medium_has_the_measured_scatter_of_one_that_it_names(folder):
    medium_text = "medium: {law: rft, zeta: 1, measured_scatter: cmu_dry_sand, scatter: {measured: locked_wheel}}\n"
    medium = run(folder, START + "model: compound_pendulum\n" + medium_text).scenario.medium
    assert (
        medium.measured_scatter
        == preset("cmu_dry_sand").measured_scatter
        == preset("cmu_dry_sand_plate").measured_scatter
    )
    assert len(medium.measured_scatter) == 3
    with pytest.raises(
        ConfigError, match=r"run.yaml:3: medium.measured_scatter: got 'cmu', but there is no such medium"
    ):
        run(folder, START + "model: compound_pendulum\n" + medium_text.replace("cmu_dry_sand", "cmu"))


def test_a_path_is_relative_to_the_file_that_names_it(folder):
    (folder / "models" / "base.yml").write_text(ARM)
    (folder / "models" / "top.yaml").write_text("from: base.yml\nname: top\nbodies: {arm: {length_m: 0.3}}\n")
    model = run(folder, START + "model: ../models/top.yaml\n").scenario.model
    assert (model.name, model.bodies["arm"].length_m, model.bodies["arm"].diameter_m) == ("top", 0.3, 0.006)


def test_from_merges_mappings_and_replaces_the_rest(folder):
    text = """\
model:
  from: compound_pendulum
  bodies:
    RB1: {shapes: [{type: disc, diameter_m: 1, thickness_m: 1}]}
    link: {flexible: null}
medium: {from: play_sand, eta_h: 9}
"""
    scenario = run(folder, START + text).scenario
    assert scenario.model.bodies["link"].flexible is None
    assert scenario.model.bodies["RB1"].shapes[0].diameter_m == 1
    assert (scenario.medium.eta_h, scenario.medium.eta_d) == (9, 6.5)


# model and medium lines (from line 2), line, key, words
BAD_REFERENCES = [
    ("model: compound_pendulm", 2, "model", ["did you mean compound_pendulum?", "there are"]),
    ("model: zzz", 2, "model", ["'zzz'", "there are", "compound_pendulum"]),
    ("model: zzz.yaml", 2, "model", ["no file", "configs/zzz.yaml"]),
    ("model: ../models", 2, "model", ["no such model"]),
    ("model: ''", 2, "model", ["no such model"]),
    ("model: run", 2, "model", ["no such model"]),
    ("model: 3", 2, "model", ["the number 3", "a path ending in .yaml"]),
    ("model: [a]", 2, "model", ["a list of 1 item"]),
    ("model: {from: 3}", 2, "model.from", ["the number 3"]),
    ("model: {from: zzz}", 2, "model.from", ["no such model"]),
    ("model:\n  name: x\n  from: zzz", 4, "model.from", ["no such model"]),
    ("model: " + "x" * 300 + ".yaml", 2, "model", ["no file"]),
    ("model: compound_pendulum\nmedium: play_snad", 3, "medium", ["did you mean play_sand?"]),
    ("model: compound_pendulum\nmedium: false", 3, "medium", ["the boolean false"]),
    ("model: null", 2, "model", ["got null", "a mapping"]),
    ("medium: null", 1, "model", ["is missing"]),
]


@pytest.mark.parametrize(("text", "line", "key", "message"), BAD_REFERENCES, ids=lambda value: str(value)[:30])
def test_a_faulty_reference_is_refused_at_its_line(folder, text, line, key, message):
    [fault] = faults_of(ConfigError, run, folder, START + text + "\n")
    assert (Path(fault.file).name, fault.line, fault.key) == ("run.yaml", line, key)
    assert [word for word in message if word not in fault.message] == []


def test_a_fault_in_a_model_file_is_located_there(folder):
    (folder / "models" / "arm.yaml").write_text(ARM.replace("length_m: 0.2", "length_m: 0"))
    (folder / "models" / "torn.yaml").write_text("name: [\n")
    for model, line, key in (("arm", 11, "model.bodies.arm.length_m"), ("torn", 2, "")):
        reported = faults_of(ConfigError, run, folder, START + f"model: {model}\ngravity_m_s2: down\n")
        places = [(Path(f.file).name, f.line, f.key) for f in reported]
        assert places == [("run.yaml", 3, "gravity_m_s2"), (f"{model}.yaml", line, key)]


def test_a_cycle_is_refused(folder):
    (folder / "models" / "a.yaml").write_text("from: b\n")
    (folder / "models" / "b.yaml").write_text("\nfrom: a.yaml\n")
    [fault] = faults_of(ConfigError, run, folder, START + "model: a\n")
    assert (Path(fault.file).name, fault.line, fault.key) == ("b.yaml", 2, "model.from")
    assert "a.yaml -> b.yaml -> a.yaml" in fault.message


OVERRIDES = {
    "model.bodies.arm.flexible.elements=8": lambda s: s.model.bodies["arm"].flexible.elements == 8,
    "model.bodies.hub.shapes.0.diameter_m=3e-2": lambda s: s.model.bodies["hub"].shapes[0].diameter_m == 0.03,
    "model.bodies.hub.shapes.1.end_m.1=0.01": lambda s: s.model.bodies["hub"].shapes[1].end_m == (0.02, 0.01),
    "model.bodies.arm.flexible=null": lambda s: s.model.bodies["arm"].flexible is None,
    "model.bodies.arm.flexible={youngs_modulus_Pa: 1}": lambda s: s.model.bodies["arm"].flexible.youngs_modulus_Pa == 1,
    "medium.eta_h=9": lambda s: s.medium.eta_h == 9,
    "medium=null": lambda s: s.medium is None,
    "medium=play_sand": lambda s: s.medium.name == "play_sand",
    "medium={from: play_sand, eta_h: 9}": lambda s: s.medium.eta_h == 9,
    "model=compound_pendulum": lambda s: "RB1" in s.model.bodies,
    "initial.impact_speed_rad_s=8.41": lambda s: s.initial.impact_speed_rad_s == 8.41,
    "load.friction={type: elastoplastic}": lambda s: s.load.friction.type == "elastoplastic",
    "medium.withdrawing={eta_v: 0.5, lambda: 1.7}": lambda s: s.medium.withdrawing != s.medium.plunging,
    "solver.rest_time_s=null": lambda s: s.solver.rest_time_s is None,
    "output.figures=false": lambda s: s.output.figures is False,
}


@pytest.mark.parametrize("override", OVERRIDES)
def test_override(folder, override):
    assert OVERRIDES[override](run(folder, GOOD, override).scenario)
    assert not OVERRIDES[override](run(folder, GOOD).scenario)


def test_from_can_be_overridden(folder):
    model = run(folder, START + "model: {name: mine}\n", "model.from=compound_pendulum").scenario.model
    assert (model.name, list(model.bodies)) == ("mine", ["RB1", "RB2", "link"])


def test_overrides_reach_into_named_files_and_defaults(folder):
    text = START + "model: compound_pendulum\nmedium: play_sand\n"
    overrides = ("model.bodies.link.flexible.elements=8", "medium.eta_h=9", "solver.step_s=1e-3")
    scenario, sources = run(folder, text, *overrides)
    assert scenario.model.bodies["link"].flexible.elements == 8
    assert (scenario.medium.eta_h, scenario.solver.step_s) == (9, 1e-3)
    assert sources.locate("solver.step_s") == ("--set solver.step_s=1e-3", None)


def test_an_override_below_a_default_keeps_the_type_of_the_default(folder):
    text = START + "model: compound_pendulum\n"
    friction = run(folder, text, "load.friction.damping_time_s=2e-3").scenario.load.friction
    assert (friction.type, friction.damping_time_s, friction.yield_displacement_m) == ("elastoplastic", 2e-3, 1e-5)
    for pair in ("load.friction.type=smooth", "load.friction.reference_speed_m_s=2e-3"), (
        "load.friction.reference_speed_m_s=2e-3", "load.friction.type=smooth"
    ):  # fmt: skip
        assert run(folder, text, *pair).scenario.load.friction.reference_speed_m_s == 2e-3


def test_the_last_override_wins(folder):
    assert run(folder, GOOD, "medium.eta_h=9", "medium=null").scenario.medium is None
    assert run(folder, GOOD, "medium=null", "medium=play_sand", "medium.eta_h=9").scenario.medium.eta_h == 9
    assert run(folder, GOOD, "medium.eta_h=9", "medium.eta_h=7").scenario.medium.eta_h == 7


def test_an_override_of_an_alias_leaves_the_anchor_alone(folder):
    text = changed("parent_point_m: [0.02, 0]", "parent_point_m: *p").replace("end_m: [0.02, 0]", "end_m: &p [0.02, 0]")
    model = run(folder, text, "model.joints.clamp.parent_point_m.0=0.5").scenario.model
    assert (model.joints["clamp"].parent_point_m, model.bodies["hub"].shapes[1].end_m) == ((0.5, 0), (0.02, 0))


BAD_OVERRIDES = [
    ("medium.eta_h=x", "medium.eta_h", "the text 'x'"),
    ("medium.eta_h=-1", "medium.eta_h", "of at least 0"),
    ("medium.eta_hh=1", "medium.eta_hh", "did you mean eta_h?"),
    ("solvr.step_s=1", "solvr", "did you mean solver?"),
    ("medium.eta_h", "", "not a dotted.key=value"),
    ("=3", "", "not a dotted.key=value"),
    ("medium..eta_h=3", "", "not a dotted.key=value"),
    ("medium.eta_h=", "medium.eta_h", "write null"),
    ("medium.eta_h=[1", "medium.eta_h", "a list opened with ["),
    ("medium.eta_h=!x 1", "medium.eta_h", "tags are not used"),
    ("medium.eta_h=#", "medium.eta_h", "empty"),
    ("medium.eta_h=\x07", "medium.eta_h", "printable"),
    ("medium.eta_h=\udc80", "medium.eta_h", "printable"),
    ("name.x=3", "name.x", "name is the text 'strike', which has no keys"),
    ("model.bodies.hub.shapes.2.diameter_m=1", "model.bodies.hub.shapes.2.diameter_m", "allowed is 0 to 1"),
    ("model.bodies.hub.shapes.-1.diameter_m=1", "model.bodies.hub.shapes.-1.diameter_m", "allowed is 0 to 1"),
    ("model.bodies.hub.shapes." + "9" * 5000 + "=1", "model.bodies.hub.shapes." + "9" * 5000, "allowed is 0 to 1"),
    ("a." * 5000 + "b=1", "", "64 levels"),
    ("medium=zzz", "medium", "no such medium preset; there are"),
    ("medium={law: zzz}", "medium.law", "lee_marghitu"),
    ("medium={law: lee_marghitu, law: x}", "medium.law", "twice"),
]


@pytest.mark.parametrize(("override", "key", "message"), BAD_OVERRIDES, ids=lambda value: value[:40])
def test_a_bad_override(faults, override, key, message):
    reported = faults(GOOD, override)
    assert (reported[0].file, reported[0].line, reported[0].key) == (f"--set {override}", None, key)
    assert message in reported[0].message
    if override.isprintable():
        assert str(reported[0]).startswith(f"--set {override}: ")


CONFIGS = sorted(path for path in (Path(__file__).parents[2] / "configs").glob("*.yaml") if is_run(path))


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
@pytest.mark.parametrize("settings", [(), ("medium=null", "load.friction={type: smooth}", "name='22'")])
def test_round_trip(path, settings, tmp_path):
    scenario = load(path, settings).scenario
    (tmp_path / "other.yaml").write_text(yaml.safe_dump(scenario_to_dict(scenario)))
    assert load(tmp_path / "other.yaml").scenario == scenario


def test_a_file_name_that_reads_as_a_number_stays_a_text(tmp_path):
    """The stem of a file must not come back as a number from the scenario that a run saves."""
    (tmp_path / "1e3.yaml").write_text(changed("name: strike\n", ""))
    scenario = load(tmp_path / "1e3.yaml").scenario
    (tmp_path / "saved.yaml").write_text(yaml.safe_dump(scenario_to_dict(scenario)))
    assert load(tmp_path / "saved.yaml").scenario == scenario


def test_shipped_configs_hold_the_published_numbers():
    start = {path.stem: load(path).scenario.initial for path in CONFIGS}
    published = {
        "impact_22deg": (22, 3.38),
        "impact_31deg": (31, 6.24),
        "impact_45deg": (45, 6.47),
        "impact_61deg": (61.5, 6.54),
        "pendulum": (31, 6.24),
        "pendulum_rigid": (31, 6.24),
    }
    assert {name: (start[name].impact_angle_deg, start[name].impact_speed_rad_s) for name in published} == published


CHANGED = {
    ("medium.eta_d=3",): ("own", "changed from play_sand: eta_d"),
    ("medium={from: play_sand, eta_d: 3}",): ("own", "changed from play_sand: eta_d"),
    ("medium={from: play_sand, eta_d: 3}", "medium.plunging.eta_v=2"): (
        "own",
        "changed from play_sand: eta_d, plunging",
    ),
    ("medium.withdrawing={eta_v: 1, lambda: 1}",): ("own", "changed from play_sand: withdrawing"),
    ("medium={from: play_sand, eta_d: 3, standing: of a friend}",): ("own", "of a friend"),
    ("medium={from: play_sand, eta_d: 3, provenance: fitted}",): ("fitted", "changed from play_sand: eta_d"),
    # A number as it was, and one that the source left open, change nothing.
    ("medium.eta_d=6.5",): ("published", "read in the text of its source"),
    ("medium={from: hill_cylinders, density_kg_m3: 2000}",): (
        "published",
        "agreed in two or more independent sources",
    ),
    ("medium=mine.yaml",): ("fitted", None),
    ("medium=mine.yaml", "medium.eta_h=4"): ("own", "changed from mine: eta_h"),
}


@pytest.mark.parametrize("overrides", CHANGED)
def test_a_medium_with_changed_numbers_says_so(folder, overrides, monkeypatch):
    monkeypatch.chdir(folder / "configs")
    mine = "{law: albert, name: mine, density_kg_m3: 2500, eta_h: 8, provenance: fitted}"
    (folder / "configs" / "mine.yaml").write_text(mine)
    medium = run(folder, START + "model: compound_pendulum\nmedium: play_sand\n", *overrides).scenario.medium
    assert (medium.provenance, medium.standing) == CHANGED[overrides]


def test_changed_numbers_are_reported_in_lists_and_layers(folder):
    bed = "bed: {layers: [{top_m: 0.01, medium: play_sand}, {top_m: 0.02, medium: rft_generic}]}\n"
    text = START + "model: compound_pendulum\nmedium: [play_sand, rft_generic]\n" + bed
    scenario = run(folder, text, "medium.1.zeta=2", "bed.layers.0.medium.eta_h=2").scenario
    provenances = [medium.provenance for medium in (*scenario.media, *(layer.medium for layer in scenario.bed.layers))]
    assert provenances == ["published", "own", "own", "published"]


def test_missing_numbers_of_a_preset_are_located_where_it_is_named(folder):
    config = folder / "configs" / "run.yaml"
    scenario, sources = run(folder, START + "model: compound_pendulum\nmedium: hill_cylinders\n")
    assert scenario.medium.density_kg_m3 is None
    assert sources.locate("medium.density_kg_m3") == (str(config), 3)
    # So is a medium that does not fit; what it says is where it says it.
    assert sources.locate("medium") == (str(config), 3)
    assert Path(sources.locate("medium.plunging.eta_v")[0]).name == "hill_cylinders.yaml"


def test_a_law_is_no_medium_and_stays_under_from(folder):
    start = START + "model: compound_pendulum\nmedium: "
    for medium, key, message in (
        ("albert", "medium", "which is a law and no medium; give its numbers, as medium: {law: albert, ...}"),
        ("{from: play_sand, law: rft}", "medium.law", "play_sand is of the law lee_marghitu, and law can't change"),
    ):
        [fault] = faults_of(ConfigError, run, folder, start + medium + "\n")
        assert (fault.line, fault.key) == (3, key)
        assert message in fault.message
