"""Links that bend too little to show; they are made rigid, as elastic forces of such beams would be round-off."""

from __future__ import annotations

from typing import TypeVar

from granular_contact.config.schema import Scenario

Given = TypeVar("Given", bound=Scenario)
LEAST_BOW = 1e-7  # relative to a link's length: a link that bends less is made rigid


def bow(force: float, length: float, bending: float, axial: float) -> float:
    """Static deflection and stretch of a clamped link under a distributed force (N), relative to its length (m).

    bending (N m2), axial (N): its stiffnesses.
    """
    return force * (length**2 / (8.0 * bending) + 1.0 / axial)


def with_rigid(scenario: Given, names: tuple[str, ...]) -> Given:
    """The scenario with these links made rigid."""
    model, chain, bodies = scenario.model, scenario.model.chain, dict(scenario.model.bodies)
    for name in names:
        if name in bodies:
            bodies[name] = bodies[name].model_copy(update={"flexible": None})
        elif chain is not None:  # one entry describes all links of a chain
            chain = chain.model_copy(update={"link": chain.link.model_copy(update={"flexible": None})})
    fields = {key: getattr(model, key) for key in type(model).model_fields} | {"bodies": bodies, "chain": chain}
    return scenario.model_copy(update={"model": type(model)(**fields)})
