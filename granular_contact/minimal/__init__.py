"""Trees of rigid bodies in as many coordinates as they have degrees of freedom, for speed.

tree      Scene -> Tree: joints and bodies in order, and the bed that the engine would get, as records for the kernels
signals   signals of drives -> tables that the kernels look them up in
solve     Tree -> Trajectory of the engine, which is read by the engine's own observer

Equations: `kernels.tree`; steps: `kernels.chebyshev`; the medium is that of the engine, bristles included, and what
acts in joints, too.
"""
