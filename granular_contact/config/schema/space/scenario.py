"""Schema of a run in space: as in the plane, with mechanism, initial state and bed in three dimensions.

The initial state consists of positions, orientations and velocities of joints. This module checks that each joint
exists and allows the keys that are given for it.
"""

from __future__ import annotations

from granular_contact.config.schema.initial import JointStart, drive_faults, joint_state_faults, speed_faults
from granular_contact.config.schema.method import Reduced
from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.schema.space.bed import SpatialBed
from granular_contact.config.schema.space.model import SpatialModel
from granular_contact.config.schema.space.turned import Oriented, Point3
from granular_contact.laws.law import Law
from granular_contact.values.strict import Faults, Strict


class SpatialJointStart(JointStart, Oriented):
    """Initial state of one joint, in its own coordinates. null: at rest in the reference configuration (home).

    For a free body or a ball joint rpy_deg or quaternion is the orientation of the child in the frame of its parent. It
    replaces the orientation that the joint gives.
    """

    angle_deg: float | None = None
    """Hinge: angle of the joint, right-handed about its axis."""
    rate_rad_s: float | None = None
    """Hinge: angular rate, right-handed about its axis."""
    x_m: float | None = None
    """Free body: x of its joint point, measured from the point of the joint on the ground."""
    y_m: float | None = None
    """Free body: y of its joint point, measured from the point of the joint on the ground."""
    z_m: float | None = None
    """Free body: z of its joint point, upward from the point of the joint on the ground."""
    vx_m_s: float | None = None
    """Free body: velocity of its joint point along x of the world."""
    vy_m_s: float | None = None
    """Free body: velocity of its joint point along y of the world."""
    vz_m_s: float | None = None
    """Free body: velocity of its joint point along z of the world."""
    spin_rad_s: Point3 | None = None
    """Angular velocity. Free body: along the axes of the world. Ball joint: relative to the parent, along the axes of
    the parent."""

    @property
    def height(self) -> float | None:
        """Height of a free body (m); None if it is not given."""
        return self.z_m


RATES = ("rate_rad_s", "speed_m_s", "vx_m_s", "vy_m_s", "vz_m_s", "spin_rad_s")


class SpatialInitial(Strict):
    """Initial state of a mechanism in space."""

    joints: dict[str, SpatialJointStart] | None = None
    """Initial states by the name of the joint. A joint that is not named starts at rest in the reference configuration
    (home), or follows from a loop or a drive."""
    settle: bool = False
    """true: first find the static equilibrium under gravity, and start the run from there at rest. Signals of drives
    keep their value at t = 0 meanwhile."""

    def _faults(self) -> Faults:
        for name, start in (self.joints or {}).items() if self.settle else ():
            yield from speed_faults(start, ("joints", name), RATES)


def initial_faults(initial: SpatialInitial, model: SpatialModel) -> Faults:
    """Faults of an initial state, with paths below the scenario."""
    for name, start in (initial.joints or {}).items():
        yield from joint_state_faults(name, start, model, "all other joints")


class SpatialScenario(Scenario):
    """A complete run in space: all names of models and media are resolved, and all defaults are filled in."""

    model: SpatialModel
    bed: SpatialBed | None = None  # type: ignore[assignment]
    """Slope or height map of the surface, floor, container and layers. null: a level surface, without floor and
    walls."""
    initial: SpatialInitial = SpatialInitial()  # type: ignore[assignment]
    """Initial state. A joint that is not named starts at rest in the reference configuration (home)."""

    @property
    def is_modal(self) -> bool:
        """False: minimal coordinates solve links in modal coordinates in space."""
        return False

    def _surface_faults(self) -> Faults:
        if self.bed is not None and self.surface_height_m is not None and self.bed.height_m is not None:
            message = "the bed has height_m too; one height of the surface is allowed"
            yield ("surface_height_m",), message

    def _mechanism_faults(self) -> Faults:
        yield from initial_faults(self.initial, self.model)
        yield from drive_faults(self.drives, self.signals, self.model)
        several = isinstance(self.medium, tuple)
        media: list[tuple[tuple[str | int, ...], Law]] = [
            (("medium", i) if several else ("medium",), medium) for i, medium in enumerate(self.media)
        ]
        layers = () if self.bed is None else self.bed.layers
        media += [(("bed", "layers", i, "medium"), layer.medium) for i, layer in enumerate(layers)]
        for path, medium in media:
            if medium.scatters and "flat" not in medium.takes:
                message = f"is in space for laws of surfaces, and {medium.law} is none; allowed is null"
                yield (*path, "scatter"), message
            yield from [((*path, key), "is missing; in space a number is needed") for key in medium.lacking_in_space]
        if self.wheel is not None:
            yield ("wheel",), "is for wheels in the plane; in space allowed is null"
        if (reduced := self.method.reduced) is not None:
            for key, value in Reduced(modes=reduced.modes):
                if (got := getattr(reduced, key)) != value:
                    message = f"got {got}, which is of the plane; in space allowed is {value}"
                    yield ("method", "reduced", key), message
        if self.load.form != "distributed":
            yield ("load", "form"), f"got {self.load.form}; in space allowed is distributed"
