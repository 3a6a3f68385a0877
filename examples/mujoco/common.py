"""Arguments of the examples, the loop over steps, and a film, if MuJoCo can draw without a display."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco

FRAMES = 25  # per second


def run(model: Any, bed: Any, control: Callable[[Any], None], seconds: float, camera: str = "side") -> Any:
    """Step the model in its bed for some seconds, or for those of --seconds; return its data at the end."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=seconds)
    parser.add_argument("--step", type=float, default=model.opt.timestep, help="time step (s)")
    parser.add_argument("--video", type=Path, help="film to write, a GIF")
    given = parser.parse_args()
    model.opt.timestep = given.step
    film = Film(model, given.video, camera) if given.video else None
    data = mujoco.MjData(model)
    while data.time < given.seconds:
        control(data)
        bed.apply(data)
        mujoco.mj_step(model, data)
        if film is not None:
            film.add(data)
    bed.apply(data)
    if film is not None:
        film.write()
    return data


class Film:
    """A film drawn by MuJoCo's renderer, which needs EGL or OSMesa if there is no display."""

    def __init__(self, model: Any, path: Path, camera: str) -> None:
        self.path, self.camera = path, camera
        self.frames: list[Any] = []
        self.renderer: Any = None
        if not {"DISPLAY", "MUJOCO_GL"} & os.environ.keys() and sys.platform == "linux":
            print("no film: there is no display; where EGL or OSMesa is, MUJOCO_GL=egl or osmesa draws without one")
            return
        try:
            self.renderer = mujoco.Renderer(model, 540, 960)
        except Exception as error:  # of the graphics library, whichever it is
            print(f"no film: MuJoCo's renderer can't start here: {str(error).splitlines()[0]}")

    def add(self, data: Any) -> None:
        """Add a frame if the next one is due."""
        if self.renderer is not None and data.time * FRAMES >= len(self.frames):
            self.renderer.update_scene(data, self.camera)
            self.frames.append(self.renderer.render())

    def write(self) -> None:
        """Write the film."""
        if self.renderer is None:
            return
        from PIL import Image

        images = [Image.fromarray(frame) for frame in self.frames]
        images[0].save(self.path, save_all=True, append_images=images[1:], duration=1000 // FRAMES, loop=0)
        print(f"{self.path}: {len(images)} frames")
