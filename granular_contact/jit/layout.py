"""Arrays that stay at the same addresses, which a kernel finds by their names: `w.pose`.

Handing one array from Python to a kernel takes some 0.1 us and an instruction that all cores wait for: a dozen arrays
cost more than the law on a few strips. Where each call takes the same arrays, Python writes their addresses and shapes
down once (`Layout.addresses`), the kernel takes these whole numbers as one array, and `view` makes a view of them, an
object whose attributes are the arrays:

    MOTION = Layout("motion", q=(float, 1), points=(float, 2))
    view = MOTION.view

    @kernel
    def move(addresses, h):
        w = view(addresses)
        w.q[0] += h * w.points[0, 1]

A compiled view is a pointer to the addresses. Kernels pass it on as one argument, of the type `MOTION.kind`, also to
functions that are called by their address (`calls`). The attributes are made by numba's low-level interface for types
(`numba.extending`). The arrays have all fields of numba's arrays, but their references are not counted.

Where nothing is compiled, a view is a Python object with these attributes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numba import from_dtype, types
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic, models, register_model
from numpy.typing import DTypeLike, NDArray

from granular_contact.jit.compiled import COMPILES
from granular_contact.jit.memory import array_at, view_of

PER_ARRAY = 4  # whole numbers for each array: its address, and its size along up to three axes
_layouts: dict[str, Layout] = {}


class Layout:
    """Names and types of the arrays of a view, in the order in which their addresses are written down.

    Parameters
    ----------
    name
        Unique name of the layout, by which numba tells its views from others.
    arrays
        (type of numbers or records, number of axes: 1 to 3) of each array.
    """

    def __init__(self, name: str, /, **arrays: tuple[DTypeLike, int]) -> None:
        self.name, self.types = name, {name: (np.dtype(kind), axes) for name, (kind, axes) in arrays.items()}
        self.kind = _View(name)
        self.view = _view(self)
        _layouts[name] = self

    def of(self, *names: str) -> dict[str, tuple[np.dtype, int]]:
        """Entries of the arrays with these names, for another layout that has the same arrays."""
        return {name: self.types[name] for name in names}

    def addresses(self, arrays: Mapping[str, NDArray[Any]]) -> NDArray[np.int64]:
        """Addresses and shapes of the arrays, (PER_ARRAY * names,); zeros for arrays that are not given.

        The arrays are contiguous, and the caller keeps them alive for as long as kernels use the addresses.
        """
        table = np.zeros((len(self.types), PER_ARRAY), np.int64)
        for row, (name, (kind, axes)) in zip(table, self.types.items(), strict=True):
            array = arrays.get(name)
            if array is None:
                continue
            if not (array.flags.c_contiguous and array.flags.writeable and array.flags.aligned):
                raise ValueError(f"{name}: allowed are contiguous arrays that can be written to")
            if (array.dtype, array.ndim) != (kind, axes):
                raise TypeError(f"{name}: got {array.ndim} axes of {array.dtype}, allowed are {axes} of {kind}")
            row[: 1 + axes] = array.ctypes.data, *array.shape
        return table.ravel()


class _View(types.Type):  # type: ignore[misc]  # numba is not typed
    """Type of views of a layout, in compiled code."""

    def __init__(self, layout: str) -> None:
        self.layout = layout
        super().__init__(name=f"View({layout})")

    def array(self, name: str) -> Any:
        """Type of the array of this name; None if the layout has no such array."""
        entry = _layouts[self.layout].types.get(name)
        return entry and types.Array(from_dtype(entry[0]), entry[1], "C")


register_model(_View)(models.OpaqueModel)  # a pointer to the addresses


@infer_getattr
class _Attributes(AttributeTemplate):  # type: ignore[misc]
    """Types of the attributes of a view."""

    key = _View

    def generic_resolve(self, kind: Any, name: str) -> Any:
        return kind.array(name)


@lower_getattr_generic(_View)
def _array(context: Any, builder: Any, kind: Any, addresses: Any, name: str) -> Any:
    """LLVM code of an attribute of a view: the array of this name."""
    array, integer = kind.array(name), types.intp
    first = PER_ARRAY * list(_layouts[kind.layout].types).index(name)
    addresses = builder.bitcast(addresses, context.get_value_type(types.CPointer(integer)))

    def read(i: int) -> Any:
        return builder.load(builder.gep(addresses, [context.get_constant(integer, first + i)]))

    data = builder.inttoptr(read(0), context.get_value_type(types.voidptr))
    return view_of(context, builder, array, data, [read(1 + axis) for axis in range(array.ndim)])


def _view(layout: Layout) -> Any:
    """Function for kernels: addresses as in `Layout.addresses`, (PER_ARRAY * names,) -> view."""
    if not COMPILES:
        return lambda addresses: _Arrays(layout, addresses)

    @intrinsic
    def view(typing_context, addresses):
        def generate(context, builder, signature, values):
            data = context.make_array(addresses)(context, builder, values[0]).data
            return builder.bitcast(data, context.get_value_type(layout.kind))

        return layout.kind(addresses), generate

    return view


class _Arrays:
    """A view, where nothing is compiled."""

    def __init__(self, layout: Layout, addresses: NDArray[np.int64]) -> None:
        self._layout, self._addresses = layout, addresses

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name not in self._layout.types:
            raise AttributeError(f"{self._layout.name} has no {name!r}")
        kind, axes = self._layout.types[name]
        first = PER_ARRAY * list(self._layout.types).index(name)
        address, *shape = self._addresses[first : first + 1 + axes]
        return array_at(address, tuple(shape), kind)
