"""Starter configs: a shipped config that contains its model, with the comments of both files and a list of other keys.

The text is made from the shipped files, so it is never out of date. The tests run all starter configs.
"""

from __future__ import annotations

import itertools
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

from granular_contact import examples
from granular_contact.config import is_run
from granular_contact.values.strict import did_you_mean

# Other keys of a run: key, line of YAML, and its meaning. The lines are comments; without "# " they are keys.
OTHER_KEYS = (
    ("medium", "medium: rft3d_sand", "another medium; `granular-contact media` lists them, null is a vacuum"),
    ("bed", "bed: {slope_deg: 10}", "a slope, in place of surface_height_m; it rises to the right"),
    ("gravity_m_s2", "gravity_m_s2: 1.62", "on the Moon"),
    ("solver", "solver: {end_time_s: 1, accuracy: 1.0e-3}", "time steps chosen for positions to a thousandth"),
    ("output", "output: {interval_s: 0.001, figures: false}", "time between rows of the time series; no figures"),
)
_MODEL = re.compile(r"^model: (\w+) *$", re.M)


def names() -> dict[str, str]:
    """Names of shipped models and configs of a run, each with the name of the shipped config that `text` uses."""
    configs = [(name, path) for name in examples.config_names() if (path := examples.config(name)) and is_run(path)]
    config_by_name = {name: name for name, _ in configs}
    # Of several configs with the same model that with the shortest name is used, which is mostly the simplest.
    for name, path in sorted(configs, key=lambda config: len(config[0])):
        for model in _MODEL.findall(path.read_text(encoding="utf-8")):
            config_by_name.setdefault(model, name)
    return config_by_name


def no_such(name: str) -> str:
    """Message that no shipped model or config has this name, with similar names or all names."""
    known = sorted(names())
    containing = [known_name for known_name in known if name and name in known_name]
    hint = f"did you mean {' or '.join(containing)}?" if containing else did_you_mean(name, known)
    return f"there is no model or config {name!r}; " + (hint or f"there are {', '.join(known)}")


def about(name: str) -> str:
    """The first sentence of the comment at the top of a shipped config."""
    return re.split(r"(?<=\.) ", " ".join(_comment(_read(name))))[0]


def text(name: str, file: str) -> str:
    """Text of the starter config for a shipped model or config `name`, to be written to `file`.

    Raises
    ------
    KeyError
        No shipped model or config has this name.
    """
    shipped = names()[name.removesuffix(".yaml")]
    config = _read(shipped)
    body = "\n".join(line for line in _without_comment(config) if not line.startswith("# yaml-language-server"))
    body = _MODEL.sub(lambda match: _model_text(match[1]), body)
    written, folder = (shlex.quote(each) for each in (file, f"results/{Path(file).stem}/"))
    lines = [
        f"# {about(shipped)}",
        "#",
        f"#   granular-contact check {written}            what is wrong, with its line",
        f"#   granular-contact run {written} --animate    results and a film in {folder}",
        "",
        body.strip(),
        "",
        "# Other keys of a run: remove the # to use one. All keys are in the reference of the documentation, and in",
        "# `granular-contact schema`, which editors read.",
        *_other_keys(body),
    ]
    return "\n".join(lines) + "\n"


def _read(name: str) -> str:
    """Text of a shipped config."""
    path = examples.config(name)
    assert path is not None  # `name` comes from `names`
    return path.read_text(encoding="utf-8")


def _comment(config: str) -> list[str]:
    """Lines of the comment at the top of a config without "#", and without the line for editors."""
    lines = [line for line in config.splitlines() if not line.startswith("# yaml-language-server")]
    return [line.lstrip("#").strip() for line in itertools.takewhile(lambda line: line.startswith("#"), lines)]


def _without_comment(config: str) -> Iterator[str]:
    """Lines of a config without the comment at the top."""
    return itertools.dropwhile(lambda line: line.startswith("#"), config.splitlines())


def _model_text(model: str) -> str:
    """The key `model` with the text of a shipped model and its comments; a model with further files stays a name."""
    text = (examples.home() / "models" / f"{model}.yaml").read_text(encoding="utf-8")
    if re.search(r"\b(urdf|file): ", text):  # paths start from the folder of the model
        return f"model: {model} # a shipped one; `granular-contact examples DIR` writes its files"
    lines = (line for line in text.splitlines() if not line.startswith("# yaml-language-server"))
    return "\n".join(["model:", *(f"  {line}".rstrip() for line in lines)])


def _other_keys(body: str) -> Iterator[str]:
    """Comment lines with keys that the config does not have."""
    for key, line, meaning in OTHER_KEYS:
        if not re.search(rf"^{key}:", body, re.M):
            yield f"# {line}  # {meaning}"
