"""Robot files (URDF): read them with the lines of their elements, check them, mend them.

source      file -> XML, without entities or network, as tolerantly as other readers of robot files
elements    numbers and texts of XML elements, with their faults
types       robot, links, joints, shapes and poses, as frozen plain data
links       `<link>` and `<joint>`
urdf        XML -> a robot whose links and joints form one tree
inertia     possible inertia tensors; rotating, moving and combining them
massless    links without mass merged into bodies; joints that mechanisms do not support
files       paths of mesh files, also by `package://`
surfaces    shapes -> triangles
inspection  flaws of the meshes and bodies of a robot, as a table and sentences
mending     a copy of a robot file with closed meshes and possible inertias
mending_mesh   repairs of meshes, those that change least first
mechanism   a robot -> the config of a mechanism in space; `config/urdf.py` puts it into a scenario
"""
