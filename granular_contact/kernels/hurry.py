"""Compiling in less than the time numba takes by itself, by what it repeats.

Numba finds the type of each sum, product and element anew among all functions that an operator may stand for, of
strings, lists and sets, too: a sixth of its time. Here those of numbers and arrays are remembered, as are sizes of
variables, for each of which it has LLVM read a text, and functions that it looks for in vain. Where variables live it
finds nine times for each function, and needs it once. LLVM optimises each function by itself, and again with all that
it calls: the second time is enough, and kernels are no slower without the first. And Python's collector of garbage
looks again and again at all that is loaded, as compiling makes many small objects that live on: a tenth. References
are counted where arrays are made alone (`counting`), and then LLVM has to optimise once, not twice. Messages on types
that do not fit get no colours. None of it changes a result. Where numba has no such place any more, it takes its own
time.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from llvmlite.ir import Type
from numba import types
from numba.core import errors
from numba.core.base import BaseContext
from numba.core.codegen import CPUCodeLibrary
from numba.core.compiler_lock import global_compiler_lock
from numba.core.ir import Inst, Loc, Var
from numba.core.postproc import PostProcessor, VariableLifetime
from numba.core.transforms import canonicalize_cfg
from numba.core.typed_passes import BaseNativeLowering
from numba.core.types.functions import BaseFunction

from granular_contact.kernels.counting import counts

KINDS = (types.Number, types.Boolean, types.Array, types.BaseTuple)  # constants, whose types are their own, are numbers
PLAIN = {Loc, str, int, bool, type(None)}  # in a statement, beside variables
OPTIONAL = ("__array__", "static_getitem", "static_setitem")  # what numba does in another way where there is none
_depth = 0


@contextmanager
def hurried() -> Iterator[None]:
    """Compile faster inside; threads that compile wait for each other, as numba asks."""
    global _depth
    with global_compiler_lock:
        collects = _depth == 0 and gc.isenabled()
        if _depth == 0:
            gc.disable()
            _let(_HURRIED)
        _depth += 1
        try:
            yield
        finally:
            _depth -= 1
            if _depth == 0:
                _let(_OWN)
            if collects:
                gc.enable()


def _let(methods: dict[tuple[type, str], Any]) -> None:
    for (owner, name), method in methods.items():
        if method is not None:
            setattr(owner, name, method)


def _signature(own: Any) -> Callable[..., Any]:
    """`get_call_type` of a function of numba: its signature for arguments of these types."""
    known: dict[tuple[int, tuple[Any, ...]], tuple[Any, Any]] = {}  # with the function, as ids are reused

    def get_call_type(function: Any, context: Any, args: Any, kws: Any) -> Any:
        if kws or not all(isinstance(kind, KINDS) for kind in args):
            return own(function, context, args, kws)
        key = id(function), tuple(args)
        if key not in known:
            known[key] = function, own(function, context, args, kws)
        return known[key][1]

    return get_call_type


def _size(own: Any) -> Callable[..., Any]:
    """`get_abi_size` of a type of LLVM (bytes) on a machine."""
    known: dict[tuple[int, str], tuple[Any, int]] = {}

    def get_abi_size(kind: Any, target_data: Any, context: Any = None) -> int:
        key = id(target_data), str(kind)
        if key not in known:
            known[key] = target_data, own(kind, target_data, context)
        return known[key][1]

    return get_abi_size


def _found(own: Any) -> Callable[..., Any]:
    """`get_function` of numba: what is compiled for an operation on these types."""
    missing: set[tuple[Any, ...]] = set()

    def get_function(context: Any, function: Any, signature: Any, _firstcall: bool = True) -> Any:
        if function not in OPTIONAL:
            return own(context, function, signature, _firstcall)
        key = function, signature.args
        if key in missing:
            raise NotImplementedError(function)
        try:
            return own(context, function, signature, _firstcall)
        except NotImplementedError:
            missing.add(key)
            raise

    return get_function


def _lifetimes(own: Any) -> Callable[..., Any]:
    """`run` between the passes of numba: which variables live where, which the last of them asks for alone."""

    def run(processor: Any, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
        function = processor.func_ir
        if emit_dels or function.is_generator:
            own(processor, emit_dels, extend_lifetimes)
            return
        function.blocks = canonicalize_cfg(function.blocks)
        function.variable_lifetime = VariableLifetime(function.blocks)
        function.generator_info = None

    return run


def _uncounted(own: Any) -> Callable[..., Any]:
    """`run_pass` of the writing of code: without counts of references where nothing is made, see `counting`."""

    def run_pass(lowering: Any, state: Any) -> Any:
        if state.targetctx.enable_nrt and not counts(state):
            state.targetctx.enable_nrt = state.flags.nrt = False  # those of this function alone
        return own(lowering, state)

    return run_pass


def _variables(own: Any) -> Callable[..., Any]:
    """`_rec_list_vars` of a statement: the variables in it, without a call for each name, place and number."""

    def list_variables(statement: Any, value: Any) -> list[Any]:
        if type(value) is not dict:
            found: list[Any] = own(statement, value)
            return found
        several = []
        for one in value.values():
            if type(one) is Var:
                several.append(one)
            elif type(one) not in PLAIN:
                several += own(statement, one)
        return several

    return list_variables


def _uncoloured(own: Any) -> Callable[..., Any]:
    """`_markup` of messages: numba writes thousands for itself, and sets up a terminal for each."""

    def markup(scheme: Any, text: str, color: Any = None, style: Any = None) -> str:
        return text

    return markup


def _once(own: Any) -> Callable[..., Any]:
    """`_optimize_final_module` of a library: once, not twice, the first time for what prunes counts."""

    def optimize(library: Any) -> None:
        passes, builder = library._codegen._module_pass_manager()
        passes.run(library._final_module, builder)

    return optimize


def _together(own: Any) -> Callable[..., Any]:
    """`_optimize_functions` of a library of numba: left out but for the layout of its data."""

    def optimize(library: Any, module: Any) -> None:
        module.data_layout = library._codegen._data_layout

    return optimize


_PLACES = {
    (BaseFunction, "get_call_type"): _signature,
    (Type, "get_abi_size"): _size,
    (BaseContext, "get_function"): _found,
    (PostProcessor, "run"): _lifetimes,
    (CPUCodeLibrary, "_optimize_functions"): _together,
    (CPUCodeLibrary, "_optimize_final_module"): _once,
    (BaseNativeLowering, "run_pass"): _uncounted,
    (Inst, "_rec_list_vars"): _variables,
    (getattr(errors, "HighlightColorScheme", None), "_markup"): _uncoloured,
}
_OWN = {place: getattr(*place, None) for place in _PLACES}
_HURRIED = {place: None if own is None else _PLACES[place](own) for place, own in _OWN.items()}
