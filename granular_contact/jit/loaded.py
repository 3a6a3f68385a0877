"""Imported in advance by the server that worker processes are forked from: what numba loads with its first kernel.

These are its tables of types and functions, the same for all kernels; loading them takes as long as loading twenty
kernels from the disk. Numba loads them with whatever it compiles first.
"""

from numba import njit

njit("void()")(lambda: None)
