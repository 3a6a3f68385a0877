"""Size of the package in lines of code, and the lines of the functions that a run enters.

    python validation/house.py [--files 15] [--small] [--run configs/pendulum.yaml]

A line of code is a line that is neither blank nor part of a comment or a docstring (also of an attribute). The script
prints the rooms (folders) with their files and lines, the longest files, functions with more than ten arguments, and
the lines of the functions that a run enters. Compiled functions count only with `NUMBA_DISABLE_JIT=1`.
`--small` lists files below 75 lines that only one other module imports.
"""

from __future__ import annotations

import argparse
import ast
import contextlib
import io
import os
import sys
import tempfile
import tokenize
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, FrameType

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from validation.tables import markdown

PACKAGE = ROOT / "granular_contact"
LONGEST, MOST_ARGUMENTS, SMALL = 340, 10, 75
_NO_CODE = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}


@dataclass(frozen=True)
class File:
    """A file of the package: numbers of its lines of code, and its functions with too many arguments."""

    path: Path
    code: frozenset[int]
    many_arguments: tuple[tuple[str, int], ...]

    @property
    def lines(self) -> int:
        """Number of all lines."""
        return len(self.path.read_text(encoding="utf-8").splitlines())

    @property
    def room(self) -> str:
        """Folder of the file, to at most two levels below the package."""
        return "/".join(self.path.relative_to(PACKAGE).parts[:-1][:2]) or "."


def code_lines(source: str) -> frozenset[int]:
    """Numbers of the lines that are neither blank nor part of a comment or a docstring."""
    docstrings: set[int] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            docstrings.update(range(node.lineno, (node.end_lineno or 0) + 1))
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in _NO_CODE:
            lines.update(range(token.start[0], token.end[0] + 1))
    return frozenset(lines - docstrings)


def many_arguments(source: str) -> Iterator[tuple[str, int]]:
    """Names of functions with more than `MOST_ARGUMENTS` arguments, and their number of arguments."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            count = len(node.args.posonlyargs) + len(node.args.args) + len(node.args.kwonlyargs)
            if count > MOST_ARGUMENTS:
                yield node.name, count


def files() -> list[File]:
    """All Python files of the package."""
    listed = []
    for path in sorted(PACKAGE.rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        listed.append(File(path, code_lines(source), tuple(many_arguments(source))))
    return listed


def entered(action: Callable[[], object]) -> list[CodeType]:
    """Functions of the package that are entered while an action runs, without bodies of modules and classes."""
    codes: set[CodeType] = set()
    package = str(PACKAGE) + os.sep

    def note(frame: FrameType, event: str, _: object) -> None:
        if event == "call":
            codes.add(frame.f_code)

    sys.setprofile(note)
    try:
        action()
    finally:
        sys.setprofile(None)
    return [code for code in codes if code.co_filename.startswith(package) and code.co_flags & 0x2]  # CO_NEWLOCALS


def lines_of(codes: list[CodeType], code_of: dict[str, frozenset[int]]) -> int:
    """Number of lines of code in functions, each line counted once."""
    lines = set()
    for code in codes:
        numbers = [line for *_, line in code.co_lines() if line]
        lines.update((code.co_filename, line) for line in range(code.co_firstlineno, max(numbers) + 1))
    return sum(line in code_of.get(name, ()) for name, line in lines)


def readers(house: list[File]) -> dict[Path, set[Path]]:
    """Modules of the package that import a module, by path of the module."""
    names = {".".join(f.path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): f.path for f in house}
    importers: dict[Path, set[Path]] = {f.path: set() for f in house}
    for file in house:
        base = file.path.relative_to(ROOT).parts[:-1]
        for node in ast.walk(ast.parse(file.path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom):
                stem = list(base[: len(base) - node.level + 1]) if node.level else []
                module = ".".join([*stem, *([node.module] if node.module else [])])
                for name in [module, *(f"{module}.{alias.name}" for alias in node.names)]:
                    if name in names and names[name] != file.path:
                        importers[names[name]].add(file.path)
    return importers


def small_with_one_reader(house: list[File]) -> list[tuple[File, Path]]:
    """Files below `SMALL` lines that only one other module imports, and that module."""
    by_path = readers(house)
    small = [f for f in house if len(f.path.read_text("utf-8").splitlines()) < SMALL and len(by_path[f.path]) == 1]
    return [(f, next(iter(by_path[f.path]))) for f in small if f.path.name != "__init__.py"]


def rooms(house: list[File]) -> str:
    """Table of the rooms: files and lines of code."""
    count, lines = Counter(f.room for f in house), Counter[str]()
    for file in house:
        lines[file.room] += len(file.code)
    rows = [(room, count[room], lines[room]) for room in sorted(count)]
    return markdown(("room", "files", "lines of code"), [*rows, ("all", len(house), sum(lines.values()))])


def of_run(config: str, house: list[File]) -> str:
    """Sentence with the number of functions and lines that a run from the command line enters."""
    from granular_contact.cli import main

    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        codes = entered(lambda: main(["run", config, "--out", str(Path(folder) / "out")]))
    lines = lines_of(codes, {str(f.path): f.code for f in house})
    return f"`run {config}` enters {len(codes)} functions with {lines} lines of code."


def main() -> None:
    """Print all tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", type=int, default=15, help="how many of the longest files to print")
    parser.add_argument("--small", action="store_true", help="list small files with one reader")
    parser.add_argument("--run", metavar="CONFIG", help="count the functions that a run of this config enters")
    chosen = parser.parse_args()
    house = files()
    print(rooms(house))
    longest = sorted(house, key=lambda file: -len(file.code))
    print(f"\n{sum(len(file.code) > LONGEST for file in house)} files above {LONGEST} lines of code; the longest:\n")
    rows = [(f.path.relative_to(PACKAGE), len(f.code), f.lines) for f in longest[: chosen.files]]
    print(markdown(("file", "lines of code", "all lines"), rows))
    many = [(f.path.relative_to(PACKAGE), name, n) for f in house for name, n in f.many_arguments]
    print(f"\n{len(many)} functions of more than {MOST_ARGUMENTS} arguments.")
    small = small_with_one_reader(house)
    print(f"{len(small)} files below {SMALL} lines with one reader.")
    if chosen.small:
        print(markdown(("file", "read by"), [(f.path.relative_to(PACKAGE), r.relative_to(PACKAGE)) for f, r in small]))
    if chosen.run:
        print(of_run(chosen.run, house))


if __name__ == "__main__":
    main()
