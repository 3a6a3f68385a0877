"""MuJoCo's passive callback, of which a process has one, for a bed."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence
from typing import Any

from granular_contact.engines.mujoco.engine import mujoco

Passive = Callable[[Any, Any], None]


class Callback:
    """Sets and resets MuJoCo's passive callback; a callback that was set before is called, too."""

    def __init__(self) -> None:
        self._installed: Passive | None = None
        self._previous: Any = None

    def install(self, model: Any, datas: Sequence[Any], evaluate: Passive) -> None:
        """Let MuJoCo call evaluate(model, data) for these data, or for all data of the model if there are none."""
        self.uninstall()
        self._previous = mujoco.get_mjcb_passive()
        previous = self._previous if callable(self._previous) else None
        chosen = weakref.WeakSet(datas) if datas else None

        def passive(model_called: Any, data: Any) -> None:
            if previous is not None:
                previous(model_called, data)
            if model_called is model and (chosen is None or data in chosen):
                evaluate(model_called, data)

        self._installed = passive
        mujoco.set_mjcb_passive(passive)

    def uninstall(self) -> None:
        """Set the callback that MuJoCo had before, unless another one was set in the meantime."""
        if self._installed is not None and mujoco.get_mjcb_passive() is self._installed:
            mujoco.set_mjcb_passive(self._previous)
        self._installed = None
