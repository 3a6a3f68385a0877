"""Values of all files: `strict` classes, the meaning of plain YAML `scalars`; `files` that are written as a whole.

Types of `arrays` are for annotations everywhere.
"""
