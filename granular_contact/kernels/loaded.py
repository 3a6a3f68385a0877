"""Imported in advance by the server that worker processes are forked from: what numba loads with its first kernel.

These are its tables of types and functions, the same for all kernels; loading them takes as long as loading twenty
kernels from the disk.
"""

from numba.core.registry import cpu_target

cpu_target.typing_context.refresh()
cpu_target.target_context.refresh()
