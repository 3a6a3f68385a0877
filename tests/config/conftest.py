"""Fixtures of the tests that read configs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from granular_contact.config import load
from granular_contact.errors import ConfigError, Fault


@pytest.fixture
def faults(tmp_path: Path) -> Callable[..., list[Fault]]:
    """Faults of a config text; files are named relative to the folder of the config."""

    def of(text: str | bytes, *overrides: str) -> list[Fault]:
        path = tmp_path / "run.yaml"
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        with pytest.raises(ConfigError) as caught:
            load(path, overrides)
        prefix = f"{tmp_path}/"
        return [Fault(f.file.removeprefix(prefix), f.line, f.key, f.message) for f in caught.value.faults]

    return of
