"""Values of all files: `strict` base classes, plain YAML `scalars`, and `files` that are written as a whole.

`arrays` has types for annotations.
"""
