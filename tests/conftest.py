"""What every test needs before anything of the package is imported: the checkout itself, and fresh compiled kernels."""

from __future__ import annotations

import getpass
import hashlib
import os
import sys
import tempfile
from pathlib import Path

from hypothesis import settings

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

# numba looks only at the file of the function that it loads from its cache, not at the files of those which were
# inlined into it: after a change in plates.py it would still run the old one out of lines.py. So the cache is named
# after the contents of all kernels and laws; subprocesses inherit it.
_kernels = sorted(path for name in ("kernels", "laws") for path in (ROOT / "granular_contact" / name).rglob("*.py"))
_digest = hashlib.sha256(b"".join(path.read_bytes() for path in _kernels)).hexdigest()[:16]
_folder = Path(tempfile.gettempdir()) / f"granular-contact-{getpass.getuser()}-{_digest}"
os.environ.setdefault("NUMBA_CACHE_DIR", str(_folder))

# The same draws on every machine, so that a change alone turns a test red. New draws: --hypothesis-profile=seek.
settings.register_profile("fixed", derandomize=True)
settings.register_profile("seek", print_blob=True)
settings.load_profile("fixed")
