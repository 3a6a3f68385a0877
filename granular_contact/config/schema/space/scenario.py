"""Schema of a run in space: as in the plane, with mechanism, start and bed of three dimensions."""

from __future__ import annotations

from granular_contact.config.schema.fitting import drive_faults
from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.schema.space.bed import SpatialBed
from granular_contact.config.schema.space.model import SpatialModel
from granular_contact.config.schema.space.start import SpatialInitial, initial_faults
from granular_contact.laws.law import Law
from granular_contact.values.strict import Faults


class SpatialScenario(Scenario):
    """A run in space, complete: every name resolved and every default in place."""

    model: SpatialModel  # type: ignore[assignment]
    surface_height_m: float | None = None
    """Height of the free surface above the origin; null: the mechanism touches the surface at the start. Parts below it
    start in the medium with zero friction state, as if placed there without disturbing a grain."""
    bed: SpatialBed | None = None  # type: ignore[assignment]
    """Slope or heights of the surface, floor, container and layers; null: level and unbounded."""
    initial: SpatialInitial = SpatialInitial()  # type: ignore[assignment]
    """Joints left out start at rest in the reference configuration."""

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
        if self.method.name not in ("auto", "engine"):
            yield ("method",), f"got {self.method.name}; in space allowed are auto and engine"
        if self.load.form != "distributed":
            yield ("load", "form"), f"got {self.load.form}; in space allowed is distributed"
