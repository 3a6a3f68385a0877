"""The package uses public parts of numba and LLVM, but for those listed in docs/architecture.md."""

from __future__ import annotations

from test_imports import MODULES, ROOT, ids, imports, wrong

PRIVATE = ("numba.core", "numba.np", "numba.cpython", "numba.typed", "numba.experimental", "llvmlite", "_")
ALLOWED = {
    "jit/compiling.py": {"numba.core", "numba.core.event"},
    "jit/calls.py": {"llvmlite", "llvmlite.ir"},
    "jit/layout.py": {"numba.core.typing.templates", "numba.core.typing.templates.AttributeTemplate"},
    "jit/memory.py": {"llvmlite", "llvmlite.ir"},
}


def private(path):  # type: ignore[no-untyped-def]
    """What a module imports of others that begins with a name from above."""
    modules = {name for name in imports(path) if name.startswith(PRIVATE) and not name.startswith("__future__")}
    return modules - ALLOWED.get(ids(path), set())


def test_no_private_part_of_numba_or_python_is_imported() -> None:
    assert wrong(private) == {}


def test_private_parts_in_use_are_listed_in_the_docs() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    table = page.split("## Parts of other libraries that are not public")[1].split("\n## ")[0]
    for module in ALLOWED:
        assert module in table


def test_every_exception_is_used() -> None:
    used = {ids(path): imports(path) & ALLOWED[ids(path)] for path in MODULES if ids(path) in ALLOWED}
    assert used == ALLOWED
