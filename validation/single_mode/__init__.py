"""Parts of the study `single_mode_vs_fe.py`."""
