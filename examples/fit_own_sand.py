"""Coefficients of your own sand from the filmed path of a tip; here a simulation takes the place of the film."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

import numpy as np
from common import panels, save

from granular_contact import load, simulate
from granular_contact.cli import main

FILMED = {"medium.eta_d": 5.0, "medium.plunging.eta_v": 30.0}  # what the fit does not know
RIGID = {"method": {"reduced": {"modes": 0}}}  # for speed: 3 ms a run
NAMES = ("impact_22deg", "impact_61deg")
NOISE = 1e-4  # m
FILE = """
set: {method: {reduced: {modes: 0}}}
parameters: {medium.eta_d: {}, medium.plunging.eta_v: {}}
runs:
  - {config: impact_22deg, data: impact_22deg.csv}
  - {config: impact_61deg, data: impact_61deg.csv}
"""

random = np.random.default_rng(1)
figure, axes = panels(2)
with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    (folder / "own_sand.yaml").write_text(FILE, encoding="utf-8")
    for case in NAMES:
        run, time = simulate(load(case, FILMED | RIGID)), np.arange(0.0, 0.08, 0.002)
        tip = [np.interp(time, run["time_s"], run[key]) + random.normal(0, NOISE, 40) for key in ("tip_x_m", "tip_y_m")]
        table = np.column_stack([time, *tip])
        np.savetxt(folder / f"{case}.csv", table, delimiter=",", header="time_s,tip_x_m,tip_y_m", comments="")
    main(
        ["fit", str(folder / "own_sand.yaml"), "--out", str(folder / "fit"), "--workers", "1", "--no-plots", "--quiet"]
    )
    fit = json.loads((folder / "fit" / "fit.json").read_text(encoding="utf-8"))
    for panel, case in zip(axes, NAMES, strict=True):
        data = np.genfromtxt(folder / f"{case}.csv", delimiter=",", names=True)
        values = {key: parameter["value"] for key, parameter in fit["parameters"].items()}
        unfitted, fitted = (simulate(load(case, numbers | RIGID)) for numbers in ({}, values))
        base, curve = (np.interp(data["time_s"], run["time_s"], run["tip_y_m"]) for run in (unfitted, fitted))
        panel.plot(
            1e3 * data["time_s"], 1e3 * (data["tip_y_m"] - base), "o", color="C1", markersize=3, label="measured"
        )
        panel.plot(1e3 * data["time_s"], 1e3 * (curve - base), "k", label="fitted")
        panel.axhline(0.0, color="0.6", linestyle="--", label="play sand")
        panel.set(xlabel="time (ms)", title=case)
for key, true in FILMED.items():
    parameter = fit["parameters"][key]
    print(f"{key}: {parameter['value']:.2f} +- {parameter['standard_error']:.2f}, true {true:g}")
axes[0].set_ylabel("height of the tip\nabove that in play sand (mm)")
axes[0].legend()
save(figure)
