"""Kinds of shape that a medium acts on.

A `round` shape is a thin round bar along a line. A `flat` shape is a thin plate along a line, of which either face can
lead. An `outline` is the closed boundary of a body, of which only the outside leads. A `ball` is a sphere as a whole.
"""

from __future__ import annotations

from typing import Literal

Kind = Literal["round", "flat", "outline", "ball"]
SHAPE_NAMES: dict[Kind, str] = {
    "round": "round bars (cylinder, arc or polyline with a diameter)",
    "flat": "plates (plate, arc or polyline with a width)",
    "outline": "outlines (disc, foot, polygon, wheel)",
    "ball": "spheres",
}
# Kinds of element in space, as `space_joining.kinds_of` returns them.
ELEMENT_NAMES = {
    "surface": "surfaces (links, and all shapes but bar)",
    "bar": "round bars (bar, and links with a diameter)",
    "ball": "spheres",
}
