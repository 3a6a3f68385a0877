"""Schema of a run in space: as in the plane, with mechanism, start and bed of three dimensions.

The start is positions, orientations and rates of joints; whether it fits them is checked here.
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
    """State of one joint, in its own coordinate; what is left out is that of rest in the reference configuration.

    Of a free body or a ball joint rpy_deg or quaternion is the orientation of the child in the frame of its parent, in
    place of that of the joint.
    """

    angle_deg: float | None = None
    """Of a hinge, right-handed about its axis."""
    z_m: float | None = None
    vz_m_s: float | None = None
    spin_rad_s: Point3 | None = None
    """Angular velocity of a free body along the axes of the world, of a ball joint along those of the parent."""

    @property
    def height(self) -> float | None:
        """Of a free body (m), if it is given."""
        return self.z_m


RATES = ("rate_rad_s", "speed_m_s", "vx_m_s", "vy_m_s", "vz_m_s", "spin_rad_s")


class SpatialInitial(Strict):
    """Initial state of a mechanism in space."""

    joints: dict[str, SpatialJointStart] | None = None
    """By the name of the joint; others start at rest in the reference configuration, or follow a loop or a drive."""
    settle: bool = False
    """Start from static equilibrium under gravity, with the drives as they are at t = 0."""

    def _faults(self) -> Faults:
        for name, start in (self.joints or {}).items() if self.settle else ():
            yield from speed_faults(start, ("joints", name), RATES)


def initial_faults(initial: SpatialInitial, model: SpatialModel) -> Faults:
    """Faults of an initial state, with paths below the scenario."""
    for name, start in (initial.joints or {}).items():
        yield from joint_state_faults(name, start, model, "all other joints")


class SpatialScenario(Scenario):
    """A run in space, complete: every name resolved and every default in place."""

    model: SpatialModel
    bed: SpatialBed | None = None  # type: ignore[assignment]
    """Slope or heights of the surface, floor, container and layers; null: level and unbounded."""
    initial: SpatialInitial = SpatialInitial()  # type: ignore[assignment]
    """Joints left out start at rest in the reference configuration."""

    @property
    def is_modal(self) -> bool:
        """Never: links in modes are solved as trees are."""
        return False

    def _surface_faults(self) -> Faults:
        if self.bed is not None and self.surface_height_m is not None and self.bed.height_m is not None:
            words = "the bed has height_m too; one height of the surface is allowed"
            yield ("surface_height_m",), words

    def _mechanism_faults(self) -> Faults:
        yield from initial_faults(self.initial, self.model)
        yield from drive_faults(self.drives, self.signals, self.model)
        several = isinstance(self.medium, tuple)
        media: list[tuple[tuple[str | int, ...], Law]] = [
            (("medium", i) if several else ("medium",), one) for i, one in enumerate(self.media)
        ]
        layers = () if self.bed is None else self.bed.layers
        media += [(("bed", "layers", i, "medium"), layer.medium) for i, layer in enumerate(layers)]
        for path, medium in media:
            if medium.scatters and "flat" not in medium.takes:
                words = f"is in space for laws of surfaces, and {medium.law} is none; allowed is null"
                yield (*path, "scatter"), words
            yield from [((*path, key), "is missing; in space a number is needed") for key in medium.lacking_in_space]
        if self.wheel is not None:
            yield ("wheel",), "is for wheels in the plane; in space allowed is null"
        if (reduced := self.method.reduced) is not None:
            for key, value in Reduced(modes=reduced.modes):
                if (got := getattr(reduced, key)) != value:
                    words = f"got {got}, which is of the plane; in space allowed is {value}"
                    yield ("method", "reduced", key), words
        if self.load.form != "distributed":
            yield ("load", "form"), f"got {self.load.form}; in space allowed is distributed"
