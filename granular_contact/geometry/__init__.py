"""Points and lines in the plane, of no body in particular."""
