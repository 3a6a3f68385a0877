"""A drawing of each shape with its keys, as SVG in the colours of the page; a shape without one fails the tests."""

from __future__ import annotations

import math

X0, Y0, WIDTH, HEIGHT = 180, 90, 400, 180  # origin and size, in pixels


def of(name: str) -> str | None:
    """The drawing of a class of shapes; None for any other class."""
    drawn = DRAWINGS.get(name)
    if drawn is None:
        return None
    label = f"{name.removesuffix('Shape').removeprefix('Spatial').lower()} with its keys"
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{label}" xmlns="http://www.w3.org/2000/svg">'
        f"{''.join(drawn)}</svg>"
    )


# ---- pieces; coordinates in pixels from the origin, y up ----


def _at(x: float, y: float) -> tuple[float, float]:
    return X0 + x, Y0 - y


def path(*points: tuple[float, float], closed: bool = False, kind: str = "solid") -> str:
    """A line through points."""
    words = " L".join(f"{x:.1f} {y:.1f}" for x, y in (_at(*point) for point in points))
    return f'<path class="{kind}" d="M{words}{" Z" if closed else ""}"/>'


def circle(x: float, y: float, radius: float, kind: str = "solid") -> str:
    """A circle."""
    x, y = _at(x, y)
    return f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="{radius}"/>'


def ellipse(x: float, y: float, rx: float, ry: float, kind: str = "solid") -> str:
    """An ellipse, for a circle seen at an angle."""
    x, y = _at(x, y)
    return f'<ellipse class="{kind}" cx="{x:.1f}" cy="{y:.1f}" rx="{rx}" ry="{ry}"/>'


def text(x: float, y: float, words: str, anchor: str = "middle") -> str:
    """Words at a point."""
    x, y = _at(x, y)
    return f'<text x="{x:.1f}" y="{y + 4:.1f}" text-anchor="{anchor}">{words}</text>'


def axes(x: float = 0, y: float = 0, up: str = "y") -> str:
    """The frame of the body, or of the shape."""
    return "".join(
        [
            arrow((x, y), (x + 26, y), "axis"),
            arrow((x, y), (x, y + 26), "axis"),
            text(x + 34, y - 1, "x"),
            text(x, y + 34, up),
        ]
    )


def arrow(start: tuple[float, float], end: tuple[float, float], kind: str = "size", both: bool = False) -> str:
    """A line with a head at its end."""
    heads = _head(start, end, kind) + (_head(end, start, kind) if both else "")
    return path(start, end, kind=kind) + heads


def _head(start: tuple[float, float], end: tuple[float, float], kind: str) -> str:
    angle = math.atan2(end[1] - start[1], end[0] - start[0])
    wings = [(end[0] - 7 * math.cos(angle + s), end[1] - 7 * math.sin(angle + s)) for s in (0.4, -0.4)]
    return path(wings[0], end, wings[1], kind=kind)


def size(start: tuple[float, float], end: tuple[float, float], words: str, away: tuple[float, float] = (0, 12)) -> str:
    """A length with its key; away: where the word stands from its middle."""
    x, y = (start[0] + end[0]) / 2 + away[0], (start[1] + end[1]) / 2 + away[1]
    anchor = "start" if away[0] > 5 else "end" if away[0] < -5 else "middle"
    return arrow(start, end, both=True) + text(x, y, words, anchor)


def arc(radius: float, start: float, end: float, kind: str, x: float = 0, y: float = 0, count: int = 24) -> str:
    """An arc; angles in degrees, counter-clockwise."""
    angles = [math.radians(start + (end - start) * i / count) for i in range(count + 1)]
    return path(*((x + radius * math.cos(a), y + radius * math.sin(a)) for a in angles), kind=kind)


def turned(points: list[tuple[float, float]], degrees: float) -> list[tuple[float, float]]:
    """Points turned about the origin, counter-clockwise."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [(c * x - s * y, s * x + c * y) for x, y in points]


def bar(start: tuple[float, float], end: tuple[float, float], half: float) -> str:
    """A straight bar of a thickness."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    nx, ny = (-dy / math.hypot(dx, dy) * half, dx / math.hypot(dx, dy) * half)
    (a, b), (c, d) = start, end
    return path((a + nx, b + ny), (c + nx, d + ny), (c - nx, d - ny), (a - nx, b - ny), closed=True)


def prism(x: float, y: float, wide: float, high: float, deep: float = 40) -> str:
    """A box, seen from the front right."""
    dx, dy = 0.8 * deep, 0.45 * deep
    front = [(x, y), (x + wide, y), (x + wide, y + high), (x, y + high)]
    top = [front[3], front[2], (front[2][0] + dx, front[2][1] + dy), (front[3][0] + dx, front[3][1] + dy)]
    side = [front[1], (front[1][0] + dx, front[1][1] + dy), top[2], front[2]]
    return "".join(path(*one, closed=True) for one in (front, top, side))


C_LEG = arc(50, 90, -90, "bar", 0, 0)
FOOT = path(*[(-70 + 14 * math.cos(a), 14 * math.sin(a)) for a in [math.pi / 2 + math.pi * i / 12 for i in range(13)]],
            *[(70 + 14 * math.cos(a), 14 * math.sin(a)) for a in [-math.pi / 2 + math.pi * i / 12 for i in range(13)]],
            closed=True)  # fmt: skip
TURN = [math.pi * i / 16 for i in range(17)]
TEETH = [
    (2 * math.pi * (i + part) / 12, 60.0 if part in (0.44, 0.56) else 48.0)
    for i in range(12)
    for part in (0.0, 0.15, 0.3, 0.43, 0.44, 0.56, 0.57, 0.7, 0.85)
]
SECTION = [(-60, -30), (60, -30), (75, 5), (40, 35), (-60, 35)]

WHEEL = [
    path(*((r * math.cos(a), r * math.sin(a)) for a, r in TEETH), closed=True),
    circle(0, 0, 2, "dot"),
    text(-4, -12, "center_m"),
    arrow((0, 0), (36, 31)),
    text(14, 34, "radius_m", "end"),
    text(66, 30, "grousers: count, height_m,", "start"),
    text(66, 14, "thickness_m", "start"),
]
DRAWINGS: dict[str, list[str]] = {
    "DiscShape": [
        circle(0, 0, 55),
        axes(),
        text(0, -12, "center_m"),
        size((-55, -70), (55, -70), "diameter_m", (0, -10)),
        text(70, 60, "thickness_m: into the page", "middle"),
    ],
    "WheelShape": [
        *WHEEL,
        text(0, -76, "width_m: into the page"),
        axes(-130, -50),
    ],
    "SphereShape": [
        circle(0, 0, 55),
        ellipse(0, 0, 55, 16, "thin"),
        text(0, -34, "center_m"),
        circle(0, 0, 2, "dot"),
        size((-55, -70), (55, -70), "diameter_m", (0, -10)),
    ],
    "CylinderShape": [
        bar((-90, -40), (80, 30), 12),
        circle(-90, -40, 3, "dot"),
        circle(80, 30, 3, "dot"),
        text(-90, -66, "start_m"),
        text(86, 54, "end_m"),
        size((-14, 10), (-5, -13), "diameter_m", (14, -22)),
        axes(-120, 30),
    ],
    "PlateShape": [
        bar((-90, -40), (80, 30), 4),
        circle(-90, -40, 3, "dot"),
        circle(80, 30, 3, "dot"),
        text(-90, -60, "start_m"),
        text(84, 50, "end_m"),
        text(16, -34, "thickness_m: across", "start"),
        text(16, -50, "width_m: into the page", "start"),
        axes(-120, 30),
    ],
    "ArcShape": [
        C_LEG,
        circle(0, 0, 3, "dot"),
        text(-10, 0, "center_m", "end"),
        arrow((0, 0), (44, 25)),
        text(-10, -18, "radius_m", "end"),
        text(4, 68, "from_deg: -90", "start"),
        text(4, -68, "to_deg: 90", "start"),
        text(60, 30, "diameter_m, or", "start"),
        text(60, 14, "width_m and", "start"),
        text(60, -2, "thickness_m", "start"),
        axes(-120, -60),
    ],
    "PolylineShape": [
        path((-100, 10), (-50, 40), (10, -10), (60, -30), (100, 20), kind="bar"),
        *(circle(x, y, 3, "dot") for x, y in ((-100, 10), (-50, 40), (10, -10), (60, -30), (100, 20))),
        text(-40, 58, "points_m"),
        text(20, -50, "diameter_m, or", "start"),
        text(20, -66, "width_m and thickness_m", "start"),
        axes(-120, -50),
    ],
    "PolygonShape": [
        path(*SECTION, closed=True),
        *(circle(x, y, 3, "dot") for x, y in SECTION),
        text(0, 52, "points_m"),
        text(0, -50, "width_m: into the page"),
        axes(-10, -10),
    ],
    "FootShape": [
        FOOT,
        circle(0, 0, 2, "dot"),
        text(0, 30, "center_m"),
        size((-84, -32), (84, -32), "length_m", (0, -11)),
        size((98, -14), (98, 14), "height_m", (7, 22)),
        text(0, -68, "width_m: into the page; tilt_deg turns it"),
        axes(-130, 30),
    ],
    "SpatialBox": [
        prism(-70, -45, 100, 60),
        size((-70, -58), (30, -58), "size_m[0]: x", (0, -11)),
        size((42, -50), (74, -32), "size_m[1]: y", (8, -8)),
        size((-82, -45), (-82, 15), "size_m[2]: z", (-6, 0)),
    ],
    "SpatialCylinder": [
        path((-40, 45), (-40, -45), kind="edge"),
        path((40, 45), (40, -45), kind="edge"),
        ellipse(0, -45, 40, 13),
        path((-40, 45), (40, 45), (40, -45), (-40, -45), closed=True, kind="fill"),
        ellipse(0, 45, 40, 13),
        arrow((0, 0), (0, 34), "axis"),
        text(9, 30, "z"),
        text(0, -14, "center_m"),
        circle(0, 0, 2, "dot"),
        size((-40, -70), (40, -70), "diameter_m", (0, -9)),
        size((55, -45), (55, 45), "length_m", (7, 0)),
    ],
    "SpatialCapsule": [
        path(*[(-32 * math.cos(a), 30 + 32 * math.sin(a)) for a in TURN],
             *[(32 * math.cos(a), -30 - 32 * math.sin(a)) for a in TURN], closed=True),
        arrow((0, 0), (0, 24), "axis"),
        text(9, 18, "z"),
        text(0, -12, "center_m"),
        size((-32, -72), (32, -72), "diameter_m", (0, -9)),
        size((48, -30), (48, 30), "length_m", (7, 0)),
    ],
    "SpatialSphere": [
        circle(0, 0, 55),
        ellipse(0, 0, 55, 16, "thin"),
        text(0, -34, "center_m"),
        circle(0, 0, 2, "dot"),
        size((-55, -70), (55, -70), "diameter_m", (0, -10)),
    ],
    "SpatialCone": [
        path((0, -55), (-45, 35), (45, 35), closed=True),
        ellipse(0, 35, 45, 14),
        circle(0, -55, 3, "dot"),
        text(8, -62, "center_m: the tip", "start"),
        arrow((0, -55), (0, 10), "axis"),
        text(9, 4, "z"),
        size((-45, 58), (45, 58), "diameter_m", (0, 11)),
        size((62, -55), (62, 35), "height_m", (7, 0)),
    ],
    "SpatialPlate": [
        path((-90, -30), (20, -30), (75, 25), (-35, 25), closed=True),
        arrow((-8, -3), (-8, 34), "axis"),
        text(-8, 42, "z"),
        text(2, -10, "center_m"),
        size((-90, -43), (20, -43), "size_m[0]: x", (0, -11)),
        size((33, -34), (85, 18), "size_m[1]: y", (8, -6)),
        text(-8, 62, "thickness_m: for its mass alone", "middle"),
    ],
    "SpatialArc": [
        *(arc(50, 90, -90, "edge", x, 0.55 * x) for x in (0, 34)),
        path((0, 50), (34, 68.7), kind="edge"),
        path((0, -50), (34, -31.3), kind="edge"),
        path((50, 0), (84, 18.7), kind="edge"),
        arrow((0, 0), (43, 25)),
        text(-6, 0, "radius_m", "end"),
        text(-4, 64, "from_deg: -90", "end"),
        text(-4, -62, "to_deg: 90", "end"),
        text(70, -10, "width_m: along y", "start"),
        text(70, -26, "thickness_m", "start"),
        axes(-125, -60, "z"),
    ],
    "SpatialPolygon": [
        path(*SECTION, closed=True),
        path(*((x + 30, y + 18) for x, y in SECTION), closed=True, kind="thin"),
        *(circle(x, y, 3, "dot") for x, y in SECTION),
        text(-60, 62, "points_m: x and z", "middle"),
        text(0, -50, "width_m: along y, centred"),
        axes(-120, -60, "z"),
    ],
    "SpatialWheel": [
        *WHEEL,
        text(0, -76, "width_m: along y, centred"),
        axes(-120, -60, "z"),
    ],
    "SpatialBar": [
        path((-100, -20), (-40, 35), (40, 10), (95, 45), kind="bar"),
        *(circle(x, y, 3, "dot") for x, y in ((-100, -20), (-40, 35), (40, 10), (95, 45))),
        text(-40, 56, "points_m: x, y, z"),
        text(20, -30, "diameter_m: thin; for laws of bars"),
    ],
    "SpatialMesh": [
        path((-60, -45), (10, -55), (60, -10), (35, 45), (-30, 55), (-75, 5), closed=True),
        path((-60, -45), (-15, 0), (10, -55), kind="edge"),
        path((60, -10), (-15, 0), (35, 45), kind="edge"),
        path((-30, 55), (-15, 0), (-75, 5), kind="edge"),
        text(80, 40, "file, scale", "start"),
        text(0, -74, "closed, or thin: true with thickness_m"),
    ],
}  # fmt: skip
