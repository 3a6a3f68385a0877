"""What a medium meets: a thin round bar along a line, a thin plate along a line (both faces can lead), the closed
outline of a body (only its outside leads), or a ball.
"""

from __future__ import annotations

from typing import Literal

Kind = Literal["round", "flat", "outline", "ball"]
WORDS: dict[Kind, str] = {
    "round": "round bars (cylinder, arc or polyline with a diameter)",
    "flat": "plates (plate, arc or polyline with a width)",
    "outline": "outlines (disc, foot, polygon)",
    "ball": "spheres",
}
# In space, by what `space_joining.kinds_of` calls them.
IN_SPACE = {
    "surface": "surfaces (links, and all shapes but bar)",
    "bar": "round bars (bar, and links with a diameter)",
    "ball": "spheres",
}
