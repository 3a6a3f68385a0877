"""Gymnasium environments (extra `[gym]`): `GranularEnv` for any config, and environments of the runner and the hexapod.

environment   `GranularEnv`
runner        the runner; the reward is its distance to the right
hexapod       the hexapod; the reward is its distance ahead

Importing this package registers `granular_contact/Runner-v0`, `granular_contact/Hexapod-v0` and
`granular_contact/Config-v0`, a `GranularEnv` of the config that is given to `gymnasium.make`. Gymnasium imports the
package itself for the name `granular_contact.gym:granular_contact/Runner-v0`.
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
