"""Properties that every scene in space must have, on random scenes: as in `properties`, and rotation about a vertical.

    python validation/properties_in_space.py [--quick] [--count 1000] [--seed 0] [--jobs 2] [--store DIR] [--keep DIR]

The scenes of `random_scenes.in_space` have bodies of every shape, meshes, chains on hinges and ball joints, sliders,
legs and wheels, with drives; laws of surfaces, bars and balls; and beds that are level, sloped, given by a height map,
layered or with a floor. The finer run has facets of a third of the size that the first run chose.
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
    """Run all scenes; quick: the beginnings of the first ones."""
    return outcome(every(range(QUICK if quick else COUNT), cores(), quick, world="space"), NAME)


if __name__ == "__main__":
    sys.exit(main(world="space", of=NAME))
