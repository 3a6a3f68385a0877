"""What every test needs before any kernel is imported: the checkout itself, and fresh compiled kernels."""

from __future__ import annotations

import getpass
import hashlib
import os
import sys
import tempfile
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

import pytest
from hypothesis import settings

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

# Bytecode is kept, whatever the environment says (containers often forbid it): else each of the workers and of the
# processes that tests start would compile every module of every library anew, which takes seconds each.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# numba looks only at the file of the function that it loads from its cache, not at the files of those which were
# inlined into it: after a change in plates.py it would still run the old one out of lines.py. So the cache is named
# after the contents of all kernels and laws, and numba's version; subprocesses inherit it.
from granular_contact.jit import compiled_sources  # noqa: E402  # loads no numba, which reads the name as it begins

_kernels = b"".join(path.read_bytes() for path in compiled_sources())
_digest = hashlib.sha256(_kernels + version("numba").encode()).hexdigest()[:16]
_folder = Path(tempfile.gettempdir()) / f"granular-contact-{getpass.getuser()}-{_digest}"
os.environ.setdefault("NUMBA_CACHE_DIR", str(_folder))

# Files that begin, each the next that a worker without work takes: the first compiles the kernels that most files need,
# while the next ones need few, or others (both workers would compile the same at the same time). Then the longest, so
# that none of them is left over for one worker at the end.
FIRST = (
    "test_run.py",
    "test_static.py",
    "test_space_trees.py",
    "test_html.py",
    "test_mujoco_loops.py",
    "test_line_tangents.py",
    "test_bed.py",
    "test_readme.py",
    "test_compiling.py",
    "test_animation.py",
    "test_recovery.py",
    "test_gallery.py",
    "test_optimise.py",
    "test_examples.py",
    "test_drives.py",
    "test_stepping.py",
    "test_wheels.py",
    "test_sweep_resume.py",
    "test_imports.py",
    # Of those that are slow throughout:
    "test_mujoco_motion.py",
    "test_plots.py",
    "test_site.py",
    "test_blocks.py",
    "test_single_mode.py",
    "test_fuzz.py",
    "test_sweep_cluster.py",
    "test_studies_and_models.py",
    "test_without_the_compiler.py",
    "test_sweep.py",
    "test_fit_recovery.py",
    "test_numbers.py",
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the files of `FIRST` before the others; tests of a file stay together and in order."""
    places = {name: i for i, name in enumerate(FIRST)}
    items.sort(key=lambda item: places.get(item.path.name, len(FIRST)))


# The same draws on every machine, so that a change alone turns a test red. New draws: --hypothesis-profile=seek.
settings.register_profile("fixed", derandomize=True)
settings.register_profile("seek", print_blob=True)
settings.load_profile("fixed")
# Hypothesis also draws what stands as a number in any source loaded so far, which takes seconds to read: a change of an
# unrelated file, or of the order of tests, would change the draws.
with suppress(ImportError):  # (older ones draw no such numbers)
    from hypothesis.internal.conjecture import providers

    if hasattr(providers, "_get_local_constants"):
        providers._get_local_constants = providers.Constants
