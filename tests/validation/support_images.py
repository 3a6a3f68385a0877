"""Images of random scenes, such as mirrored and turned ones, for both worlds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from granular_contact.config import load_scenario
from granular_contact.scene import build
from validation.properties import WORLDS
from validation.random_scenes import images
from validation.random_scenes.scenes import Drawn, write


def built_images(scenes: Iterable[Drawn], world: str, folder: Path) -> Iterator[tuple[str, dict[str, Any], Drawn]]:
    """Name, tree and original of each image of the scenes; each is a scene that is built."""
    for scene in scenes:
        for name, image in WORLDS[world].images.items():
            try:
                tree = image(scene.tree)
            except images.NoImage:
                continue
            build(load_scenario(write(tree, folder)))
            yield name, tree, scene


def close(first: Any, second: Any, missing: Any = None) -> bool:
    """Whether trees have the same numbers but for round-off; missing: stands for keys that the second does not have."""
    if isinstance(first, dict):
        has_keys = missing is not None or first.keys() == second.keys()
        return has_keys and all(close(value, second.get(key, missing), missing) for key, value in first.items())
    if isinstance(first, list):
        return len(first) == len(second) and all(close(a, b, missing) for a, b in zip(first, second, strict=True))
    return bool(first == second or (isinstance(first, float) and abs(first - second) < 1e-9))
