"""Prepare the problem of a fit: read configs and data, make a first run of each, and collect all faults."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from granular_contact.config.changed import filled
from granular_contact.config.csv_table import Table, read_table
from granular_contact.config.messages import by_place
from granular_contact.config.overrides import Override, effective
from granular_contact.config.references import readable_path
from granular_contact.config.schema.fit import ForceTest
from granular_contact.config.template import Template
from granular_contact.config.yaml_source import read_file
from granular_contact.errors import ConfigError, Fault, SceneError
from granular_contact.sand.steady import SteadyBody
from granular_contact.scene import build
from granular_contact.studies.fit import checks, force_tests
from granular_contact.studies.fit.law_alone import (
    DEPTH_OFFSET,
    FORCE_OFFSET,
    LawAlone,
    fitted_zeros,
    fixed_zero,
    prescribed_motion,
)
from granular_contact.studies.fit.measurements import TIME, gathered, observables, recognise, refuse, select, with_units
from granular_contact.studies.fit.parameters import Choice, choose, choose_of_run
from granular_contact.studies.fit.problem import OFFSET, MeasuredRun, Parameter, Problem
from granular_contact.studies.fit.responses import HERE, ModelFailed, Simulator
from granular_contact.studies.fit.scatter import faults as scatter_faults
from granular_contact.studies.fit.specification import RunRequest, Specification

NO_KEYS = (OFFSET, DEPTH_OFFSET, FORCE_OFFSET)  # parameters that are no keys of a config

Templates = dict[Path, Template | ConfigError]  # configs that were read, or the faults of reading them


def prepare(request: Specification) -> Problem:
    """Read and check all inputs of a fit, also against the model at the start values.

    Parameters
    ----------
    request : Specification
        The requested fit.

    Returns
    -------
    Problem
        Runs with their data in the units of the columns of results, parameters with bounds and start values, and
        options.

    Raises
    ------
    ConfigError
        With every fault of the configs, the data and the parameters, sorted by file and line.
    """
    faults: list[Fault] = []
    templates: Templates = {}
    sources = []
    for run in request.runs:
        with gathered(faults):
            sources.append(_Source(run, request.common, templates))
    refuse(_in_order(faults))
    faults += _duplicates(request.runs, sources)
    tests = [source for source in sources if source.test is not None]
    faults += force_tests.faults_between_tests([test.measured for test in tests], [test.model for test in tests])
    choices = choose(request.parameters, [source.simulator for source in sources], faults)
    for i, (run, source) in enumerate(zip(request.runs, sources, strict=True)):
        choices += choose_of_run(run, i, source.simulator, faults)
    refuse(_in_order(faults))
    problem = _problem(request, sources, choices, faults)
    refuse(_in_order(faults))
    try:
        faults += checks.without_effect(problem, choices)
    except ModelFailed as error:
        faults.append(Fault(request.name, None, "", f"the model fails at the start values: {error}"))
    refuse(_in_order(faults))
    return problem


def _in_order(faults: Sequence[Fault]) -> list[Fault]:
    return sorted(dict.fromkeys(faults), key=by_place)


class _Source:
    """Inputs of a run: its data, and a simulator of its config without changes.

    own_parameters: parameters that are no keys of the config and act on this run alone: key, bounds and start.
    """

    def __init__(self, request: RunRequest, common: Sequence[Override], templates: Templates) -> None:
        faults: list[Fault] = []
        table = read_table(readable_path(request.data), faults)
        self.test: ForceTest | None = None
        if table is not None:
            with gathered(faults):
                table = force_tests.select_rows(table, request.rows)
            is_test = force_tests.is_force_test(table, request.columns)
            self.test = request.force_test or (ForceTest() if is_test else None)
        with gathered(faults):
            loaded = _template(request, templates).make(effective([*common, *request.overrides]))
            try:
                self._scene = build(loaded.scenario)
            except SceneError as error:
                raise ConfigError(loaded.sources.place(error.faults)) from error
            self._sources = loaded.sources
            self.template = filled(loaded.scenario, HERE)
            self.simulator = Simulator(self.template)
        if faults or table is None:  # without a table there is a fault
            raise ConfigError(faults)
        if self.test is None:
            self._read_run(request, table)
        else:
            self._read_test(request, self.test, table)

    def _read_run(self, request: RunRequest, table: Table) -> None:
        """Read the data of a run, and check them against a first run of the config."""
        try:
            first = self.simulator.results(())
        except ModelFailed as error:
            fault = f"this run fails, so nothing can be fitted to it: {error}"
            raise ConfigError([request.at_config.fault((), fault)]) from error
        names = [column.name for column in first.columns]
        fittable = observables(names)
        others = [name for name in names if name not in (*fittable, TIME)]
        self.measured = select(table, fittable, request.columns, others)
        clock = request.offset
        _, latest, start = clock if isinstance(clock, tuple) else (clock, clock, clock)
        self.own_parameters = [(OFFSET, *clock)] if isinstance(clock, tuple) else []
        self.early = checks.time_before_start(self.measured, latest)
        refuse(checks.faults_against_run(self.measured, first, start, latest))

    def _read_test(self, request: RunRequest, test: ForceTest, table: Table) -> None:
        """Read the data of a force test, and check them against the law at the start values."""
        faults: list[Fault] = []
        if request.offset != 0.0:
            fault = "a force test has no clock; allowed are force_test: {depth_offset_m: ..., force_offset_N: ...}"
            faults.append(request.at_data.fault(("time_offset_s",), fault))
        with gathered(faults):
            measured = self.measured = force_tests.select(table, test, request.columns)
            self.motion = prescribed_motion(measured.prescribed, test)
            unsuitable = "this config can't be used for a force test: "
            try:
                body = SteadyBody(self._scene, test.body)
                law = LawAlone(self.template, (), measured.columns, test, self.motion)
                self.model = law.response(()).at(measured.time)
            except SceneError as error:
                located = self._sources.place(error.faults)
                refuse(replace(fault, message=unsuitable + fault.message) for fault in located)
            except ModelFailed as error:
                refuse([request.at_config.fault((), f"{unsuitable}{error}")])
            self.own_parameters = fitted_zeros(test, measured)
            depths = [low for key, low, _, _ in self.own_parameters if key == DEPTH_OFFSET]
            least = depths[0] if depths else fixed_zero(test.depth_offset_m)
            size = 2.0 * self._scene.radius(body.body)
            refuse(force_tests.faults_of_test(measured, self.model, size, least))
        refuse(faults)


def _duplicates(runs: Sequence[RunRequest], sources: Sequence[_Source]) -> Iterator[Fault]:
    """A fault for each run with exactly the numbers of another."""
    files: dict[tuple[object, ...], str] = {}
    for run, source in zip(runs, sources, strict=True):
        measured = source.measured
        prescribed = tuple(values.tobytes() for values in measured.prescribed.values())
        numbers = (measured.columns, measured.time.tobytes(), measured.values.tobytes(), prescribed)
        if numbers in files:
            fault = f"{measured.file} has the same numbers as {files[numbers]}; a measurement may be used only once"
            yield run.at_data.fault((), fault)
        files.setdefault(numbers, measured.file)


def _template(request: RunRequest, templates: Templates) -> Template:
    """The config of a run; it is read once, and its faults are reported for the first run that uses it."""
    path = readable_path(request.config)
    if path not in templates:
        faults: list[Fault] = []
        try:
            if not path.exists():
                refuse([request.at_config.fault((), f"got {str(path)!r}, but there is no such file")])
            templates[path] = Template(read_file(path, faults), path, faults)
            refuse(faults)
        except ConfigError as error:
            templates[path] = error
    template = templates[path]
    if isinstance(template, ConfigError):
        raise template
    return template


def _problem(
    request: Specification, sources: Sequence[_Source], choices: Sequence[Choice], faults: list[Fault]
) -> Problem:
    parameters: list[Parameter] = [choice.parameter for choice in choices]
    runs = []
    for i, (run, source) in enumerate(zip(request.runs, sources, strict=True)):
        acting = tuple(j for j, p in enumerate(parameters) if i in p.runs and p.key not in NO_KEYS)
        first = len(parameters)
        for key, low, high, start in source.own_parameters:
            parameters.append(Parameter(key, (i,), low, high, start, log=False, label=f"{key[0]} @ {run.name}"))
        runs.append(_measured_run(run, source, acting, parameters, first))
    if request.file.scatter:
        faults += scatter_faults(request.runs, runs)
    noise = dict.fromkeys(name for run in runs for name in run.measured.columns)
    return Problem(
        request.name,
        tuple(runs),
        tuple(parameters),
        dict(noise) | dict(_noise(request, list(noise), faults)),
        request.file.loss,
        request.file.starts,
        request.file.seed,
        request.file.scatter,
    )


def _measured_run(
    request: RunRequest, source: _Source, acting: tuple[int, ...], parameters: Sequence[Parameter], own: int
) -> MeasuredRun:
    """A measured run with its model; own: index of the first parameter that acts on this run alone."""
    measured = source.measured
    keys = [parameters[j].key for j in acting]
    if source.test is not None:
        zeros = [parameter.key for parameter in parameters[own:]]
        law = LawAlone(source.template, keys, measured.columns, source.test, source.motion, zeros)
        return MeasuredRun(request.name, law, measured, (*acting, *range(own, len(parameters))))
    simulator = Simulator(source.template, keys, measured.columns)
    simulator.early = source.early
    if isinstance(request.offset, tuple):
        return MeasuredRun(request.name, simulator, measured, acting, offset_index=own)
    return MeasuredRun(request.name, simulator, measured, acting, request.offset)


def _noise(request: Specification, columns: Sequence[str], faults: list[Fault]) -> Iterator[tuple[str, float]]:
    """Yield the columns with a given noise, and this noise in their units."""
    names: dict[str, str] = {}
    for name, (value, at) in request.noise.items():
        hit = recognise(name, columns)
        if hit is None:
            faults.append(at.fault(("noise", name), f"no data have such a column; allowed are {with_units(columns)}"))
        elif hit[0] in names:
            faults.append(at.fault(("noise", name), f"is the same column as {names[hit[0]]}; give one of the two"))
        else:
            names[hit[0]] = name
            yield hit[0], value * hit[1]
