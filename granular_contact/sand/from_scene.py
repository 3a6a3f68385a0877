"""Granular load of a scene: its media and surface, and contact lines for the shapes of its rigid bodies."""

from __future__ import annotations

from granular_contact.sand.contact_lines import Body, ContactLine, ball, outline, polyline
from granular_contact.sand.load import GranularLoad
from granular_contact.scene.parts import FlexibleLink, Shape
from granular_contact.scene.types import Scene


def load_from_scene(scene: Scene) -> GranularLoad:
    """Load of a scene that has a bed, still without contact lines.

    Parameters
    ----------
    scene : Scene
        The scene.
    """
    bed, options = scene.bed, scene.load
    assert bed is not None
    return GranularLoad(
        bed.layers,
        bed.profile,
        slope=bed.slope,
        gravity=scene.gravity,
        static=scene.static,
        form=options.form,
        end_cap=options.end_cap,
        floor=bed.floor,
    )


def lines_from_shape(body: Body, shape: Shape, strips: int, split: int = 1) -> list[ContactLine]:
    """Contact lines of a shape.

    Parameters
    ----------
    body : Body
        The body.
    shape : Shape
        The shape.
    strips : int
        Number of strips; an outline, which goes out and back, has twice as many.
    split : int
        Number of parts into which each strip is divided.
    """
    if shape.kind == "ball":
        return ball(body, shape.points[0], shape.width, shape.mass)
    if shape.kind == "outline":
        wheel = None if shape.wheel is None else (shape.wheel.axle, shape.wheel.radius)
        return outline(body, shape.points, shape.width, turns=shape.turns, strips=2 * strips, split=split, wheel=wheel)
    diameter, width = (shape.width, None) if shape.kind == "round" else (None, shape.width)
    return polyline(
        body,
        shape.points,
        diameter=diameter,
        width=width,
        turns=shape.turns,
        strips=strips,
        split=split,
        free_end=shape.free,
    )


def section_size(part: Shape | FlexibleLink) -> dict[str, float]:
    """Diameter or width (m) of a part, by the name of the argument of `contact_lines.beam`.

    Parameters
    ----------
    part : Shape or FlexibleLink
        The part.
    """
    return {"diameter" if part.kind == "round" else "width": part.width}
