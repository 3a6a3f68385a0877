"""Links that bend too little to show: as beams they would give round-off for elastic forces, so they are rigid."""

from __future__ import annotations

from typing import TypeVar

from granular_contact.config.schema import Scenario

Given = TypeVar("Given", bound=Scenario)
LEAST_BOW = 1e-7  # of a link's length: what bends less is rigid


def bow(force: float, length: float, bending: float, axial: float) -> float:
    """Static deflection and stretch of a clamped link under a distributed force (N), relative to its length (m).

    bending (N m2), axial (N): its stiffnesses.
    """
    return force * (length**2 / (8.0 * bending) + 1.0 / axial)


def with_rigid(scenario: Given, names: tuple[str, ...]) -> Given:
    """The scenario with these links rigid."""
    model, chain, bodies = scenario.model, scenario.model.chain, dict(scenario.model.bodies)
    for name in names:
        if name in bodies:
            bodies[name] = bodies[name].model_copy(update={"flexible": None})
        elif chain is not None:  # its links are all alike
            chain = chain.model_copy(update={"link": chain.link.model_copy(update={"flexible": None})})
    fields = {key: getattr(model, key) for key in type(model).model_fields} | {"bodies": bodies, "chain": chain}
    return scenario.model_copy(update={"model": type(model)(**fields)})
