"""Write numbers into the YAML files that contain their keys. The rest of each file does not change."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import yaml

from granular_contact.errors import ConfigError, Fault
from granular_contact.values.files import write_whole

if TYPE_CHECKING:
    from granular_contact.config.template import SourceMap


def write_numbers(sources: SourceMap, numbers: Mapping[str, float]) -> list[str]:
    """Write numbers of a model into the files from which a scenario was read.

    Parameters
    ----------
    sources : SourceMap
        Files and lines of the keys of the scenario.
    numbers : mapping of str to float
        Numbers by dotted key, as `model.joints.knee.home_deg`. A missing key is added to its mapping.

    Returns
    -------
    list of str
        The files that were changed.

    Raises
    ------
    ConfigError
        A number belongs to no mapping of a YAML file, as for a joint of a chain or of a robot file. Then no file is
        written.
    OSError
        A file cannot be written.
    """
    faults, texts = [], dict[str, str]()
    by_file = defaultdict[str, dict[str, float]](dict)
    for key, number in numbers.items():
        by_file[sources.locate(key)[0]][key] = number
    for file, new in by_file.items():
        text = Path(file).read_text(encoding="utf-8") if Path(file).suffix in (".yaml", ".yml") else ""
        for key, number in new.items():
            changed = _changed(text, key.split("."), f"{number:.10g}")
            if changed is None:
                message = f"stands in no YAML mapping of its own, so that {number:.10g} is not written"
                faults.append(Fault(file, None, key, f"{message}; give the start in initial.joints"))
            text = changed or text
        texts[file] = text
    if faults:
        raise ConfigError(faults)
    for file, text in texts.items():
        write_whole(Path(file), text)
    return list(texts)


def _changed(text: str, path: list[str], value: str) -> str | None:
    """The text of a file with a value under a path; None if it has no mapping for it.

    In the file of a model the path begins below the key `model`.
    """
    root = yaml.compose(text, Loader=yaml.SafeLoader) if text else None
    holder = _below(root, path[:-1]) or _below(root, path[1:-1])
    if not isinstance(holder, yaml.MappingNode) or not holder.value:
        return None
    old = next((value for key, value in holder.value if key.value == path[-1]), None)
    if old is not None:
        start, end, new = old.start_mark.index, old.end_mark.index, value
    elif holder.flow_style:
        start = end = holder.value[-1][1].end_mark.index
        new = f", {path[-1]}: {value}"
    else:
        first = holder.value[0][0].start_mark
        start, end, new = first.index, first.index, f"{path[-1]}: {value}\n{' ' * first.column}"
    return text[:start] + new + text[end:]


def _below(node: yaml.Node | None, path: list[str]) -> yaml.Node | None:
    """The node at a path below another one; None if there is none."""
    for name in path:
        if not isinstance(node, yaml.MappingNode):
            return None
        node = next((value for key, value in node.value if key.value == name), None)
    return node
