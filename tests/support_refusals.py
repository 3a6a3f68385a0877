"""Faults and messages of refused calls."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from granular_contact.errors import ConfigError, Fault, SceneError

Refusal = type[Exception] | tuple[type[Exception], ...]
CONFIG_OR_SCENE: Refusal = (ConfigError, SceneError)


def faults_of(error: Refusal, call: Callable[..., Any], *arguments: Any, **named: Any) -> list[Fault]:
    """Faults of the error of this class that a call raises."""
    with pytest.raises(error) as caught:
        call(*arguments, **named)
    faults: list[Fault] = caught.value.faults  # type: ignore[attr-defined]
    return faults


def message_of(error: Refusal, call: Callable[..., Any], *arguments: Any, **named: Any) -> str:
    """Message of the error of this class that a call raises."""
    with pytest.raises(error) as caught:
        call(*arguments, **named)
    return str(caught.value)
