"""Each kind of bad input: one fault, at its line, under its key, with the value and what is allowed."""

import pytest
from support_config import GOOD, changed

from granular_contact.laws.rft import GENERIC

# old text, new text, line, key, words that the message must hold
SCHEMA_FAULTS = [
    # unknown keys: nearest name, or the list
    ("gravity_m_s2:", "gravity_ms2:", 28, "gravity_ms2", ["unknown key", "did you mean gravity_m_s2?"]),
    ("gravity_m_s2: 9.81", "zzz: 1", 28, "zzz", ["unknown key", "allowed are name, model, medium"]),
    ("  step_s:", "  stepp_s:", 38, "solver.stepp_s", ["did you mean step_s?"]),
    (
        "      length_m: 0.2\n",
        "      length_m: 0.2\n      lenght_m: 1\n",
        14,
        "model.bodies.arm.lenght_m",
        ["length_m"],
    ),
    ("elements: 4", "element: 4", 18, "model.bodies.arm.flexible.element", ["did you mean elements?"]),
    ("thickness_m: 0.01", "thickness_m: 0.01, colour: red", 9, "model.bodies.hub.shapes.0.colour", ["center_m"]),
    ("eta_h: 8", "eta_h: 8\n  eta_q: 1", 27, "medium.eta_q", ["unknown key", "eta_"]),
    ("lambda: 1.1", "lambda: 1.1, lambda_: 2", 27, "medium.plunging.lambda_", ["did you mean lambda?"]),
    ("child: hub}", "child: hub, angle_deg: 0}", 20, "model.joints.pivot.angle_deg", ["unknown key"]),
    # not similar by its unit alone
    (
        "thickness_m: 0.01",
        "thickness_m: 0.01, lateral_m: 1",
        9,
        "model.bodies.hub.shapes.0.lateral_m",
        ["key; allowed are"],
    ),
    # known elsewhere
    ("eta_h: 8", "eta_h: 8\n  step_s: 1", 27, "medium.step_s", ["wrong place", "belongs at solver.step_s"]),
    ("  impact_angle_deg: 31\n", "  medium: null\n", 30, "initial.medium", ["belongs at medium"]),
    ("diameter_m: 0.006\n", "diameter_m: 0.006\n      elements: 2\n", 15, "model.bodies.arm.elements", ["flexible"]),
    # known elsewhere by another meaning: the height of a bed is not that of its floor
    ("gravity_m_s2: 9.81", "bed: {floor: {height_m: -0.1, stiffness_N_m2: 1.0}}", 28, "bed.floor.height_m", ["depth"]),
    (
        "gravity_m_s2: 9.81",
        "bed: {layers: [{top_m: 1, depth_m: 1, medium: {law: rft, zeta: 1}}]}",
        28,
        "bed.layers.0.depth_m",
        ["top_m"],
    ),
    # missing keys, at the mapping that lacks them
    ("      diameter_m: 0.006\n", "", 11, "model.bodies.arm.diameter_m", ["is missing", "above 0"]),
    (", thickness_m: 0.01", "", 9, "model.bodies.hub.shapes.0.thickness_m", ["is missing"]),
    (", end_m: [0.02, 0]", "", 10, "model.bodies.hub.shapes.1.end_m", ["is missing", "2 numbers"]),
    ("  eta_d: 6.5\n", "", 22, "medium.eta_d", ["is missing", "of at least 0"]),
    ("  name: arm\n", "", 2, "model.name", ["is missing", "text"]),
    (", lambda: 1.1", "", 27, "medium.plunging.lambda", ["is missing", "from 0 to 5"]),
    ("gravity_m_s2: 9.81", "bed: {slope_deg: 3,5, depth_m: 1}", 28, "bed", ["the key 5", "decimals have a point"]),
    # tags of unions
    ("type: link", "type: lnk", 12, "model.bodies.arm.type", ["the text 'lnk'", "did you mean link?"]),
    ("type: link", "type: sponge", 12, "model.bodies.arm.type", ["link, rigid"]),
    ("type: link", "type: 3", 12, "model.bodies.arm.type", ["the number 3", "link, rigid"]),
    ("type: link", "type: null", 12, "model.bodies.arm.type", ["null", "link, rigid"]),
    ("type: link", "type: [link]", 12, "model.bodies.arm.type", ["a list of 1 item", "link, rigid"]),
    ("      type: link\n", "", 11, "model.bodies.arm.type", ["is missing", "link, rigid"]),
    ("type: disc", "type: ball", 9, "model.bodies.hub.shapes.0.type", ["'ball'", "cylinder, disc"]),
    (
        "type: hinge",
        "type: ball",
        20,
        "model.joints.pivot.type",
        ["fixed, floating, free, hinge, prismatic, revolute, slider, weld"],
    ),
    ("law: lee_marghitu", "law: lee_marghittu", 23, "medium.law", ["did you mean lee_marghitu?"]),
    ("type: smooth", "type: sticky", 35, "load.friction.type", ["elastoplastic, smooth"]),
    ("form: distributed", "form: lumped", 33, "load.form", ["'lumped'", "distributed, resultant"]),
    # wrong types
    ("eta_d: 6.5", "eta_d: true", 25, "medium.eta_d", ["the boolean true", "a finite number of at least 0"]),
    ("eta_d: 6.5", "eta_d: '6.5'", 25, "medium.eta_d", ["the text '6.5'", "without quotes"]),
    ("eta_d: 6.5", "eta_d: fast", 25, "medium.eta_d", ["the text 'fast'"]),
    ("eta_d: 6.5", "eta_d: null", 25, "medium.eta_d", ["got null"]),
    ("eta_d: 6.5", "eta_d:", 25, "medium.eta_d", ["got null"]),
    ("eta_d: 6.5", "eta_d: [6.5]", 25, "medium.eta_d", ["a list of 1 item"]),
    ("eta_d: 6.5", "eta_d: {a: 1}", 25, "medium.eta_d", ["a mapping"]),
    ("eta_d: 6.5", "eta_d:\n    six", 26, "medium.eta_d", ["'six'"]),
    ("eta_d: 6.5", "eta_d: 1_000", 25, "medium.eta_d", ["'1_000'", "1e-3"]),
    ("eta_d: 6.5", "eta_d: 010", 25, "medium.eta_d", ["'010'"]),
    ("eta_d: 6.5", "eta_d: 0x1F", 25, "medium.eta_d", ["'0x1F'"]),
    ("eta_d: 6.5", "eta_d: 1:30", 25, "medium.eta_d", ["'1:30'"]),
    ("eta_d: 6.5", "eta_d: 2024-01-02", 25, "medium.eta_d", ["'2024-01-02'"]),
    ("eta_d: 6.5", "eta_d: 6,5", 25, "medium.eta_d", ["'6,5'"]),
    ("elements: 4", "elements: 4.0", 18, "model.bodies.arm.flexible.elements", ["4.0", "whole number from 1 to 1024"]),
    ("elements: 4", "elements: true", 18, "model.bodies.arm.flexible.elements", ["the boolean true"]),
    ("end_cap: false", "end_cap: no", 34, "load.end_cap", ["the text 'no'", "true or false"]),
    ("end_cap: false", "end_cap: 0", 34, "load.end_cap", ["the number 0", "true or false"]),
    ("name: strike", "name: 12", 1, "name", ["the number 12", "text, or null"]),
    ("name: strike", "name: '1e3'", 1, "name", ["'1e3'", "reads as a number"]),
    ("end_m: [0.02, 0]", "end_m: 0.02", 10, "model.bodies.hub.shapes.1.end_m", ["a list of 2 numbers"]),
    ("end_m: [0.02, 0]", "end_m: [0.02]", 10, "model.bodies.hub.shapes.1.end_m", ["1 item;", "a list of 2 numbers"]),
    ("end_m: [0.02, 0]", "end_m: [1, 2, 3]", 10, "model.bodies.hub.shapes.1.end_m", ["3 items", "a list of 2 numbers"]),
    ("end_m: [0.02, 0]", "end_m: [1, x]", 10, "model.bodies.hub.shapes.1.end_m.1", ["'x'", "a finite number"]),
    ("initial:\n  impact_angle_deg: 31\n  impact_speed_rad_s: 6\n", "initial: 31\n", 29, "initial", ["a mapping"]),
    ("output:\n  interval_s: 1e-3\n", "output: null\n", 39, "output", ["null", "interval_s, figures"]),
    # out of range, not finite
    ("eta_d: 6.5", "eta_d: -1", 25, "medium.eta_d", ["-1", "of at least 0"]),
    ("eta_d: 6.5", "eta_d: .inf", 25, "medium.eta_d", [".inf", "finite"]),
    ("eta_d: 6.5", "eta_d: .nan", 25, "medium.eta_d", [".nan", "finite"]),
    ("eta_d: 6.5", "eta_d: 1e400", 25, "medium.eta_d", ["1e400", "finite"]),
    pytest.param("eta_d: 6.5", f"eta_d: {'9' * 5000}", 25, "medium.eta_d", ["999...", "finite"], id="5000 digits"),
    ("lambda: 1.1", "lambda: 5.1", 27, "medium.plunging.lambda", ["5.1", "from 0 to 5"]),
    ("length_m: 0.2", "length_m: 0", 13, "model.bodies.arm.length_m", ["got the number 0;", "above 0"]),
    ("impact_angle_deg: 31", "impact_angle_deg: 91", 30, "initial.impact_angle_deg", ["91", "from -90 to 90"]),
    ("elements: 4", "elements: 0", 18, "model.bodies.arm.flexible.elements", ["0", "from 1 to 1024"]),
    ("step_s: 1e-3", "tolerance: 1", 38, "solver.tolerance", ["above 0 and below 1"]),
    ("step_s: 1e-3", "spectral_radius: 1.2", 38, "solver.spectral_radius", ["1.2", "from 0 to 1"]),
    ("step_s: 1e-3", "rest_time_s: 0", 38, "solver.rest_time_s", ["above 0, or null"]),
    ("elements: 4", "elements: 1" + "0" * 400, 18, "model.bodies.arm.flexible.elements", ["from 1 to 1024"]),
    # what fits singly but not together
    ("step_s: 1e-3", "step_s: 1e-9", 38, "solver.step_s", ["5e+08 steps to end_time_s, 0.5", "allowed are 1e+08"]),
    ("step_s: 1e-3", "step_s: 0.75", 38, "solver.step_s", ["0.75", "end_time_s, 0.5"]),
    ("elements: 4", "youngs_modulus_Pa: 2e11", 16, "model.bodies.arm.flexible", ["both", "exactly one"]),
    ("bending_stiffness_N_m2: 15", "axial_stiffness_N: 15", 16, "model.bodies.arm.flexible", ["neither"]),
    ("end_m: [0.02, 0]", "end_m: [0, 0.0]", 10, "model.bodies.hub.shapes.1.end_m", ["start_m", "differ"]),
    ("parent: hub", "parent: hubb", 21, "model.joints.clamp.parent", ["'hubb'", "did you mean hub?"]),
    ("parent: hub", "parent: xyz", 21, "model.joints.clamp.parent", ["there are ground, hub, arm"]),
    ("parent: hub", "parent: arm", 21, "model.joints.clamp.child", ["joins arm to itself"]),
]


def _name(value: object) -> str | None:
    return value[:40] if isinstance(value, str) else ""


@pytest.mark.parametrize(("old", "new", "line", "key", "message"), SCHEMA_FAULTS, ids=_name)
def test_schema_fault(faults, old, new, line, key, message):
    text = changed(old, new)
    reported = faults(text)
    assert [(fault.file, fault.line, fault.key) for fault in reported] == [("run.yaml", line, key)]
    assert [word for word in message if word not in reported[0].message] == []
    assert "\n" not in reported[0].message
    assert len(reported[0].message) < 250


BODIES = GOOD[: GOOD.index("  joints:")]
REST = GOOD[GOOD.index("medium:") :]
FIRST = BODIES.count("\n") + 2  # line of the first joint
# joints, then for each fault: line after the first joint, key below `model`, word of the message
STRUCTURES = {
    "no joint": ([("ground", "hub")], [(0, "bodies.arm", "no joint has arm")]),
    "ground as child": (
        [("ground", "hub"), ("hub", "arm"), ("hub", "ground")],
        [(2, "joints.j2.child", "can't be a child")],
    ),
    "two parents": (
        [("ground", "hub"), ("hub", "arm"), ("ground", "arm")],
        [(2, "joints.j2.child", "child of j1 already")],
    ),
    "cycle": ([("arm", "hub"), ("hub", "arm")], [(0, "joints.j0.parent", "hub -> arm -> hub is a closed chain")]),
    "cycle and more": (
        [("arm", "hub"), ("hub", "arm"), ("ground", "foot")],
        [(0, "joints.j0.parent", "closed chain"), (2, "joints.j2.child", "no body 'foot'")],
    ),
    "several at once": (
        [("groun", "hub"), ("hub", "arms")],
        [(0, "bodies.arm", "no joint"), (0, "joints.j0.parent", "mean ground"), (1, "joints.j1.child", "mean arm")],
    ),
}


@pytest.mark.parametrize("case", STRUCTURES)
def test_bodies_not_joined_to_the_ground_are_refused(faults, case):
    joints, expected = STRUCTURES[case]
    lines = [f"    j{i}: {{type: weld, parent: {p}, child: {c}}}\n" for i, (p, c) in enumerate(joints)]
    reported = faults(BODIES + "  joints:\n" + "".join(lines) + REST)
    assert [fault.key for fault in reported] == [f"model.{key}" for _, key, _ in expected]
    for fault, (line, key, message) in zip(reported, expected, strict=True):
        assert fault.line == (FIRST + line if key.startswith("joints") else 11)
        assert message in fault.message


def test_names_of_bodies_are_checked(faults):
    reported = faults(GOOD.replace("arm:\n", "a b:\n").replace("child: arm", "child: a b"))
    assert [(f.line, f.key) for f in reported] == [(11, "model.bodies.a b")]
    assert "letters, digits, _ and - are allowed" in reported[0].message
    reported = faults(GOOD.replace("    arm:\n", "    ground:\n").replace("child: arm", "child: hub"))
    assert (11, "model.bodies.ground", "the name ground is that of the fixed frame; give the body another") in [
        (f.line, f.key, f.message) for f in reported
    ]


def test_all_faults_at_once(faults):
    """One of each family, spread over the file: none hides another, and they come in the order of the lines."""
    text = GOOD
    for old, new in [
        ("name: strike", "nmae: strike"),
        ("density_kg_m3: 7700\n      shapes", "density_kg_m3: 0\n      shapes"),
        ("length_m: 0.2", "length_m: !!float 0.2"),
        ("parent: hub", "parent: hubb"),
        ("eta_d: 6.5", "eta_d: yes"),
        ("eta_h: 8", "eta_h: 8\n  eta_h: 9"),
        ("form: distributed", "form: lumped"),
        ("  step_s: 1e-3", "  step_s: 2"),
    ]:
        assert text.count(old) == 1
        text = text.replace(old, new)
    reported = faults(text, "output.figures=1", "nonsense")
    assert [(f.file, f.line, f.key) for f in reported] == [
        ("--set nonsense", None, ""),
        ("--set output.figures=1", None, "output.figures"),
        ("run.yaml", 1, "nmae"),
        ("run.yaml", 7, "model.bodies.hub.density_kg_m3"),
        ("run.yaml", 13, "model.bodies.arm.length_m"),
        ("run.yaml", 21, "model.joints.clamp.parent"),
        ("run.yaml", 25, "medium.eta_d"),
        ("run.yaml", 27, "medium.eta_h"),
        ("run.yaml", 34, "load.form"),
        ("run.yaml", 39, "solver.step_s"),
    ]


def test_a_fault_is_printable(faults):
    [fault] = faults(GOOD + '"a\\nb\\e[31m": 1\n')
    assert str(fault).startswith("run.yaml:41: a\\nb\\x1b[31m: unknown key")


def test_a_fault_reads_as_one_line(faults):
    [fault] = faults(changed("eta_d: 6.5", "eta_d: -1"))
    assert str(fault) == "run.yaml:25: medium.eta_d: got the number -1; allowed is a finite number of at least 0"


@pytest.mark.parametrize(("name", "value"), [("D10", 0.5), ("A00", 0.5), ("B01", -0.3)])
def test_a_medium_cannot_push_along(faults, name, value):
    """Such coefficients once drove what lay in the sand; those published resist every motion."""
    given = dict(GENERIC) | {name: value}
    rows = "".join(f"    {key}: {number}\n" for key, number in given.items())
    (fault,) = faults(
        f"model: compound_pendulum\nmedium:\n  law: rft\n  alpha_N_cm3:\n{rows}initial: {{impact_angle_deg: 9}}\n"
    )
    assert (fault.line, fault.key) == (4, "medium.alpha_N_cm3")
    assert fault.message.startswith("pushes an element at beta ")


def test_numbers_whose_powers_overflow_are_refused(faults):
    """A corner at 1e308 m once was farther than any tip."""
    far = "model:\n  from: compound_pendulum\n  bodies:\n    link: {length_m: 1e+308}\ninitial: {impact_angle_deg: 9}\n"
    (fault,) = faults(far, "gravity_m_s2=1e60")
    assert (fault.line, fault.key) == (4, "model.bodies.link.length_m")
    assert fault.message == "got the number 1e+308; allowed are numbers up to 1e+60 in size"


def test_corners_whose_squares_overflow_are_refused(faults):
    corners = "[[0, 0], [1e+300, 0], [1e+300, 1e+300], [0, 0.1]]"
    polygon = f"        - {{type: polygon, width_m: 0.1, points_m: {corners}}}\n"
    reported = faults(changed("      shapes:\n", f"      shapes:\n{polygon}"))
    assert {fault.message for fault in reported} == {"got the number 1e+300; allowed are numbers up to 1e+60 in size"}
    assert {fault.line for fault in reported} == {9}
