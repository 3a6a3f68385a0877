"""Robot files (URDF): read with the lines of their elements, checked, mended.

source      the file -> XML, without entities or network, as tolerantly as other readers of robot files
elements    numbers and texts of XML elements, with their faults
types       what a robot is made of
links       `<link>` and `<joint>`
urdf        XML -> a robot, and whether its links and joints form one tree
inertia     whether a tensor is that of a body; turning and moving it
massless    links without mass become part of what they are fixed to; joints that no mechanism here can have
files       where a mesh file is, `package://` too
surfaces    its shapes -> triangles
inspection  what is wrong with the meshes and bodies of a robot, as a table and sentences
mending     a copy of a robot file with closed meshes and inertias that bodies can have
mending_mesh   cures of meshes, those that change least first
mechanism   a robot -> what a config says of a mechanism in space; `config/urdf.py` puts it in place
"""
