"""Values of all files: `strict` classes, and the meaning of plain YAML `scalars`."""
