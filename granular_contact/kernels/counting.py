"""Which compiled functions count who refers to their arrays: those that make one or give one back.

All others see arrays that outlive them, arguments and views of them. To count there is code to write and to optimise at
every slice and every call, and an instruction that all cores wait for whenever it runs.
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.core import ir
from numba.core.extending import _Intrinsic


def counts(state: Any) -> bool:
    """Whether a function, by the types that numba found in it, has to count references; if in doubt it has."""
    managers = state.targetctx.data_model_manager

    def counted(kind: Any) -> bool:
        return bool(managers[kind].contains_nrt_meminfo())

    def borrows(kind: Any) -> bool:
        if isinstance(kind, types.BaseTuple):
            return all(map(borrows, kind))
        return isinstance(kind, types.Array) or not counted(kind)

    def keeps(done: Any, signature: Any) -> bool:
        """Whether an operation makes nothing that is counted: of arrays views alone, and what intrinsics lend."""
        if signature is None:
            return True
        if not isinstance(done, ir.Expr):  # numbers are put in, where a whole array would be copied first
            return not any(map(counted, signature.args[-1:]))
        given, gives = any(map(counted, signature.args)), counted(signature.return_type)
        if done.op == "call":
            function = state.typemap[done.func.name]
            ours = isinstance(function, types.Dispatcher) and not gives  # and counts for itself what it makes
            return ours or _lends(function) or not (given or gives)
        if done.op in ("getitem", "static_getitem"):
            return not any(map(counted, signature.args[1:]))
        return not gives

    return (
        counted(state.return_type)
        or not all(map(borrows, state.typemap.values()))
        or not all(keeps(done, signature) for done, signature in state.calltypes.items())
    )


def _lends(function: Any) -> bool:
    """Whether a function is an intrinsic of this package, which makes no array that is counted."""
    key = getattr(function, "typing_key", None)
    return isinstance(key, _Intrinsic) and key.__module__.startswith(__package__)
