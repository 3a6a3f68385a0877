"""The module MuJoCo; if it is missing, an error that says how to install it."""

from __future__ import annotations

from typing import Any

from granular_contact.errors import MissingPackageError

try:
    import mujoco as _mujoco
except ImportError:
    raise MissingPackageError("granular_contact.mujoco needs MuJoCo: pip install 'granular-contact[mujoco]'") from None

mujoco: Any = _mujoco


def name_of(model: Any, kind: str, number: int) -> str:
    """Name of a body, geom or joint by its number; `body 3` if it has none. kind: "body", "geom" or "joint"."""
    name: str | None = mujoco.mj_id2name(model, getattr(mujoco.mjtObj, f"mjOBJ_{kind.upper()}"), number)
    return name or f"{kind} {number}"
