"""A config to start from: a shipped one with its model written out in it, the comments of both, and what else may be.

The text is made of the shipped files, so it can't be out of date; the tests run every one of them.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from pathlib import Path

from granular_contact import examples
from granular_contact.config import is_run
from granular_contact.values.strict import did_you_mean

# Further keys of a run, with what they do; each line is a comment that becomes a key without its "# ".
MORE = (
    ("medium", "medium: rft3d_sand", "another medium; `granular-contact media` lists them, null is a vacuum"),
    ("bed", "bed: {slope_deg: 10}", "a slope, in place of surface_height_m; it rises to the right"),
    ("gravity_m_s2", "gravity_m_s2: 1.62", "on the Moon"),
    ("solver", "solver: {end_time_s: 1, accuracy: 1.0e-3}", "steps chosen so that positions are right to a thousandth"),
    ("output", "output: {interval_s: 0.001, figures: false}", "rows of the table in time, no figures"),
)
_MODEL = re.compile(r"^model: (\w+) *$", re.M)


def names() -> dict[str, str]:
    """What there is to start from: names of configs of one run and of models, with the config that shows each."""
    configs = [(name, path) for name in examples.config_names() if (path := examples.config(name)) and is_run(path)]
    found = {name: name for name, _ in configs}
    for name, path in sorted(configs, key=lambda one: len(one[0])):  # the plainest name first
        for model in _MODEL.findall(path.read_text(encoding="utf-8")):
            found.setdefault(model, name)
    return found


def no_such(name: str) -> str:
    """That there is nothing of this name to start from, and what there is."""
    known = sorted(names())
    part = [one for one in known if name and name in one]
    hint = f"did you mean {' or '.join(part)}?" if part else did_you_mean(name, known)
    return f"there is no model or config {name!r}; " + (hint or f"there are {', '.join(known)}")


def about(name: str) -> str:
    """The first sentence of the comment that a shipped config begins with."""
    return re.split(r"(?<=\.) ", " ".join(_comment(_read(name))))[0]


def text(name: str, file: str) -> str:
    """A config of its own, for a file of a name; KeyError where nothing shipped has the `name`."""
    shown = names()[name.removesuffix(".yaml")]
    config = _read(shown)
    body = "\n".join(line for line in _without_comment(config) if not line.startswith("# yaml-language-server"))
    body = _MODEL.sub(lambda found: _in_place(found[1]), body)
    lines = [
        f"# {about(shown)}",
        "#",
        f"#   granular-contact check {file}            what is wrong, with its line",
        f"#   granular-contact run {file} --animate    results and a film in results/{Path(file).stem}/",
        "",
        body.strip(),
        "",
        "# What else a run may say; take the # away. All keys: the reference of the documentation, or",
        "# `granular-contact schema`, which editors read.",
        *_more(body),
    ]
    return "\n".join(lines) + "\n"


def _read(name: str) -> str:
    path = examples.config(name)
    assert path is not None  # it was listed
    return path.read_text(encoding="utf-8")


def _comment(config: str) -> list[str]:
    """Lines of the comment at the top, without their signs; the line for editors is none of them."""
    lines = [line for line in config.splitlines() if not line.startswith("# yaml-language-server")]
    return [line.lstrip("#").strip() for line in itertools.takewhile(lambda line: line.startswith("#"), lines)]


def _without_comment(config: str) -> Iterator[str]:
    return itertools.dropwhile(lambda line: line.startswith("#"), config.splitlines())


def _in_place(model: str) -> str:
    """A shipped model under the key `model`, its comments with it; one with files of its own stays named."""
    text = (examples.home() / "models" / f"{model}.yaml").read_text(encoding="utf-8")
    if re.search(r"\b(urdf|file): ", text):  # paths start from the folder of the model
        return f"model: {model} # a shipped one; `granular-contact examples DIR` writes its files"
    kept = (line for line in text.splitlines() if not line.startswith("# yaml-language-server"))
    return "\n".join(["model:", *(f"  {line}".rstrip() for line in kept)])


def _more(body: str) -> Iterator[str]:
    """The further keys, those that the config has already left out."""
    for key, line, words in MORE:
        if not re.search(rf"^{key}:", body, re.M):
            yield f"# {line}  # {words}"
