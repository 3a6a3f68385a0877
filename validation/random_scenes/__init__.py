"""Random scenes as users might write them, for `properties.py`; their mirror images, shifts and finer runs."""
