"""Scripts of pages: our own, which are small, and plotly's, which draws curves and what is in space.

A page names the hashes of its scripts in its policy, so that nothing else that looks like one is run. Plotly's script
comes with its Python package; it is packed into the page, so that one file can be passed on; the browser unpacks it.
"""

from __future__ import annotations

import importlib.util
import json
import zlib
from base64 import b64encode
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

from markupsafe import Markup

_SCRIPTS = Path(__file__).parent / "scripts"
LEVEL = 4  # of packing: 0.1 s for plotly's script, and 4 % more than the best
_ESCAPES = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"}


class Script(NamedTuple):
    """A script, and its hash as policies name it."""

    text: Markup
    hash: str


def packed(content: bytes) -> str:
    """Bytes as text that scripts unpack: zlib, base64."""
    return b64encode(zlib.compress(content, LEVEL)).decode()


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


@cache
def own(*names: str) -> Script:
    """Scripts of ours by name, as one."""
    text = "".join((_SCRIPTS / f"{name}.js").read_text(encoding="utf-8") for name in names)
    text = f'"use strict";\n(() => {{\n{text}}})();\n'
    return Script(Markup(text), _hash(text))


@cache
def plotly() -> Script | None:
    """Plotly's script, packed; None where its package is not there."""
    found = importlib.util.find_spec("plotly")  # not imported, which would take longer than all else
    if found is None or found.origin is None:
        return None
    path = Path(found.origin).parent / "package_data" / "plotly.min.js"
    if not path.is_file():
        return None
    text = path.read_text(encoding="utf-8")
    return Script(Markup(packed(text.encode())), _hash(text))


def data_block(content: Any) -> Markup:
    """JSON for a script, that no text in it can end."""
    text = json.dumps(content, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    for sign, escape in _ESCAPES.items():
        text = text.replace(sign, escape)
    return Markup(text)
