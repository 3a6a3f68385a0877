"""Schema of a model that is read from a robot file (URDF): the values that the file itself does not contain.

All keys of a mechanism in space may stand beside these keys. They replace or complete values of the robot file.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.values.strict import Listed, NotNegative, Positive, Strict, Text

Patterns = Annotated[tuple[Text, ...], Listed]


class RobotStops(Strict):
    """Stops at the limits of all joints: springs with damping after Hunt and Crossley."""

    stiffness_Nm_per_rad: Positive | None = None
    """Stiffness of stops of revolute joints. null: the stop reaches the effort limit of the joint one degree beyond its
    limit; without an effort limit, the weight of the robot times 0.1 m."""
    stiffness_N_per_m: Positive | None = None
    """Stiffness of stops of prismatic joints. null: the stop reaches the effort limit of the joint 1 mm beyond its
    limit; without an effort limit, the weight of the robot."""
    dissipation_s_per_rad: NotNegative = 0.0
    """Dissipation of stops of revolute joints, see `stops` of a hinge."""
    dissipation_s_per_m: NotNegative = 0.0
    """Dissipation of stops of prismatic joints, see `stops` of a slider."""


class RobotFile(Strict):
    """A robot file, and which parts of it are used."""

    urdf: Text
    """Path of the robot file, relative to the folder of the file with this key."""
    base: Literal["free", "fixed"] | None = None
    """free: the root link moves freely, by a free joint with its name; fixed: it is held. null: free, unless the root
    is a link without mass that is called world or ground."""
    shapes: Literal["collision", "visual"] = "collision"
    """Shapes of the links that are used: those for collision or those for display."""
    in_sand: Patterns | None = None
    """Links on whose shapes the medium acts: names, or patterns with * and ?. null: all links."""
    facet_size_m: Positive | None = None
    """Longest edge of the facets on which the medium acts; null: chosen by the estimated error of the motion."""
    fix: Patterns = ()
    """Joints that are held at zero: names, or patterns with * and ?. Mimic and planar joints may be held too."""
    mimic: Literal["refuse", "ignore"] = "refuse"
    """Treatment of joints that follow another joint (mimic). refuse: they are a fault; ignore: they move
    independently."""
    stops: RobotStops = RobotStops()
    """Stops at the limits of the joints."""
    packages: dict[str, Text] = Field(default_factory=dict)
    """Folders of ROS packages, by the NAME in package://NAME; relative to the folder of the file with this key."""
