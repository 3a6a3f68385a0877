"""Gymnasium environments of scenes (extra `[gym]`): `GranularEnv` of any config, runner and hexapod.

environment   `GranularEnv`
runner        the runner, as far to the right as it gets
hexapod       the hexapod, as far ahead as it gets

Importing this registers `granular_contact/Runner-v0`, `granular_contact/Hexapod-v0` and `granular_contact/Config-v0`,
a `GranularEnv` of the config that `gymnasium.make` is given; it imports this by itself where it is asked for
`granular_contact.gym:granular_contact/Runner-v0`.
"""

from __future__ import annotations

try:
    import gymnasium
except ImportError as error:
    raise ImportError("gymnasium is missing: pip install 'granular-contact[gym]'") from error

from granular_contact.gym.environment import GranularEnv
from granular_contact.gym.hexapod import hexapod_env
from granular_contact.gym.runner import runner_env

RUNNER = "granular_contact/Runner-v0"
HEXAPOD = "granular_contact/Hexapod-v0"
CONFIG = "granular_contact/Config-v0"

__all__ = ["CONFIG", "HEXAPOD", "RUNNER", "GranularEnv", "hexapod_env", "runner_env"]

_ENTRIES = {RUNNER: "runner:runner_env", HEXAPOD: "hexapod:hexapod_env", CONFIG: "environment:GranularEnv"}
for _id, _entry in _ENTRIES.items():
    if _id not in gymnasium.registry:
        gymnasium.register(id=_id, entry_point=f"granular_contact.gym.{_entry}")
