"""Meaning of a plain YAML scalar: the core schema of YAML 1.2, without texts that readers take for different numbers.

YAML 1.1 turns `1:30` into 90, `010` into 8, `on` into true, and leaves `1e-3` a text. Here a scalar is a number only if
every reader would take it for the same number. Anything else stays text, and is refused where a number is needed.
"""

from __future__ import annotations

import re

ScalarValue = bool | int | float | str | None

_CONSTANTS: dict[str, bool | None] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}
_INTEGER = re.compile(r"[-+]?(0|[1-9][0-9]*)")
_FLOAT = re.compile(r"[-+]?((0|[1-9][0-9]*)(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
# int() refuses texts of more than 4300 digits. No value here needs so many: a long integer is read as a float.
_LONGEST_INTEGER = 300


def resolve(text: str) -> ScalarValue:
    """Value of a plain (unquoted) scalar.

    Parameters
    ----------
    text : str
        The scalar.

    Examples
    --------
    >>> [resolve(text) for text in ("1e-3", "12", "010", "1:30", "yes", "true")] [0.001, 12, '010', '1:30', 'yes', True]
    """
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    if _INTEGER.fullmatch(text) and len(text) <= _LONGEST_INTEGER:
        return int(text)
    if _FLOAT.fullmatch(text):
        return float(text)
    if _NOT_FINITE.fullmatch(text):
        return float(text.replace(".", ""))
    return text
