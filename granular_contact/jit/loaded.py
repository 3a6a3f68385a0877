"""Load what numba loads with its first kernel; imported in advance by the server that forks worker processes.

These are numba's tables of types and functions, the same for all kernels; loading them takes as long as loading twenty
kernels from the disk. Numba loads them with the first function that it compiles.
"""

from numba import njit

njit("void()")(lambda: None)
