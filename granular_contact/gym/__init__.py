"""Gymnasium environments of scenes (extra `[gym]`): `GranularEnv` of any config, and the runner.

environment   `GranularEnv`
runner        the runner, as far to the right as it gets

Importing this registers `granular_contact/Runner-v0`; `gymnasium.make` imports it by itself where it is asked for
`granular_contact.gym:granular_contact/Runner-v0`.
"""

from __future__ import annotations

try:
    import gymnasium
except ImportError as error:
    raise ImportError("gymnasium is missing: pip install 'granular-contact[gym]'") from error

from granular_contact.gym.environment import GranularEnv
from granular_contact.gym.runner import runner_env

RUNNER = "granular_contact/Runner-v0"

__all__ = ["RUNNER", "GranularEnv", "runner_env"]

if RUNNER not in gymnasium.registry:
    gymnasium.register(id=RUNNER, entry_point="granular_contact.gym.runner:runner_env")
