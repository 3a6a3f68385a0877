"""What must hold of every scene in space, on random ones: as `properties`, and turned about the vertical.

    python validation/properties_in_space.py [--quick] [--count 1000] [--seed 0] [--jobs 2] [--store DIR] [--keep DIR]

Scenes of `random_scenes.in_space`: bodies of every shape, meshes, chains on hinges and balls, sliders, legs, wheels,
with drives, in laws of surfaces, bars and balls, on beds that are level, sloped, a map of heights, layered or with a
floor. Finer in space are facets of a third of the size that the run chose.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact.studies.processes import cores
from validation.properties import COUNT, QUICK, every, main, outcome
from validation.study import Outcome

NAME = "properties_in_space"


def study(quick: bool = False) -> Outcome:
    """All scenes, or the first few."""
    return outcome(every(range(QUICK if quick else COUNT), cores(), quick, world="space"), NAME)


if __name__ == "__main__":
    sys.exit(main(world="space", of=NAME))
