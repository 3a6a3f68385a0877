"""Trees of rigid bodies in minimal coordinates, one for each degree of freedom, for speed.

tree        Scene -> Tree: joints and bodies in order, and the granular load, as records for the kernels
space_tree  the same in space; loaded only for a model with `in_space`
march       Tree -> arrays of a march through time, which calls the kernels
solve       march -> Trajectory in the coordinates of the engine, for the observer of the engine

Equations: `kernels.tree`, in space `kernels.space_tree`; steps: `kernels.tree_newton`. The time scheme, the choice of
steps, Newton's iterations, the medium with its bristles, and the laws of joints are those of the engine.
"""
