"""Schema of a model that comes from a robot file (URDF): what the file does not say. All other keys of a mechanism in
space may stand beside these, and are put over what the file gives.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.values.strict import Listed, NotNegative, Positive, Strict, Text

Patterns = Annotated[tuple[Text, ...], Listed]


class RobotStops(Strict):
    """Springs at the limits of joints."""

    stiffness_Nm_per_rad: Positive | None = None
    """Of revolute joints; null: the joint's effort limit at one degree, else the robot's weight at 0.1 m."""
    stiffness_N_per_m: Positive | None = None
    """Of prismatic joints; null: the joint's effort limit at one mm, else the robot's weight."""
    dissipation_s_per_rad: NotNegative = 0.0
    dissipation_s_per_m: NotNegative = 0.0


class RobotFile(Strict):
    """A robot file, and what of it is used."""

    urdf: Text
    """Path of the file, from the folder of the file that names it."""
    base: Literal["free", "fixed"] | None = None
    """Whether the root link moves freely, by a free joint of its name, or is held; null: freely, unless the root is a
    link without mass called world or ground."""
    shapes: Literal["collision", "visual"] = "collision"
    """Which shapes of the links are used."""
    in_sand: Patterns | None = None
    """Names of links, or patterns with * and ?, on whose shapes the medium acts; null: on all."""
    facet_size_m: Positive | None = None
    """Greatest edge of the facets on which the medium acts."""
    fix: Patterns = ()
    """Names or patterns of joints that are held at zero: also such as follow another (mimic), or are planar."""
    mimic: Literal["refuse", "ignore"] = "refuse"
    """What becomes of joints that follow another: refused, or free to move by themselves."""
    stops: RobotStops = RobotStops()
    """At the limits of the joints."""
    packages: dict[str, Text] = Field(default_factory=dict)
    """Folders of packages, which the file names as package://NAME, from the folder of the file with this key."""
