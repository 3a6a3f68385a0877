"""Arrays that stay in one place, which a kernel finds by their names: `w.pose`.

To hand one array over from Python takes some 0.1 us and an instruction that all cores wait for, so that a dozen of
them cost more than the law on a few strips. Where the same arrays come with each call, their places are written down
once (`Layout.places`), a kernel takes these whole numbers, and `view` makes of them what has the arrays as attributes:

    MOTION = Layout("motion", q=(float, 1), points=(float, 2))
    view = MOTION.view

    @kernel
    def move(words, h):
        w = view(words)
        w.q[0] += h * w.points[0, 1]

A view is a pointer to the places; kernels hand it on as one argument, also to what is called by its address (`calls`),
of the type `MOTION.kind`. Attributes are made by numba's low-level interface for types (`numba.extending`); an array
has the fields of numba's own, but nobody counts its references.

Where nothing is compiled, a view is an object of Python with these attributes.
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

WORDS = 4  # for each array: where it begins, and its size along up to three axes
_layouts: dict[str, Layout] = {}


class Layout:
    """Names of arrays that come together, in the order in which their places are written down.

    Parameters
    ----------
    name
        Of the layout, by which numba knows its views; no two have the same.
    arrays
        (type of numbers or records, number of axes: 1 to 3) of each array.
    """

    def __init__(self, name: str, /, **arrays: tuple[DTypeLike, int]) -> None:
        self.name, self.types = name, {name: (np.dtype(kind), axes) for name, (kind, axes) in arrays.items()}
        self.kind = _View(name)
        self.view = _view(self)
        _layouts[name] = self

    def of(self, *names: str) -> dict[str, tuple[np.dtype, int]]:
        """Some of the arrays, for a layout that has them, too."""
        return {name: self.types[name] for name in names}

    def places(self, arrays: Mapping[str, NDArray[Any]]) -> NDArray[np.int64]:
        """Where the arrays are, (WORDS * names,), those that are not given left out.

        They are contiguous, and somebody keeps them for as long as kernels look there.
        """
        found = np.zeros((len(self.types), WORDS), np.int64)
        for words, (name, (kind, axes)) in zip(found, self.types.items(), strict=True):
            array = arrays.get(name)
            if array is None:
                continue
            if not (array.flags.c_contiguous and array.flags.writeable and array.flags.aligned):
                raise ValueError(f"{name}: allowed are contiguous arrays that can be written to")
            if (array.dtype, array.ndim) != (kind, axes):
                raise TypeError(f"{name}: got {array.ndim} axes of {array.dtype}, allowed are {axes} of {kind}")
            words[: 1 + axes] = array.ctypes.data, *array.shape
        return found.ravel()


class _View(types.Type):  # type: ignore[misc]  # numba is not typed
    """Type of views of a layout, in compiled code."""

    def __init__(self, layout: str) -> None:
        self.layout = layout
        super().__init__(name=f"View({layout})")

    def array(self, name: str) -> Any:
        """Type of the array of this name, None of none."""
        found = _layouts[self.layout].types.get(name)
        return found and types.Array(from_dtype(found[0]), found[1], "C")


register_model(_View)(models.OpaqueModel)  # a pointer, to the places


@infer_getattr
class _Attributes(AttributeTemplate):  # type: ignore[misc]
    """Types of a view's attributes."""

    key = _View

    def generic_resolve(self, kind: Any, name: str) -> Any:
        return kind.array(name)


@lower_getattr_generic(_View)
def _array(context: Any, builder: Any, kind: Any, words: Any, name: str) -> Any:
    """The array of a view that has this name."""
    found, word = kind.array(name), types.intp
    begin = WORDS * list(_layouts[kind.layout].types).index(name)
    words = builder.bitcast(words, context.get_value_type(types.CPointer(word)))

    def read(i: int) -> Any:
        return builder.load(builder.gep(words, [context.get_constant(word, begin + i)]))

    data = builder.inttoptr(read(0), context.get_value_type(types.voidptr))
    return view_of(context, builder, found, data, [read(1 + axis) for axis in range(found.ndim)])


def _view(layout: Layout) -> Any:
    """Function for kernels: what `places` gave, (WORDS * names,) -> a view."""
    if not COMPILES:
        return lambda words: _Arrays(layout, words)

    @intrinsic
    def view(typing_context, words):
        def generate(context, builder, signature, values):
            place = context.make_array(words)(context, builder, values[0]).data
            return builder.bitcast(place, context.get_value_type(layout.kind))

        return layout.kind(words), generate

    return view


class _Arrays:
    """A view, where nothing is compiled."""

    def __init__(self, layout: Layout, words: NDArray[np.int64]) -> None:
        self._layout, self._words = layout, words

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name not in self._layout.types:
            raise AttributeError(f"{self._layout.name} has no {name!r}")
        kind, axes = self._layout.types[name]
        begin = WORDS * list(self._layout.types).index(name)
        place, *shape = self._words[begin : begin + 1 + axes]
        return array_at(place, tuple(shape), kind)
