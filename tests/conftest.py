"""Settings that must precede the import of any kernel: path of the checkout, cache of compiled kernels, test order."""

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

# Bytecode is written even if the environment forbids it, as containers often do. Otherwise each worker, and each
# process that a test starts, would compile every module of every library again, which takes seconds.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# numba invalidates a cached function only when the function's own file changes, not when the file of an inlined
# function changes: after a change in plates.py it would still run the old code inlined into lines.py. So the name of
# the cache folder holds a hash of all kernels, all laws and numba's version; subprocesses inherit the folder.
from granular_contact.jit import compiled_sources  # noqa: E402  # does not import numba, which reads NUMBA_CACHE_DIR at import

_kernels = b"".join(path.read_bytes() for path in compiled_sources())
_digest = hashlib.sha256(_kernels + version("numba").encode()).hexdigest()[:16]
_folder = Path(tempfile.gettempdir()) / f"granular-contact-{getpass.getuser()}-{_digest}"
os.environ.setdefault("NUMBA_CACHE_DIR", str(_folder))

# Test files that run first; an idle worker takes the next one. The first file compiles the kernels that most files
# need. The next files need few kernels, or other ones, so that two workers do not compile the same kernels at the same
# time. The longest files follow, so that none of them is left for a single worker at the end.
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
    # Files of which every test is slow:
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
    """Run the files of `FIRST` before the others; tests of a file stay together and in order."""
    places = {name: i for i, name in enumerate(FIRST)}
    items.sort(key=lambda item: places.get(item.path.name, len(FIRST)))


# Hypothesis draws the same examples on every machine, so that only a change of the code makes a test fail. For new
# examples: --hypothesis-profile=seek.
settings.register_profile("fixed", derandomize=True)
settings.register_profile("seek", print_blob=True)
settings.load_profile("fixed")
# Hypothesis also draws numbers that it finds in the source of every loaded module. Reading them takes seconds, and a
# change of an unrelated file, or of the order of tests, would change the examples.
with suppress(ImportError):  # older versions draw no such numbers
    from hypothesis.internal.conjecture import providers

    if hasattr(providers, "_get_local_constants"):
        providers._get_local_constants = providers.Constants
