"""Trees of rigid bodies in as many coordinates as they have degrees of freedom, for speed.

tree        Scene -> Tree: joints and bodies in order, and the bed that the engine would get, as records for the kernels
space_tree  the same in space, loaded for a model with `in_space` alone
march       Tree -> arrays of kernels that go through time
solve       the march -> Trajectory of the engine, which is read by the engine's own observer

Equations: `kernels.tree`, in space `kernels.space_tree`; steps: `kernels.tree_newton`. The scheme, the choice of steps,
Newton's iterations, the medium with its bristles and what acts in joints are those of the engine.
"""
