"""Trees of rigid bodies on hinges in as many coordinates as they have hinges, for speed.

tree      Scene -> Tree: bodies in order, and the bed that the engine would get, as records for the kernels
solve     Tree -> Trajectory of the engine, which is read by the engine's own observer

Equations: `kernels.tree`; steps: `kernels.chebyshev`; the medium is that of the engine, bristles included.
"""
