"""Random input for `fuzz.py`: complete scenarios, damaged files, and the judgement of what came of them."""
