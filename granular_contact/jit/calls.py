"""Calls of compiled functions by their addresses, as through the table of virtual functions of a class.

Why. Numba compiles a function together with all that it calls, and anew for each type of its arguments. Were a law an
argument, the kernels of lines, facets, friction and layers would be compiled for each law anew, 10 to 20 CPU s each; so
would a march of a tree with and without sand. Called by address, kernels are compiled once for all laws, and a law in
about a second. A call takes some 10 ns, where a strip takes 100.

How. `address_of` compiles a function for arguments of fixed types as a C function (`numba.cfunc`), whose address goes
into a field of a record; `caller` makes the function that kernels call what stands in that field by. Public parts of
numba are used alone: `cfunc` and `extending.intrinsic`, with LLVM's builder.

Limits. A C function cannot raise: numba prints what was raised and goes on with zeros. Kernels and laws raise nothing;
laws from outside are refused if they do (`laws.functions`). Its arguments are those of its types to the letter, so that
`caller` and `address_of` are given the same ones.

Where nothing is compiled (`jit.compiled.COMPILES`), an address is the number of a function in a list of this module,
and `caller` makes a function of Python that calls what stands there: so a debugger steps from a kernel into a law.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import cfunc, from_dtype, types
from numba.extending import intrinsic

from granular_contact.jit.compiled import COMPILES, from_outside, options

OWN = None  # among the types of arguments: where a law's function takes its own record
_BYTE, _WORD = ir.IntType(8).as_pointer(), ir.IntType(64)
_compiled: dict[tuple[Any, ...], Any] = {}  # what has an address has to be kept
_listed: list[tuple[Any, Any]] = [(None, None)]  # where nothing is compiled: functions, their laws' records


def address_of(function: Any, kinds: tuple[Any, ...], result: Any, own: np.dtype | None = None) -> int:
    """Address of a function as compiled for arguments of these types.

    Parameters
    ----------
    function
        Plain or compiled.
    kinds, result
        Numba's types of the arguments and of what it gives back.
    own
        Type of the record that a law's function takes where OWN stands.
    """
    plain = getattr(function, "py_func", function)
    if not COMPILES:
        if (plain, own) not in _listed:
            _listed.append((plain, own))
        return _listed.index((plain, own))
    known = plain, kinds, own
    if known not in _compiled:
        signature = result(*(from_dtype(own) if kind is OWN else kind for kind in kinds))
        told = options(from_outside(plain))
        try:
            _compiled[known] = cfunc(signature, cache=True, **told)(plain)
        except RuntimeError:  # it has no file, as in a notebook
            _compiled[known] = cfunc(signature, **told)(plain)
    address: int = _compiled[known].address
    return address


def caller(name: str, kinds: tuple[Any, ...], result: Any, layout: np.dtype) -> Any:
    """Function for kernels: (record, arguments) -> what the function gives whose address the record has.

    Parameters
    ----------
    name
        Of the field with the address.
    kinds, result
        As of `address_of`. The record itself, or the law's own record in its field `own` where OWN stands, is put among
        the arguments and is none of those given.
    layout
        Type of the record.
    """
    record_type = from_dtype(layout)
    if not COMPILES:
        return _caller_in_python(name, kinds, record_type)

    @intrinsic
    def call(typing_context, record, arguments):
        if record != record_type:  # a law's own record, say, which has no addresses
            raise TypeError(f"got {record}, allowed is a record of {layout.names}")

        def generate(context, builder, signature, values):
            there = [record if kind is OWN else kind for kind in kinds]  # any record is a pointer
            begin = builder.bitcast(values[0], _BYTE)

            def field(of: str) -> Any:
                return builder.gep(begin, [ir.Constant(_WORD, layout.fields[of][1])])  # type: ignore[index]

            passed, given = [], iter(range(len(arguments)))
            for kind, expected in zip(kinds, there, strict=True):
                if kind is OWN:
                    passed.append(builder.bitcast(field("own"), values[0].type))
                elif kind == record:
                    passed.append(values[0])
                else:
                    i = next(given)
                    value = builder.extract_value(values[1], i)
                    passed.append(context.cast(builder, value, arguments[i], expected))
            kinds_there = [context.get_value_type(kind) for kind in there]
            pointer = ir.FunctionType(context.get_value_type(result), kinds_there).as_pointer()
            address = builder.load(builder.bitcast(field(name), _WORD.as_pointer()))
            value = builder.call(builder.inttoptr(address, pointer), passed)
            return context.get_dummy_value() if result is types.none else value

        return result(record, arguments), generate

    return call


def _caller_in_python(name: str, kinds: tuple[Any, ...], record_type: Any) -> Any:
    """What `caller` makes where nothing is compiled."""

    def call(record, arguments):
        function, own = _listed[record[name]]
        given = iter(arguments)
        passed = [
            _own_record(record, own) if kind is OWN else record if kind == record_type else next(given)
            for kind in kinds
        ]
        return function(*passed)

    return call


def _own_record(record: Any, own: np.dtype) -> Any:
    """A law's own record, in the field `own` of another."""
    return record.own.view(np.uint8)[: own.itemsize].view(own)[0]
