"""The bed as MuJoCo's own passive callback, of which there is one for a whole process."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence
from typing import Any

from granular_contact.engines.mujoco.engine import mujoco

Passive = Callable[[Any, Any], None]


class Callback:
    """Sets MuJoCo's passive callback, and gives it back; what was there before is called too."""

    def __init__(self) -> None:
        self._installed: Passive | None = None
        self._before: Any = None

    def install(self, model: Any, datas: Sequence[Any], evaluate: Passive) -> None:
        """Have evaluate(model, data) called for these data, or for all of the model if there are none."""
        self.uninstall()
        self._before = mujoco.get_mjcb_passive()
        before = self._before if callable(self._before) else None
        only = weakref.WeakSet(datas) if datas else None

        def passive(of: Any, data: Any) -> None:
            if before is not None:
                before(of, data)
            if of is model and (only is None or data in only):
                evaluate(of, data)

        self._installed = passive
        mujoco.set_mjcb_passive(passive)

    def uninstall(self) -> None:
        """Give MuJoCo the callback that it had before."""
        if self._installed is not None and mujoco.get_mjcb_passive() is self._installed:
            mujoco.set_mjcb_passive(self._before)
        self._installed = None
