"""Specification -> Problem: configs and data read, a first run of each, and every fault of all of them at once."""

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
from granular_contact.studies.fit.law_alone import DEPTH_OFFSET, FORCE_OFFSET, LawAlone, known_zero, motion_of, zeros_of
from granular_contact.studies.fit.measurements import TIME, gathered, in_words, observables, recognise, refuse, select
from granular_contact.studies.fit.parameters import Choice, choose, own_choices
from granular_contact.studies.fit.problem import OFFSET, MeasuredRun, Parameter, Problem
from granular_contact.studies.fit.responses import HERE, ModelFailed, Simulator
from granular_contact.studies.fit.scatter import faults as scatter_faults
from granular_contact.studies.fit.specification import RunRequest, Specification

NO_KEYS = (OFFSET, DEPTH_OFFSET, FORCE_OFFSET)  # parameters that are in no config

Templates = dict[Path, Template | ConfigError]  # that were read, or why they could not be


def prepare(request: Specification) -> Problem:
    """Read and check all inputs of a fit.

    Raises
    ------
    ConfigError
        With every fault of the configs, the data and the parameters, sorted by file and line.
    """
    faults: list[Fault] = []
    templates: Templates = {}
    sources = []
    for one in request.runs:
        with gathered(faults):
            sources.append(_Source(one, request.common, templates))
    refuse(_in_order(faults))
    faults += _twice(request.runs, sources)
    tests = [source for source in sources if source.test is not None]
    faults += force_tests.between_tests([one.measured for one in tests], [one.model for one in tests])
    choices = choose(request.parameters, [s.simulator for s in sources], faults)
    for i, (one, source) in enumerate(zip(request.runs, sources, strict=True)):
        choices += own_choices(one, i, source.simulator, faults)
    refuse(_in_order(faults))
    problem = _problem(request, sources, choices, faults)
    refuse(_in_order(faults))
    try:
        faults += checks.unused(problem, choices)
    except ModelFailed as error:
        faults.append(Fault(request.name, None, "", f"the model fails at the start values: {error}"))
    refuse(_in_order(faults))
    return problem


def _in_order(faults: Sequence[Fault]) -> list[Fault]:
    return sorted(dict.fromkeys(faults), key=by_place)


class _Source:
    """A run as its files have it: simulator of the config as it stands, columns that the run has, data.

    own: what is looked for in this run alone, by key, bounds and start.
    """

    def __init__(self, request: RunRequest, common: Sequence[Override], templates: Templates) -> None:
        faults: list[Fault] = []
        table = read_table(readable_path(request.data), faults)
        self.test: ForceTest | None = None
        if table is not None:
            with gathered(faults):
                table = force_tests.rows_of(table, request.rows)
            self.test = request.force_test or (ForceTest() if force_tests.meant(table, request.columns) else None)
        with gathered(faults):
            loaded = _template(request, templates).make(effective([*common, *request.overrides]))
            try:
                self._scene = build(loaded.scenario)
            except SceneError as error:
                raise ConfigError(loaded.sources.place(error.faults)) from error
            self._sources = loaded.sources
            self.template = filled(loaded.scenario, HERE)
            self.simulator = Simulator(self.template)
        if faults or table is None:  # else there was a fault
            raise ConfigError(faults)
        if self.test is None:
            self._read_run(request, table)
        else:
            self._read_test(request, self.test, table)

    def _read_run(self, request: RunRequest, table: Table) -> None:
        """Data of a run of the scene, compared with a first one."""
        try:
            first = self.simulator.results(())
        except ModelFailed as error:
            words = f"this run fails, so nothing can be fitted to it: {error}"
            raise ConfigError([request.at_config.fault((), words)]) from error
        names = [column.name for column in first.columns]
        known = observables(names)
        others = [name for name in names if name not in (*known, TIME)]
        self.measured = select(table, known, request.columns, others)
        clock = request.offset
        _, latest, start = clock if isinstance(clock, tuple) else (clock, clock, clock)
        self.own = [(OFFSET, *clock)] if isinstance(clock, tuple) else []
        self.early = checks.early_by(self.measured, latest)
        refuse(checks.against_run(self.measured, first, start, latest))

    def _read_test(self, request: RunRequest, test: ForceTest, table: Table) -> None:
        """Data of a force test, compared with the law at the start values."""
        faults: list[Fault] = []
        if request.offset != 0.0:
            words = "a force test has no clock; allowed are force_test: {depth_offset_m: ..., force_offset_N: ...}"
            faults.append(request.at_data.fault(("time_offset_s",), words))
        with gathered(faults):
            held = self.measured = force_tests.select(table, test, request.columns)
            self.motion = motion_of(held.given, test)
            try:
                body = SteadyBody(self._scene, test.body)
                self.model = LawAlone(self.template, (), held.columns, test, self.motion).response(()).at(held.time)
            except SceneError as error:
                words = "no force test can be made of it: "
                refuse(replace(one, message=words + one.message) for one in self._sources.place(error.faults))
            except ModelFailed as error:
                refuse([request.at_config.fault((), f"no force test can be made of it: {error}")])
            self.own = zeros_of(test, held)
            depths = [low for key, low, _, _ in self.own if key == DEPTH_OFFSET]
            least = depths[0] if depths else known_zero(test.depth_offset_m)
            size = 2.0 * self._scene.radius(body.body)
            refuse(force_tests.of_test(held, self.model, size, least))
        refuse(faults)


def _twice(runs: Sequence[RunRequest], sources: Sequence[_Source]) -> Iterator[Fault]:
    """A fault for each run with the very numbers of another."""
    seen: dict[tuple[object, ...], str] = {}
    for run, source in zip(runs, sources, strict=True):
        held = source.measured
        given = tuple(one.tobytes() for one in held.given.values())
        numbers = (held.columns, held.time.tobytes(), held.values.tobytes(), given)
        if numbers in seen:
            words = f"{held.file} has the numbers of {seen[numbers]} again; a measurement counts once"
            yield run.at_data.fault((), words)
        seen.setdefault(numbers, held.file)


def _template(request: RunRequest, templates: Templates) -> Template:
    """The config of a run, read once however many runs have it; its faults are those of the first of them."""
    path = readable_path(request.config)
    if path not in templates:
        own: list[Fault] = []
        try:
            if not path.exists():
                refuse([request.at_config.fault((), f"got {str(path)!r}, but there is no such file")])
            templates[path] = Template(read_file(path, own), path, own)
            refuse(own)
        except ConfigError as error:
            templates[path] = error
    known = templates[path]
    if isinstance(known, ConfigError):
        raise known
    return known


def _problem(
    request: Specification, sources: Sequence[_Source], choices: Sequence[Choice], faults: list[Fault]
) -> Problem:
    parameters: list[Parameter] = [choice.parameter for choice in choices]
    runs = []
    for i, (one, source) in enumerate(zip(request.runs, sources, strict=True)):
        acting = tuple(j for j, p in enumerate(parameters) if i in p.runs and p.key not in NO_KEYS)
        first = len(parameters)
        for key, low, high, start in source.own:
            parameters.append(Parameter(key, (i,), low, high, start, log=False, label=f"{key[0]} @ {one.name}"))
        runs.append(_run(one, source, acting, parameters, first))
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


def _run(
    one: RunRequest, source: _Source, acting: tuple[int, ...], parameters: Sequence[Parameter], own: int
) -> MeasuredRun:
    """A run of the scene, or a force test; own: index of the first parameter that is in no config."""
    held = source.measured
    keys = [parameters[j].key for j in acting]
    if source.test is not None:
        zeros = [parameter.key for parameter in parameters[own:]]
        simulator = LawAlone(source.template, keys, held.columns, source.test, source.motion, zeros)
        return MeasuredRun(one.name, simulator, held, (*acting, *range(own, len(parameters))))
    run = Simulator(source.template, keys, held.columns)
    run.early = source.early
    if isinstance(one.offset, tuple):
        return MeasuredRun(one.name, run, held, acting, offset_index=own)
    return MeasuredRun(one.name, run, held, acting, one.offset)


def _noise(request: Specification, columns: Sequence[str], faults: list[Fault]) -> Iterator[tuple[str, float]]:
    said: dict[str, str] = {}
    for name, (value, at) in request.noise.items():
        hit = recognise(name, columns)
        if hit is None:
            faults.append(at.fault(("noise", name), f"no data have such a column; allowed are {in_words(columns)}"))
        elif hit[0] in said:
            faults.append(
                at.fault(("noise", name), f"is the column that {said[hit[0]]} names already; once is allowed")
            )
        else:
            said[hit[0]] = name
            yield hit[0], value * hit[1]
