"""Calls of compiled functions by their addresses, like a table of virtual functions.

Why. Numba compiles a function together with all functions that it calls, and again for each combination of argument
types. If a law were an argument, the kernels of lines, facets, friction and layers would be compiled again for each
law, which takes 10 to 20 CPU s; likewise the march of a tree with and without sand. With calls by address, kernels are
compiled once for all laws, and a law in about a second. A call takes some 10 ns, a strip 100 ns.

How. `address_of` compiles a function for fixed argument types as a C function (`numba.cfunc`), whose address goes into
a field of a record. `caller` makes the function by which kernels call the address in that field. Both use public parts
of numba alone: `cfunc` and `extending.intrinsic`, with LLVM's builder.

Limits. A C function cannot raise: numba prints the exception and continues with zeros. Kernels and laws raise nothing;
laws from outside the package that raise are refused (`laws.functions`). Argument types are not checked, so `caller` and
`address_of` must be given the same types.

Where nothing is compiled (`jit.compiled.COMPILES`), an address is the index of a function in a list of this module, and
`caller` makes a Python function that calls it: so a debugger steps from a kernel into a law.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import cfunc, from_dtype, types
from numba.extending import intrinsic

from granular_contact.jit.compiled import COMPILES, from_outside, options

OWN = None  # among argument types: the own record of a law
_BYTE, _INTEGER = ir.IntType(8).as_pointer(), ir.IntType(64)
_compiled: dict[tuple[Any, ...], Any] = {}  # keeps functions alive whose addresses are in use
_listed: list[tuple[Any, Any]] = [(None, None)]  # where nothing is compiled: functions, with record types of laws


def address_of(function: Any, kinds: tuple[Any, ...], result: Any, own: np.dtype | None = None) -> int:
    """Address of a function compiled for arguments of these types.

    Parameters
    ----------
    function
        The function, plain or compiled.
    kinds, result
        Numba's types of the arguments and of the result.
    own
        Type of the law's own record, which stands for OWN.
    """
    plain = getattr(function, "py_func", function)
    if not COMPILES:
        if (plain, own) not in _listed:
            _listed.append((plain, own))
        return _listed.index((plain, own))
    key = plain, kinds, own
    if key not in _compiled:
        signature = result(*(from_dtype(own) if kind is OWN else kind for kind in kinds))
        chosen = options(from_outside(plain))
        try:
            _compiled[key] = cfunc(signature, cache=True, **chosen)(plain)
        except RuntimeError:  # it has no file, as in a notebook
            _compiled[key] = cfunc(signature, **chosen)(plain)
    address: int = _compiled[key].address
    return address


def caller(name: str, kinds: tuple[Any, ...], result: Any, layout: np.dtype) -> Any:
    """Function for kernels: (record, arguments) -> result of the function whose address is in the record.

    Parameters
    ----------
    name
        Name of the field with the address.
    kinds, result
        As in `address_of`. The caller does not pass the record among the arguments: it is put in where its type stands,
        and the law's own record, in its field `own`, where OWN stands.
    layout
        Type of the record.
    """
    record_type = from_dtype(layout)
    if not COMPILES:
        return _caller_in_python(name, kinds, record_type)

    @intrinsic
    def call(typing_context, record, arguments):
        if record != record_type:  # as a law's own record, which has no addresses
            raise TypeError(f"got {record}, allowed is a record of {layout.names}")

        def generate(context, builder, signature, values):
            expected = [record if kind is OWN else kind for kind in kinds]  # any record is a pointer
            start = builder.bitcast(values[0], _BYTE)

            def field(name: str) -> Any:
                return builder.gep(start, [ir.Constant(_INTEGER, layout.fields[name][1])])  # type: ignore[index]

            passed, positions = [], iter(range(len(arguments)))
            for kind, wanted in zip(kinds, expected, strict=True):
                if kind is OWN:
                    passed.append(builder.bitcast(field("own"), values[0].type))
                elif kind == record:
                    passed.append(values[0])
                else:
                    i = next(positions)
                    value = builder.extract_value(values[1], i)
                    passed.append(context.cast(builder, value, arguments[i], wanted))
            values_of = [context.get_value_type(kind) for kind in expected]
            pointer = ir.FunctionType(context.get_value_type(result), values_of).as_pointer()
            address = builder.load(builder.bitcast(field(name), _INTEGER.as_pointer()))
            value = builder.call(builder.inttoptr(address, pointer), passed)
            return context.get_dummy_value() if result is types.none else value

        return result(record, arguments), generate

    return call


def _caller_in_python(name: str, kinds: tuple[Any, ...], record_type: Any) -> Any:
    """`caller` where nothing is compiled."""

    def call(record, arguments):
        function, own = _listed[record[name]]
        rest = iter(arguments)
        passed = [
            _own_record(record, own) if kind is OWN else record if kind == record_type else next(rest) for kind in kinds
        ]
        return function(*passed)

    return call


def _own_record(record: Any, own: np.dtype) -> Any:
    """A law's own record, from the field `own` of another record."""
    return record.own.view(np.uint8)[: own.itemsize].view(own)[0]
