"""Random scenes that a user might write, for `properties.py`; their mirror images, shifts and finer runs."""
