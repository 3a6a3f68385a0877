"""Numbers and texts of XML elements, and faults of them with line and key."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from granular_contact.errors import Fault, short
from granular_contact.robot.source import Element
from granular_contact.robot.types import Pose, Vector


@dataclass(frozen=True)
class PartialInertial:
    """Known mass properties of a link, in its frame, as in `types.Inertial`; None for each unknown one."""

    mass: float | None
    center: Vector | None
    tensor: Vector | None
    line: int = 0


class Reader:
    """Reader of the elements of one file, which collects their faults.

    notices: on parts of the file that are ignored. partial_inertials: of links whose mass properties have faults.
    shape_faults: faults of shapes, each with its link, by the kind "collision" or "visual".
    """

    def __init__(self, file: str) -> None:
        self.file = file
        self.notices: list[Fault] = []
        self.partial_inertials: dict[str, PartialInertial] = {}
        self.faults: list[Fault] = []
        self.shape_faults: dict[str, list[tuple[str, Fault]]] = {"collision": [], "visual": []}

    def use_shapes(self, kind: str, sand: Collection[str] | None = None) -> None:
        """Count the faults of shapes of one kind, "collision" or "visual"; shapes of the other kind are not used.

        sand: links on whose shapes a medium acts, None: all links. Faulty shapes of other links are left out, with a
        notice.
        """
        for link, fault in self.shape_faults[kind]:
            if sand is None or link in sand:
                self.faults.append(fault)
            else:
                self.notices.append(not_drawn(fault))
        self.shape_faults[kind] = []

    def fault(self, where: Element | int | None, key: str, message: str) -> None:
        """Add a fault of an element or a line, under a dotted key."""
        line = where if isinstance(where, int) or where is None else where.sourceline
        self.faults.append(Fault(self.file, line, key, message))

    def text(self, element: Element, attribute: str, key: str) -> str:
        """Text of a required attribute; empty, with a fault, if it is missing."""
        text = (element.get(attribute) or "").strip()
        if not text:
            self.fault(element, _dotted(key, attribute), f'is missing; allowed is a text, as {attribute}="..."')
        return text

    def number(self, element: Element, attribute: str, key: str, least: float = -math.inf) -> float | None:
        """Finite number of an attribute, at least `least`; None if it is missing, or with a fault."""
        text = element.get(attribute)
        if text is None:
            return None
        value = _number(text)
        if value is None or value < least:
            allowed = "a finite number" + (f" of at least {least:g}" if math.isfinite(least) else "")
            self.fault(element, _dotted(key, attribute), f"got {short(text)!r}; allowed is {allowed}")
            return None
        return value

    def required(self, element: Element, attribute: str, key: str, least: float = -math.inf) -> float | None:
        """Finite number of a required attribute; None, with a fault, if it is missing or faulty."""
        if element.get(attribute) is None:
            self.fault(element, _dotted(key, attribute), "is missing; allowed is a finite number")
            return None
        return self.number(element, attribute, key, least)

    def positive(self, element: Element, names: Sequence[str], key: str) -> tuple[float, ...] | None:
        """Lengths (m) above 0 of required attributes; None, with faults, if one is missing or faulty."""
        values = []
        for name in names:
            value = self.required(element, name, key)
            if value is not None and value <= 0.0:
                self.fault(element, _dotted(key, name), f"got {value:g}; allowed is a number above 0 (m)")
                value = None
            values.append(value)
        return None if None in values else tuple(value for value in values if value is not None)

    def vector(self, element: Element, attribute: str, key: str) -> Vector | None:
        """Three finite numbers of an attribute; None if it is missing, or with a fault."""
        text = element.get(attribute)
        if text is None:
            return None
        values = [_number(word) for word in text.split()]
        if len(values) != 3 or None in values:
            self.fault(element, _dotted(key, attribute), f"got {short(text)!r}; allowed are three finite numbers")
            return None
        return np.array(values, float)

    def pose(self, parent: Element, key: str) -> Pose:
        """Pose in the `<origin>` of an element; the identity without one."""
        element = self.single(parent, "origin", key)
        if element is None:
            return Pose()
        xyz, rpy = (self.vector(element, name, _dotted(key, "origin")) for name in ("xyz", "rpy"))
        zero = np.zeros(3)
        return Pose(zero if xyz is None else xyz, zero if rpy is None else rpy)

    def single(self, parent: Element, tag: str, key: str) -> Element | None:
        """Child element with a tag, of which at most one is allowed; None if there is none."""
        children = parent.findall(tag)
        if len(children) > 1:
            self.fault(children[1], _dotted(key, tag), f"got {len(children)} elements <{tag}>; allowed is one")
        return children[0] if children else None


def not_drawn(fault: Fault) -> Fault:
    """Notice on a faulty shape of a link that is not in the sand; the shape is left out."""
    return replace(fault, message=f"{fault.message}; not in the sand, it is not drawn")


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) and "_" not in text else None


def _dotted(key: str, name: str) -> str:
    return f"{key}.{name}" if key else name
