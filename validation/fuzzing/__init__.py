"""Random input for `fuzz.py`: complete scenarios, damaged files, and the judgement of their outcomes."""
