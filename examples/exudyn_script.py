"""A stick in an Exudyn script falls into play sand; three lines of the script make the sand."""

from __future__ import annotations

import exudyn as exu
from common import panels, save
from exudyn.itemInterface import LoadMassProportional, MarkerBodyMass, NodeRigidBody2D, ObjectRigidBody2D

from granular_contact import GranularBed, preset

mbs = exu.SystemContainer().AddSystem()
node = mbs.AddNode(NodeRigidBody2D(referenceCoordinates=[0, 0.15, -1.0], initialVelocities=[0.5, -2, 0]))
stick = mbs.AddObject(ObjectRigidBody2D(mass=0.1, inertia=6e-4, nodeNumber=node))
mass = mbs.AddMarker(MarkerBodyMass(bodyNumber=stick))
mbs.AddLoad(LoadMassProportional(markerNumber=mass, loadVector=[0, -9.81, 0]))

bed = GranularBed(mbs, preset("play_sand"), surface=0.0)
bed.add_rigid(stick, start=[-0.13, 0], end=[0.13, 0], diameter=0.008)
bed.attach()

mbs.Assemble()
settings = exu.SimulationSettings()
settings.solution.file.write = False
settings.timeIntegration.numberOfSteps = 2000
settings.timeIntegration.endTime = 0.4
mbs.SolveDynamic(settings)
print(f"carried by {bed.force[1]:.3f} N, dissipated {-bed.work:.4f} J, depth {1e3 * bed.history.depth[-1]:.2f} mm")

figure, (left, right) = panels(2)
left.plot(1e3 * bed.history.time, 1e3 * bed.history.depth)
left.set(xlabel="time (ms)", ylabel="depth (mm)")
right.plot(1e3 * bed.history.time, bed.history.bodies[:, 0, 1])
right.set(xlabel="time (ms)", ylabel="vertical force (N)")
save(figure)
