"""Faults of joints, loops, chains, initial states, drives and the columns they follow: one line each."""

import pytest

from granular_contact.config import load

HEAD = """\
model:
  name: leg
  bodies:
    thigh: {type: link, length_m: 0.1, diameter_m: 0.006, density_kg_m3: 7700}
    shank: {type: link, length_m: 0.1, diameter_m: 0.006, density_kg_m3: 7700}
    foot: {type: link, length_m: 0.02, diameter_m: 0.006, density_kg_m3: 7700}
  joints:
    rail: {type: slider, parent: ground, child: thigh, axis: [0, 1]}
    knee: {type: hinge, parent: thigh, child: shank, parent_point_m: [0.1, 0]}
    ankle: {type: weld, parent: shank, child: foot, parent_point_m: [0.1, 0]}
  closures: {}
initial: {joints: {}}
"""
DRIVES = "drives:\n"
SINE = "{type: sine, amplitude: 1, frequency_Hz: 2}"

# old text, new text (or lines added at the end if there is no old), line, key, words of the message
FAULTS = {
    "friction without a size": ("axis: [0, 1]", "friction: {}", 8, "model.joints.rail.friction.force_N", "is missing"),
    "axis as an angle": ("axis: [0, 1]", "axis_deg: 90", 8, "model.joints.rail.axis_deg", "did you mean axis?"),
    "stops the wrong way": (
        "axis: [0, 1]",
        "stops: {lower_m: 1, upper_m: 0, stiffness_N_per_m: 10}",
        8,
        "model.joints.rail.stops.lower_m",
        "got 1; allowed is below upper_m, 0",
    ),
    "spring of the wrong unit": (
        "axis: [0, 1]",
        "spring: {stiffness_N_per_m: 1, rest_deg: 3}",
        8,
        "model.joints.rail.spring.rest_deg",
        "did you mean rest_m?",
    ),
    "free on a body": (
        "{type: hinge, parent: thigh",
        "{type: free, parent: thigh",
        9,
        "model.joints.knee.parent",
        "got 'thigh'; a free joint has the parent ground",
    ),
    "closure to nobody": (
        "closures: {}",
        "closures: {loop: {type: hinge, parent: ground, child: foott}}",
        11,
        "model.closures.loop.child",
        "there is no body 'foott'; did you mean foot?",
    ),
    "closure called as a joint": (
        "closures: {}",
        "closures: {knee: {type: hinge, parent: ground, child: foot}}",
        11,
        "model.closures.knee",
        "knee is the name of a joint already",
    ),
    "closure with a home": (
        "closures: {}",
        "closures: {loop: {type: hinge, parent: ground, child: foot, home_deg: 3}}",
        11,
        "model.closures.loop.home_deg",
        "unknown key",
    ),
    "start of nobody": (
        "joints: {}}",
        "joints: {kneee: {angle_deg: 3}}}",
        12,
        "initial.joints.kneee",
        "there is no joint 'kneee'; did you mean knee?",
    ),
    "start of a weld": (
        "joints: {}}",
        "joints: {ankle: {angle_deg: 3}}}",
        12,
        "initial.joints.ankle",
        "ankle is a weld, which has no state",
    ),
    "start of another joint": (
        "joints: {}}",
        "joints: {rail: {angle_deg: 3}}}",
        12,
        "initial.joints.rail.angle_deg",
        "rail is a slider; allowed are position_m, speed_m_s",
    ),
    "impact without a hinge": (
        "joints: {}}",
        "impact_angle_deg: 3}",
        12,
        "initial.impact_angle_deg",
        "no hinge and no weld is on the ground",
    ),
    "settling at speed": (
        "joints: {}}",
        "settle: true, joints: {knee: {rate_rad_s: 3}}}",
        12,
        "initial.joints.knee.rate_rad_s",
        "got 3, but settle is true: allowed is 0",
    ),
    "drive of nobody": (
        "",
        f"  kneee: {{type: torque, torque_Nm: {SINE}}}\n",
        14,
        "drives.kneee",
        "there is no joint 'kneee'; did you mean knee?",
    ),
    "drive on a weld": (
        "",
        "  ankle: {type: torque, torque_Nm: 1}\n",
        14,
        "drives.ankle",
        "ankle is a weld, which can't be driven; allowed are hinges and sliders",
    ),
    "torque on a slider": (
        "",
        "  rail: {type: torque, torque_Nm: 1}\n",
        14,
        "drives.rail.torque_Nm",
        "rail is a slider; a drive of a slider has one of the keys force_N, position_m, speed_m_s",
    ),
    "motion of a closure": (
        "closures: {}",
        "closures: {loop: {type: hinge, parent: ground, child: foot}}\ndrives: {loop: {type: motion, angle_deg: 1}}",
        12,
        "drives.loop",
        "loop closes a loop; a motion drives a joint of the tree",
    ),
    "two targets": (
        "",
        "  knee: {type: motion, angle_deg: 1, position_m: 2}\n",
        14,
        "drives.knee",
        "got angle_deg and position_m of angle_deg, position_m; exactly one is allowed",
    ),
    "no target": ("", "  knee: {type: motion}\n", 14, "drives.knee", "got none of angle_deg, position_m"),
    "no gain": (
        "",
        "  knee: {type: pd, angle_deg: 1}\n",
        14,
        "drives.knee.gain_Nm_per_rad",
        "got 0 or nothing, so the drive would do nothing",
    ),
    "gain of a speed": (
        "",
        "  knee: {type: pd, rate_rad_s: 1, gain_Nm_per_rad: 2, rate_gain_Nm_s_per_rad: 1}\n",
        14,
        "drives.knee.gain_Nm_per_rad",
        "got 2, but a speed is controlled",
    ),
    "clock of a torque": (
        "",
        "  knee: {type: torque, torque_Nm: {type: buehler, frequency_Hz: 1, stance_sweep_deg: 40, duty_factor: 0.5}}\n",
        14,
        "drives.knee.torque_Nm",
        "got a buehler clock, which gives angles",
    ),
    "clock without time to blend": (
        "",
        "  knee: {type: motion, angle_deg: "
        "{type: buehler, frequency_Hz: 1, stance_sweep_deg: 40, duty_factor: 0.02}}\n",
        14,
        "drives.knee.angle_deg.blend",
        "got 0.05; allowed is at most 0.02, the shorter of stance and swing",
    ),
    "clock that only blends": (
        "",
        "  knee: {type: motion, angle_deg: "
        "{type: buehler, frequency_Hz: 1, stance_sweep_deg: 40, duty_factor: 0.5, blend: 0.6}}\n",
        14,
        "drives.knee.angle_deg.blend",
        "got the number 0.6; allowed is a finite number above 0 and at most 0.5",
    ),
    "no such signal": (
        "",
        "  knee: {type: motion, angle_deg: gait}\n",
        14,
        "drives.knee.angle_deg",
        "there is no signal 'gait'; there are none",
    ),
    "unknown kind of signal": (
        "",
        "  knee: {type: motion, angle_deg: {type: sinus}}\n",
        14,
        "drives.knee.angle_deg.type",
        "did you mean sine?",
    ),
    "table that goes back": (
        "",
        "  knee: {type: motion, angle_deg: {type: table, time_s: [0, 2, 1], values: [0, 0, 0]}}\n",
        14,
        "drives.knee.angle_deg.time_s",
        "got 1 after 2; allowed are instants that grow",
    ),
}


@pytest.mark.parametrize("case", FAULTS)
def test_mechanism_fault(faults, case):
    old, new, line, key, message = FAULTS[case]
    text = HEAD.replace(old, new) if old else HEAD + DRIVES + new
    assert text != HEAD
    reported = faults(text)
    assert [(fault.line, fault.key) for fault in reported] == [(line, key)]
    assert message in reported[0].message
    assert len(reported[0].message) < 250


def test_an_unused_signal_is_reported(tmp_path):
    text = HEAD + f"signals:\n  gait: {SINE}\n  idle: {SINE}\ndrives:\n  knee: {{type: motion, angle_deg: gait}}\n"
    path = tmp_path / "idle.yaml"
    path.write_text(text, encoding="utf-8")
    message = f"{path}:15: signals.idle: no drive uses it; a drive gives its name as the signal"
    assert [notice for notice in load(path).sources.notices if "signals" in notice] == [message]


def test_the_phase_of_a_shared_signal_needs_a_period(faults):
    shared = "{type: shared, name: gait, phase_deg: 90}"
    text = HEAD + f"signals:\n  gait: 3\ndrives:\n  knee: {{type: motion, angle_deg: {shared}}}\n"
    [fault] = faults(text)
    assert (fault.line, fault.key) == (16, "drives.knee.angle_deg.phase_deg")
    assert fault.message == "got 90, but gait is a constant: allowed is 0"


CHAIN = """\
model:
  name: rope
  chain:
    count: 3
    link: {length_m: 0.1, diameter_m: 0.006, density_kg_m3: 7700}
initial: {impact_angle_deg: 10}
"""
CHAIN_FAULTS = {
    "no link": (
        "count: 3",
        "count: 0",
        4,
        "model.chain.count",
        "got the number 0; allowed is a whole number from 1 to",
    ),
    "a million links": ("count: 3", "count: 1000000", 4, "model.chain.count", "from 1 to 4096"),
    "a faulty link": (
        "diameter_m: 0.006",
        "diameter_m: 0",
        5,
        "model.chain.link.diameter_m",
        "got the number 0; allowed is a finite number above 0",
    ),
    "on nobody": (
        "count: 3",
        "count: 3\n    parent: hook",
        5,
        "model.chain.parent",
        "there is no body 'hook'; there are ground",
    ),
    "on itself": (
        "count: 3",
        "count: 3\n    parent: link_2",
        5,
        "model.chain.parent",
        "link_2 is a link of this chain",
    ),
}


@pytest.mark.parametrize("case", CHAIN_FAULTS)
def test_chain_fault(faults, case):
    old, new, line, key, message = CHAIN_FAULTS[case]
    reported = faults(CHAIN.replace(old, new))
    assert [(fault.line, fault.key) for fault in reported] == [(line, key)]
    assert message in reported[0].message
    assert len(reported[0].message) < 250


def test_a_chain_beside_bodies_of_the_same_names_is_refused(faults):
    more = (
        "  bodies:\n    link_2: {type: link, length_m: 0.1, diameter_m: 0.006, density_kg_m3: 7700}\n"
        "  joints:\n    own: {type: hinge, parent: ground, child: link_2}\ninitial"
    )
    [fault] = faults(CHAIN.replace("initial", more))
    assert fault.key == "model.chain.link_name"
    assert fault.message == "link_2 is the name of a body already; give another"


def test_an_empty_mechanism_is_refused(faults):
    [fault] = faults("model:\n  name: nothing\ninitial: {impact_angle_deg: 10}\n")
    assert (fault.line, fault.key) == (1, "model.bodies")
    assert "or a chain" in fault.message


CSV = "drives:\n  knee: {type: motion, angle_deg: {type: csv, file: gait.csv, column: knee}}\n"
COLUMNS = {
    "no file": (None, ("run.yaml", 14), "drives.knee.angle_deg.file", "can't be read"),
    "no column": ("time_s,hip\n0,1\n1,2\n", ("gait.csv", 1), "drives.knee.angle_deg", "no column 'knee'"),
    "a hole": (
        "time_s,knee\n0,1\n1,\n2,3\n",
        ("gait.csv", 3),
        "drives.knee.angle_deg",
        "got nothing in the column knee",
    ),
    "a word": ("time_s,knee\n0,1\n1,two\n", ("gait.csv", 3), "drives.knee.angle_deg", "got 'two' in the column knee"),
    "a short row": ("time_s,knee\n0,1\n1\n", ("gait.csv", 3), "drives.knee.angle_deg", "got nothing"),
    "not a number": ("time_s,knee\n0,1\n1,nan\n", ("gait.csv", 3), "drives.knee.angle_deg", "got 'nan'"),
    "unsorted": ("time_s,knee\n0,1\n2,2\n1,3\n", ("gait.csv", 4), "drives.knee.angle_deg", "got the time 1 after 2"),
    "one row": ("time_s,knee\n0,1\n", ("gait.csv", None), "drives.knee.angle_deg", "got 1 row of numbers"),
    "empty": ("", ("gait.csv", 1), "drives.knee.angle_deg", "is empty; a line with the names"),
}


@pytest.mark.parametrize("case", COLUMNS)
def test_faulty_columns(faults, tmp_path, monkeypatch, case):
    text, place, key, message = COLUMNS[case]
    monkeypatch.chdir(tmp_path)
    if text is not None:
        (tmp_path / "gait.csv").write_text(text)
    reported = faults(HEAD + CSV)
    assert message in reported[0].message
    assert {(fault.file, fault.line) for fault in reported} == {place}
    assert {fault.key for fault in reported} == {key}
