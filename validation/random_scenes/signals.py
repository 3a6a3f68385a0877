"""Random drives and signals: every drive and every signal of the schema."""

from __future__ import annotations

from random import Random
from typing import Any

Tree = dict[str, Any]
SMOOTH = ("sine", "ramp", "table", "csv", "shared")
SIGNAL_FILE = "signal.csv"


def signal(rng: Random, scene: Tree, middle: float, scale: float, kind: str) -> Any:
    """Draw a signal of a kind about a middle value; shared signals and files of signals are added to the scene."""
    low, high = middle - scale * rng.uniform(0.2, 1.0), middle + scale * rng.uniform(0.2, 1.0)
    if kind == "sine":
        amplitude, frequency = 0.5 * (high - low), rng.uniform(0.5, 8.0)
        return {"type": "sine", "amplitude": amplitude, "frequency_Hz": frequency, "offset": middle}
    if kind == "ramp":
        return {"type": "ramp", "from": middle, "to": rng.choice((low, high)), "duration_s": rng.uniform(0.05, 0.3)}
    if kind == "buehler":
        clock = {"type": "buehler", "frequency_Hz": rng.uniform(0.5, 4.0), "stance_sweep_deg": rng.uniform(40.0, 90.0)}
        return clock | {"duty_factor": rng.uniform(0.4, 0.6), "phase_deg": rng.uniform(0.0, 360.0)}
    if kind == "shared":
        scene.setdefault("signals", {})["clock"] = signal(rng, scene, middle, scale, "sine")
        return {"type": "shared", "name": "clock", "phase_deg": rng.choice((0.0, rng.uniform(0.0, 360.0)))}
    if kind == "constant":
        return rng.choice((low, high))
    times = [0.0, *sorted(rng.uniform(0.03, 0.3) for _ in range(3))]
    values = [middle, *(rng.uniform(low, high) for _ in range(3))]
    if kind == "csv":
        scene["files"] = {SIGNAL_FILE: {"time_s": times, "value": values}}
        return {"type": "csv", "file": SIGNAL_FILE, "column": "value"}
    return {"type": "table", "time_s": times, "values": values}


def hinge_drive(rng: Random, scene: Tree, home: float, scale: float, clock: bool = False) -> Tree:
    """Draw a drive of a hinge that starts at `home` (deg); scale: moment of the mechanism's weight, N m."""
    form = rng.choice(("torque", "motion", "motion", "angle", "angle", "rate"))
    if form == "torque":
        return {"type": "torque", "torque_Nm": _load(rng, scene, scale)}
    kinds = (*SMOOTH, "buehler") if clock else SMOOTH
    if form == "motion":
        return {"type": "motion", "angle_deg": signal(rng, scene, home, 40.0, rng.choice(kinds))}
    gain = scale * 10.0 ** rng.uniform(0.5, 2.0)
    drive: Tree = {"type": "pd", "rate_gain_Nm_s_per_rad": gain * 10.0 ** rng.uniform(-2.0, -1.0)}
    if form == "angle":
        drive |= {"angle_deg": signal(rng, scene, home, 40.0, rng.choice(kinds)), "gain_Nm_per_rad": gain}
    else:
        drive["rate_rad_s"] = signal(rng, scene, 0.0, 6.0, rng.choice(("constant", "sine", "ramp")))
    return drive | ({"limit_Nm": scale * rng.uniform(1.0, 5.0)} if rng.random() < 0.4 else {})


def slider_drive(rng: Random, scene: Tree, weight: float) -> Tree:
    """Draw a drive of a slider that starts at zero; weight: of the mechanism, N."""
    form = rng.choice(("force", "motion", "position", "speed"))
    if form == "force":
        return {"type": "force", "force_N": _load(rng, scene, weight)}
    if form == "motion":
        return {"type": "motion", "position_m": signal(rng, scene, 0.0, 0.05, rng.choice(SMOOTH))}
    gain = weight * 10.0 ** rng.uniform(1.5, 3.0)
    drive: Tree = {"type": "pd_slider", "speed_gain_N_s_per_m": gain * 10.0 ** rng.uniform(-2.0, -1.0)}
    if form == "position":
        drive |= {"position_m": signal(rng, scene, 0.0, 0.05, rng.choice(SMOOTH)), "gain_N_per_m": gain}
    else:
        drive["speed_m_s"] = signal(rng, scene, 0.0, 0.5, rng.choice(("constant", "sine", "ramp")))
    return drive | ({"limit_N": weight * rng.uniform(1.0, 5.0)} if rng.random() < 0.4 else {})


def _load(rng: Random, scene: Tree, scale: float) -> Any:
    return signal(rng, scene, 0.0, scale, rng.choice(("constant", *SMOOTH)))
