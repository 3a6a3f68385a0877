"""Arrays that nobody counts the references of, for the time of a call.

Numba counts who refers to an array by an instruction that all cores wait for, with every slice and every call that it
goes through: half the time of a load on a few strips.
"""

from __future__ import annotations

from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

from granular_contact.kernels.memory import _contiguous, _view


@intrinsic
def borrowed(typing_context, array):
    """The array itself, of one that outlives it, as an argument does."""
    _contiguous(array)

    def generate(context, builder, signature, values):
        given = make_array(array)(context, builder, values[0])
        shape = cgutils.unpack_tuple(builder, given.shape)
        return _view(context, builder, array, given, cgutils.intp_t(0), shape)

    return array(array), generate
