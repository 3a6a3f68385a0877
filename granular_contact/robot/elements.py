"""Numbers and texts of XML elements; what is wrong with them is a fault with line and key."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from granular_contact.errors import Fault, short
from granular_contact.robot.source import Element
from granular_contact.robot.types import Pose, Vector


@dataclass(frozen=True)
class Incomplete:
    """What is known of a link's mass properties, in its frame: as of `types.Inertial`, None what is not."""

    mass: float | None
    center: Vector | None
    tensor: Vector | None
    line: int = 0


class Reader:
    """Reads elements of one file, and collects faults.

    notices: what was passed over; incomplete: faulty mass properties by link.
    """

    def __init__(self, file: str) -> None:
        self.file = file
        self.notices: list[Fault] = []
        self.incomplete: dict[str, Incomplete] = {}
        self.faults: list[Fault] = []
        self.of_shapes: dict[str, list[tuple[str, Fault]]] = {"collision": [], "visual": []}

    def use(self, which: str, sand: Collection[str] | None = None) -> None:
        """Count the faults of shapes of one kind, "collision" or "visual", as the others are not used.

        sand: links on whose shapes a medium acts, None: on all; a faulty shape of others is left out, with a notice.
        """
        for link, fault in self.of_shapes[which]:
            if sand is None or link in sand:
                self.faults.append(fault)
            else:
                self.notices.append(without_shape(fault))
        self.of_shapes[which] = []

    def fault(self, at: Element | int | None, key: str, message: str) -> None:
        """Note a fault of an element or line, under a dotted key."""
        line = at if isinstance(at, int) or at is None else at.sourceline
        self.faults.append(Fault(self.file, line, key, message))

    def text(self, element: Element, attribute: str, key: str) -> str:
        """A text that must be there; empty, with a fault, if it is not."""
        found = (element.get(attribute) or "").strip()
        if not found:
            self.fault(element, _dotted(key, attribute), f'is missing; allowed is a text, as {attribute}="..."')
        return found

    def number(self, element: Element, attribute: str, key: str, least: float = -math.inf) -> float | None:
        """A finite number of at least `least` (above 0 for None); None if it is not there, or with a fault."""
        text = element.get(attribute)
        if text is None:
            return None
        value = _number(text)
        if value is None or value < least:
            allowed = "a finite number" + (f" of at least {least:g}" if math.isfinite(least) else "")
            self.fault(element, _dotted(key, attribute), f"got {short(text)!r}; allowed is {allowed}")
            return None
        return value

    def needed(self, element: Element, attribute: str, key: str, least: float = -math.inf) -> float | None:
        """A number that must be there."""
        if element.get(attribute) is None:
            self.fault(element, _dotted(key, attribute), "is missing; allowed is a finite number")
            return None
        return self.number(element, attribute, key, least)

    def positive(self, element: Element, names: Sequence[str], key: str) -> tuple[float, ...] | None:
        """Numbers above 0 that must be there; None, with faults, if one is not."""
        found = []
        for name in names:
            value = self.needed(element, name, key)
            if value is not None and value <= 0.0:
                self.fault(element, _dotted(key, name), f"got {value:g}; allowed is a number above 0 (m)")
                value = None
            found.append(value)
        return None if None in found else tuple(v for v in found if v is not None)

    def three(self, element: Element, attribute: str, key: str) -> Vector | None:
        """Three finite numbers; None if they are not there, or with a fault."""
        text = element.get(attribute)
        if text is None:
            return None
        values = [_number(word) for word in text.split()]
        if len(values) != 3 or None in values:
            self.fault(element, _dotted(key, attribute), f"got {short(text)!r}; allowed are three finite numbers")
            return None
        return np.array(values, float)

    def pose(self, parent: Element, key: str) -> Pose:
        """The `<origin>` of an element; none is the identity."""
        element = self.only(parent, "origin", key)
        if element is None:
            return Pose()
        xyz, rpy = (self.three(element, name, _dotted(key, "origin")) for name in ("xyz", "rpy"))
        zero = np.zeros(3)
        return Pose(zero if xyz is None else xyz, zero if rpy is None else rpy)

    def only(self, parent: Element, tag: str, key: str) -> Element | None:
        """The child element of a tag, of which one is allowed; None if there is none."""
        found = parent.findall(tag)
        if len(found) > 1:
            self.fault(found[1], _dotted(key, tag), f"got {len(found)} elements <{tag}>; allowed is one")
        return found[0] if found else None


def without_shape(fault: Fault) -> Fault:
    """What is said of a faulty shape of a link that is not in the sand, which is left out."""
    return replace(fault, message=f"{fault.message}; not in the sand, it is not drawn")


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) and "_" not in text else None


def _dotted(key: str, name: str) -> str:
    return f"{key}.{name}" if key else name
