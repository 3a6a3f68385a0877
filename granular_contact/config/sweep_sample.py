"""The key `sample` of a sweep file -> cases drawn from ranges.

    sample:
      method: sobol                       # latin_hypercube, sobol, one_at_a_time or saltelli
      count: 256
      seed: 1                             # 0 unless given; one_at_a_time draws nothing
      ranges:
        medium.eta_d: [4, 9]              # evenly from 4 to 9
        medium.eta_h: {from: 1, to: 16, scale: log}

latin_hypercube and sobol draw `count` cases. one_at_a_time takes the config as it is, then `count` values of each key
from end to end while the others stay. saltelli is the design that Sobol's sensitivity indices need: `count` cases A, as
many others B, and for each key the cases A with that key from B; `outputs` names the summary numbers to be explained.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from granular_contact.config import tree
from granular_contact.config.messages import got, unknown
from granular_contact.config.overrides import Override
from granular_contact.config.sweep_cases import MOST_CASES, read_overrides
from granular_contact.config.sweep_range import Range, read_range, read_value, whole
from granular_contact.config.sweep_vary import Numbered
from granular_contact.errors import Fault

METHODS = ("latin_hypercube", "sobol", "one_at_a_time", "saltelli")
OUTPUTS = ("stopping_time_s",)
_BALANCED = ("sobol", "saltelli")  # sequences that are even in powers of two only
_KEYS = ("method", "count", "seed", "ranges", "outputs")
_MOST_SEED = 2**32 - 1


@dataclass(frozen=True)
class Sample:
    """How cases are drawn. ranges: by dotted key; outputs: numbers of a summary that saltelli is to explain."""

    method: str
    count: int
    seed: int
    ranges: dict[str, Range]
    outputs: tuple[str, ...]

    @property
    def size(self) -> int:
        """How many cases there are."""
        keys = len(self.ranges)
        return {"one_at_a_time": 1 + keys * self.count, "saltelli": (keys + 2) * self.count}.get(
            self.method, self.count
        )

    def plain(self) -> dict[str, Any]:
        """What a sweep file says of it."""
        said: dict[str, Any] = {"method": self.method, "count": self.count}
        if self.method != "one_at_a_time":
            said["seed"] = self.seed
        said["ranges"] = {key: held.plain() for key, held in self.ranges.items()}
        return said | ({"outputs": list(self.outputs)} if self.outputs else {})


class Sampled(Numbered):
    """The cases of a sample; values (cases, keys), NaN where a case leaves a key as the config has it."""

    def __init__(self, sample: Sample) -> None:
        self.sample, self.values = sample, _draw(sample)
        self._axes = [(tuple(key.split(".")), held.position) for key, held in sample.ranges.items()]

    def __len__(self) -> int:
        return len(self.values)

    def overrides(self, index: int) -> tuple[Override, ...]:
        """As of the base class."""
        row = self.values[index].tolist()
        return tuple(
            Override(path, tree.Scalar(at, _tidy(value), repr(value)), at)
            for (path, at), value in zip(self._axes, row, strict=True)
            if value == value
        )


def _tidy(value: float) -> float:
    """A whole number as such: some keys allow nothing else."""
    return int(value) if value.is_integer() and abs(value) < 2**53 else value


def _draw(sample: Sample) -> Any:
    """Values (cases, keys) of a sample; NaN where a case leaves a key alone."""
    import numpy as np

    ranges = list(sample.ranges.values())
    if sample.method == "one_at_a_time":
        values = np.full((sample.size, len(ranges)), np.nan)
        for i, held in enumerate(ranges):
            start = 1 + i * sample.count
            values[start : start + sample.count, i] = [scalar.value for scalar in held]
        return values
    fractions = _fractions(sample)
    columns = [[held.number(f) for f in column] for held, column in zip(ranges, fractions.T.tolist(), strict=True)]
    return np.array(columns).T


def _fractions(sample: Sample) -> Any:
    """Points of the unit cube, (cases, keys)."""
    import numpy as np
    from scipy.stats import qmc

    keys, rng = len(sample.ranges), np.random.default_rng(sample.seed)
    if sample.method == "latin_hypercube":
        return qmc.LatinHypercube(keys, rng=rng).random(sample.count)
    if sample.method == "sobol":
        return qmc.Sobol(keys, rng=rng).random(sample.count)
    # One sequence of twice as many dimensions gives A and B (Saltelli et al. 2010, section 5).
    both = qmc.Sobol(2 * keys, rng=rng).random(sample.count)
    a, b = both[:, :keys], both[:, keys:]
    mixed = np.tile(a, (keys, 1, 1))
    for i in range(keys):
        mixed[i, :, i] = b[:, i]
    return np.concatenate([a, b, *mixed])


def read_sample(node: tree.Node, faults: list[Fault]) -> Sequence[Any]:
    """Cases of a sample; none, with faults, if it is at fault."""
    if not isinstance(node, tree.Mapping):
        if not isinstance(node, tree.Broken):
            faults.append(node.position.fault(("sample",), f"got {got(node)}; allowed is a mapping with {_words()}"))
        return []
    before = len(faults)
    for key, at in node.keys.items():
        if key in node.nodes and key not in _KEYS:
            faults.append(at.fault(("sample", key), f"unknown key; {unknown(key, _KEYS)}"))
    path = ("sample",)
    method = read_value(node, path, "method", f"one of {', '.join(METHODS)}", lambda v: v in METHODS, faults)
    count = read_value(node, path, "count", f"a whole number from 2 to {MOST_CASES}", whole(2, MOST_CASES), faults)
    if method in _BALANCED and count is not None:
        _power_of_two(node, method, count, faults)
    seed = _seed(node, method, faults)
    ranges = _ranges(node, count, faults)
    outputs = _outputs(node, method, faults)
    if len(faults) > before:
        return []
    sample = Sample(method, count, seed, ranges, outputs)
    if sample.size > MOST_CASES:
        message = f"got {sample.size} cases; at most {MOST_CASES} are allowed"
        faults.append(node.keys["count"].fault((*path, "count"), message))
        return []
    return Sampled(sample)


def _words() -> str:
    return f"the keys {', '.join(_KEYS)}"


def _power_of_two(node: tree.Mapping, method: str, count: int, faults: list[Fault]) -> None:
    below = 1 << (count.bit_length() - 1)
    if count != below:
        message = f"got {count}; {method} is even for powers of two only: take {below} or {2 * below}"
        faults.append(node.nodes["count"].position.fault(("sample", "count"), message))


def _seed(node: tree.Mapping, method: str | None, faults: list[Fault]) -> int:
    if "seed" not in node.nodes:
        return 0
    if method == "one_at_a_time":
        faults.append(node.keys["seed"].fault(("sample", "seed"), "has no effect: one_at_a_time draws nothing"))
    allowed = f"a whole number from 0 to {_MOST_SEED}"
    seed = read_value(node, ("sample",), "seed", allowed, whole(0, _MOST_SEED), faults)
    return seed if isinstance(seed, int) else 0


def _ranges(node: tree.Mapping, count: int | None, faults: list[Fault]) -> dict[str, Range]:
    """Range of each key; those at fault are left out."""
    path = ("sample", "ranges")
    held = node.nodes.get("ranges")
    if held is None or (isinstance(held, tree.Mapping) and not held.nodes):
        at = node.position if held is None else held.position
        said = "is missing" if held is None else "got an empty mapping"
        faults.append(at.fault(path, f"{said}; allowed is one dotted key or more, each with a range"))
        return {}
    found: dict[str, Range] = {}
    for key in read_overrides(held, path, faults):
        name = ".".join(key.path)
        mapping = _as_mapping(key.value)
        if mapping is None:
            if not isinstance(key.value, tree.Broken):
                allowed = "[from, to], or a mapping with from, to and scale"
                faults.append(key.position.fault((*path, name), f"got {got(key.value)}; allowed is {allowed}"))
        elif (read := read_range(mapping, (*path, name), MOST_CASES, faults, count or 2)) is not None:
            found[name] = read
    return found


def _as_mapping(node: tree.Node) -> tree.Mapping | None:
    """A range in its long form; None for what is no range."""
    if isinstance(node, tree.Items) and len(node.nodes) == 2:
        ends = dict(zip(("from", "to"), node.nodes, strict=True))
        return tree.Mapping(node.position, ends, dict.fromkeys(ends, node.position))
    return node if isinstance(node, tree.Mapping) else None


def _outputs(node: tree.Mapping, method: str | None, faults: list[Fault]) -> tuple[str, ...]:
    held = node.nodes.get("outputs")
    if held is None:
        return OUTPUTS if method == "saltelli" else ()
    path = ("sample", "outputs")
    if method not in ("saltelli", None):
        faults.append(node.keys["outputs"].fault(path, f"has no effect with {method}; it needs method: saltelli"))
    names = tree.plain(held) if isinstance(held, tree.Items) else None
    if not names or not all(isinstance(name, str) for name in names) or len(set(names)) < len(names):
        if not isinstance(held, tree.Broken):
            allowed = "a list of different names of numbers in summary.json, as stopping_time_s"
            faults.append(held.position.fault(path, f"got {got(held)}; allowed is {allowed}"))
        return ()
    return tuple(names)
