"""Write pictures as a film: GIF by Pillow, MP4 by the program ffmpeg."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from importlib.util import find_spec
from itertools import chain
from pathlib import Path

import numpy as np
from PIL import Image

from granular_contact.report.figures import animation, rendering
from granular_contact.report.figures.animation import STEEL, STEEL_EDGE, TRACE, Picture
from granular_contact.report.figures.style import INK, VERMILION
from granular_contact.results import Results
from granular_contact.results.frames import RATE

COLOURS = 96  # colours of a GIF, in addition to OURS, which are kept even if few pixels have them
OURS = (VERMILION, INK, *STEEL, STEEL_EDGE, TRACE, "#FFFFFF")
LAST = 1600  # ms: time of the last picture of a GIF before it repeats


def write(results: Results, file: Path) -> None:
    """Write the frames of results as a film.

    Parameters
    ----------
    results : Results
        Results with frames.
    file : Path
        The file; its ending is .gif or .mp4.

    Raises
    ------
    OSError
        The file cannot be written, or ffmpeg is missing or fails.
    """
    make = rendering.pictures if _in_space(results) and rendering.works() else animation.pictures
    _WRITERS[file.suffix](make(results), file)


_SIDE_VIEW = "the film shows the side view, each part by its convex outline (a C-leg is filled)"


def why_flat(results: Results) -> str:
    """Reason why the film of a run in space is not shaded; empty if it is shaded, and for a run in the plane."""
    if not _in_space(results) or rendering.works():
        return ""
    if find_spec("pyvista") is None:
        return f"{_SIDE_VIEW}; pip install 'granular-contact[render]' for shaded pictures"
    return f"{_SIDE_VIEW}, as pyvista can't draw here (it needs OpenGL)"


def _in_space(results: Results) -> bool:
    return results.motion is not None and results.motion.in_space and bool(results.motion.parts)


def _gif(film: Iterator[Picture], file: Path) -> None:
    """Write a GIF with one palette for all pictures, so that each stores only changes."""
    kept = list(film)
    colours = palette(kept)
    frames = (Image.fromarray(picture).quantize(palette=colours, dither=Image.Dither.NONE) for picture in kept)
    durations = [1000 // RATE] * (len(kept) - 1) + [LAST]
    next(frames).save(file, save_all=True, append_images=frames, duration=durations, loop=0, disposal=1)


def palette(kept: list[Picture]) -> Image.Image:
    """Palette of the colours of the style and colours chosen from pictures of the whole film."""
    samples = [kept[i] for i in np.unique(np.linspace(0, len(kept) - 1, 6).astype(int))]
    quantised = Image.fromarray(np.concatenate(samples)).quantize(COLOURS, dither=Image.Dither.NONE)
    ours = [int(colour[i : i + 2], 16) for colour in OURS for i in (1, 3, 5)]
    colours = ours + (quantised.getpalette() or [])[: 3 * COLOURS]
    image = Image.new("P", (1, 1))
    image.putpalette(colours + colours[:3] * (256 - len(colours) // 3))
    return image


def ffmpeg() -> str | None:
    """Path of the program ffmpeg; None if it is not installed."""
    return shutil.which("ffmpeg")


def _mp4(film: Iterator[Picture], file: Path) -> None:
    """Write an MP4 (H.264), in a pixel format that every player supports."""
    program = ffmpeg()
    if program is None:
        raise OSError("an MP4 needs ffmpeg, which is not on the path; a GIF does not need it")
    first = next(film)
    height, width, _ = first.shape
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(RATE), "-i", "-"]
    coded = ["-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4"]
    command = [program, "-y", "-loglevel", "error", *raw, *coded, str(file)]
    done = subprocess.run(command, input=b"".join(p.tobytes() for p in chain([first], film)), capture_output=True)
    if done.returncode:
        reason = done.stderr.decode(errors="replace").strip().splitlines()
        raise OSError(f"ffmpeg could not make {file.name}: {reason[-1] if reason else done.returncode}")


_WRITERS = {".gif": _gif, ".mp4": _mp4}
