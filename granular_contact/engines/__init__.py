"""Engines: each builds a system of a scene, solves it, and returns an observation. No engine imports another.

exudyn   any mechanism, in the redundant coordinates of the engine Exudyn
tree     trees of rigid bodies in minimal coordinates: one coordinate per degree of freedom
modal    the pendulum in modal coordinates
mujoco   no engine of scenes: the granular bed in a MuJoCo model of the user

The room of an engine of scenes provides three things. `run.begin` puts them together; docs/howto/extend.md lists the
other files to edit.

1. Builder, `Scene` -> system: the mechanism in the coordinates of the engine, with the load of `sand` on all shapes
   that can reach the surface. In each iteration the engine gives the load its coordinates and velocities and takes over
   the forces of the medium. At the end of each accepted step it tells the load so, once: friction state, work and
   history advance there and nowhere else. A step that is rejected and repeated leaves no trace in the load.
2. Class `Solve` in `solve.py`, with the methods of `run.Solving`: `advance` integrates to a given time; `observe`,
   `outlines`, `state` and `restore` serve pauses; `trajectory` and `status` tell the result. A run is one call of
   `advance`; a `Simulation` makes one call per pause. If controllers may set drives, `Solve` also has
   `set_to(joint, value)`, in the units and with the sign of the scene's drives.
3. Function, trajectory -> `results.observation.Observation`. `System.observe` (`mechanics.system`) is that function for
   a trajectory in the coordinates of a `System`.
"""
