"""Claims of studies by their names."""

from __future__ import annotations

from collections.abc import Iterable

from validation.study import Claim


def held(claims: Iterable[Claim]) -> dict[str, bool]:
    """Whether each claim held, by its name without that of the study."""
    return {claim.name.partition(".")[2]: claim.held for claim in claims}
