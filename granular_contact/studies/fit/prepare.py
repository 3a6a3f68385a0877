"""Specification -> Problem: configs and data read, a first run of each, and every fault of all of them at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from granular_contact.config.changed import filled
from granular_contact.config.csv_table import read_table
from granular_contact.config.load import Template, by_place
from granular_contact.config.overrides import Override, effective
from granular_contact.config.references import shown
from granular_contact.config.yaml_source import read_file
from granular_contact.errors import ConfigError, Fault, SceneError
from granular_contact.scene import build
from granular_contact.studies.fit import checks
from granular_contact.studies.fit.columns import TIME, in_words, observables, recognise
from granular_contact.studies.fit.measurements import Measured, select
from granular_contact.studies.fit.parameters import Choice, choose, own_choices
from granular_contact.studies.fit.problem import OFFSET, MeasuredRun, Parameter, Problem
from granular_contact.studies.fit.request import RunRequest, Specification
from granular_contact.studies.fit.responses import HERE, ModelFailed, Simulator


def prepare(request: Specification) -> Problem:
    """Read and check all inputs of a fit.

    Raises
    ------
    ConfigError
        With every fault of the configs, the data and the parameters, sorted by file and line.
    """
    faults: list[Fault] = []
    templates: dict[Path, Template | None] = {}
    sources = [_Source(one, request.common, templates, faults) for one in request.runs]
    if faults:
        raise ConfigError(_in_order(faults))
    faults += _twice(request.runs, sources)
    choices = choose(request.parameters, [s.simulator for s in sources], faults)
    for i, (one, source) in enumerate(zip(request.runs, sources, strict=True)):
        choices += own_choices(one, i, source.simulator, faults)
    if faults:
        raise ConfigError(_in_order(faults))
    problem = _problem(request, sources, choices, faults)
    if not faults:
        try:
            faults += checks.unused(problem, choices)
        except ModelFailed as error:
            faults.append(Fault(request.name, None, "", f"the model fails at the start values: {error}"))
    if faults:
        raise ConfigError(_in_order(faults))
    return problem


def _in_order(faults: Sequence[Fault]) -> list[Fault]:
    return sorted(dict.fromkeys(faults), key=by_place)


class _Source:
    """A run as its files have it: simulator of the config as it stands, columns that the run has, data."""

    def __init__(
        self,
        request: RunRequest,
        common: Sequence[Override],
        templates: dict[Path, Template | None],
        faults: list[Fault],
    ) -> None:
        before = len(faults)
        table = read_table(shown(request.data), faults)
        template = _template(request, templates, faults)
        self.measured: Measured | None = None
        if template is None:
            return
        try:
            loaded = template.make(effective([*common, *request.overrides]))
        except ConfigError as error:
            faults += error.faults
            return
        try:
            build(loaded.scenario)
        except SceneError as error:
            faults += loaded.sources.place(error.faults)
        self.template = filled(loaded.scenario, HERE)
        self.simulator = Simulator(self.template)
        if table is None or len(faults) > before:
            return
        try:
            self.first = self.simulator.results(())
        except ModelFailed as error:
            words = f"this run fails, so nothing can be fitted to it: {error}"
            faults.append(request.at_config.fault((), words))
            return
        names = [column.name for column in self.first.columns]
        known = observables(names)
        others = [name for name in names if name not in (*known, TIME)]
        self.measured = select(table, known, request.columns, faults, others)
        if self.measured is not None:
            start, latest = _offsets(request)
            self.early = checks.early_by(self.measured, latest)
            faults += checks.against_run(self.measured, self.first, start, latest)


def _twice(runs: Sequence[RunRequest], sources: Sequence[_Source]) -> Iterator[Fault]:
    """A fault for each run with the very numbers of another."""
    seen: dict[tuple[object, ...], str] = {}
    for run, source in zip(runs, sources, strict=True):
        held = source.measured
        assert held is not None  # or there was a fault
        numbers = (held.columns, held.time.tobytes(), held.values.tobytes())
        if numbers in seen:
            words = f"{held.file} has the numbers of {seen[numbers]} again; a measurement counts once"
            yield run.at_data.fault((), words)
        seen.setdefault(numbers, held.file)


def _offsets(request: RunRequest) -> tuple[float, float]:
    """Offset of the clock to start from, and the greatest that it may have (s)."""
    if isinstance(request.offset, tuple):
        _, high, start = request.offset
        return start, high
    return request.offset, request.offset


def _template(request: RunRequest, templates: dict[Path, Template | None], faults: list[Fault]) -> Template | None:
    """The config of a run, read once however many runs have it."""
    path = shown(request.config)
    if path not in templates:
        templates[path] = None
        if not path.exists():
            faults.append(request.at_config.fault((), f"got {str(path)!r}, but there is no such file"))
        else:
            own: list[Fault] = []
            try:
                template = Template(read_file(path, own), path, own)
                templates[path] = None if own else template
                faults += own
            except ConfigError as error:
                faults += error.faults
    return templates[path]


def _problem(
    request: Specification, sources: Sequence[_Source], choices: Sequence[Choice], faults: list[Fault]
) -> Problem:
    parameters: list[Parameter] = [choice.parameter for choice in choices]
    runs = []
    for i, (one, source) in enumerate(zip(request.runs, sources, strict=True)):
        assert source.measured is not None  # or there was a fault
        acting = tuple(j for j, p in enumerate(parameters) if i in p.runs and p.key != OFFSET)
        simulator = Simulator(source.template, [parameters[j].key for j in acting], source.measured.columns)
        offset_index, offset = None, 0.0
        if isinstance(one.offset, tuple):
            offset_index = len(parameters)
            parameters.append(Parameter(OFFSET, (i,), *one.offset, log=False, label=f"{OFFSET[0]} @ {one.name}"))
        else:
            offset = one.offset
        simulator.early = source.early
        runs.append(MeasuredRun(one.name, simulator, source.measured, acting, offset, offset_index))
    noise = dict.fromkeys(name for run in runs for name in run.measured.columns)
    return Problem(
        request.name,
        tuple(runs),
        tuple(parameters),
        dict(noise) | dict(_noise(request, list(noise), faults)),
        request.loss,
        request.starts,
        request.seed,
    )


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
