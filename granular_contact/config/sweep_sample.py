"""The key `sample` of a sweep file -> cases drawn from ranges; what each method draws stands at `schema.sweep.Sample`.

sample:
  method: sobol                       # latin_hypercube, sobol, one_at_a_time or saltelli
  count: 256
  seed: 1                             # 0 unless given; one_at_a_time draws nothing
  ranges:
    medium.eta_d: [4, 9]              # evenly from 4 to 9
    medium.eta_h: {from: 1, to: 16, scale: log}
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from granular_contact.config import tree
from granular_contact.config.overrides import Override
from granular_contact.config.schema.sweep import Sample
from granular_contact.config.sweep_cases import Case, Numbered, read_overrides
from granular_contact.errors import Fault


def with_long(root: tree.Mapping, path: tuple[str, ...]) -> tree.Mapping:
    """The tree of a file in which each `[from, to]` under the mapping at `path` has the long form."""
    held = root.nodes.get(path[0])
    if not isinstance(held, tree.Mapping):
        return root
    if len(path) > 1:
        return tree.set_key(root, path[0], with_long(held, path[1:]), root.keys[path[0]])
    ranges = held
    for key, node in held.nodes.items():
        if isinstance(node, tree.Items) and len(node.nodes) == 2:
            ends = dict(zip(("from", "to"), node.nodes, strict=True))
            long = tree.Mapping(node.position, ends, dict.fromkeys(ends, node.position))
            ranges = tree.set_key(ranges, key, long, ranges.keys[key])
    return tree.set_key(root, path[0], ranges, root.keys[path[0]])


def sampled(node: tree.Node, sample: Sample, faults: list[Fault]) -> Sequence[Case]:
    """Cases of a sample, whose tree is `node`."""
    keys = read_overrides(tree.find(node, ["ranges"])[0], ("sample", "ranges"), faults)
    if len(keys) < len(sample.ranges):
        return []
    values = draw(sample)

    def row(index: int) -> tuple[Override, ...]:
        numbers = zip(keys, values[index].tolist(), strict=True)
        return tuple(_override(key, value) for key, value in numbers if value == value)

    return Numbered(len(values), row, sample)


def _override(key: Override, value: float) -> Override:
    """A number of a key; a whole one as such, since some keys allow nothing else."""
    at = key.value.position
    tidy = int(value) if value.is_integer() and abs(value) < 2**53 else value
    return Override(key.path, tree.Scalar(at, tidy, repr(value)), at)


def draw(sample: Sample) -> Any:
    """Values (cases, keys) of a sample; NaN where a case leaves a key as the config has it."""
    import numpy as np

    ranges = list(sample.ranges.values())
    if sample.method == "one_at_a_time":
        values = np.full((sample.size, len(ranges)), np.nan)
        for i, held in enumerate(ranges):
            start = 1 + i * sample.count
            values[start : start + sample.count, i] = held.numbers(sample.count)
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
