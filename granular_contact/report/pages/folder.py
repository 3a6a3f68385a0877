"""Read a results folder on the disk, with checks for damaged files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from granular_contact.config.csv_table import parse_table, ragged_rows
from granular_contact.config.yaml_source import read_text
from granular_contact.errors import Fault, ResultsError
from granular_contact.report import ENTRIES, FIGURES, MOTION, kind_of
from granular_contact.report.units import Array, is_number
from granular_contact.results.motion import Motion, of_plain


class FolderError(ResultsError):
    """The folder contains no results, or files that can't be read; the message names the file and the fault."""


Rows = list[list[Any]]
# Types of the entries of JSON files that pages use.
_OBJECT, _LIST = (dict, "an object"), (list, "a list")
_TYPES: dict[str, tuple[type, str]] = {
    "warnings": _LIST,
    **dict.fromkeys(("energy", "contacts", "columns", "cost", "versions"), _OBJECT),
}


class Table(NamedTuple):
    """A CSV file: headings, and rows with cells as numbers, texts, or None for empty cells."""

    head: list[str]
    rows: Rows

    def column(self, name: str) -> list[Any]:
        """Cells of a column."""
        i = self.head.index(name)
        return [row[i] for row in self.rows]

    def numbers(self, name: str) -> Array:
        """Numbers (rows,) of a column; NaN for cells that are not numbers."""
        return np.array([value if is_number(value) else np.nan for value in self.column(name)], dtype=float)

    def of(self, names: Sequence[str]) -> Rows:
        """Rows restricted to the given columns."""
        indices = [self.head.index(name) for name in names]
        return [[row[i] for i in indices] for row in self.rows]


@dataclass(frozen=True)
class Bed:
    """Surface (m, or corners (k, 2) m; None in vacuum), depths of layers (m) and height of the floor (m) of a bed."""

    surface: float | Array | None = None
    layers: tuple[float, ...] = ()
    floor: float | None = None

    def scaled(self, factor: float) -> Bed:
        """Return the bed with all lengths multiplied by a factor."""
        surface = None if self.surface is None else factor * np.asarray(self.surface)
        floor = None if self.floor is None else factor * self.floor
        return Bed(surface, tuple(factor * depth for depth in self.layers), floor)


@dataclass(frozen=True)
class Folder:
    """A results folder and its kind, a key of `report.ENTRIES`."""

    path: Path
    kind: str
    _tables: dict[str, Table] = field(default_factory=dict, init=False, repr=False, compare=False)

    def has(self, name: str) -> bool:
        """Return whether the folder has a file of this name."""
        return (self.path / name).is_file()

    def file(self, name: str) -> Path:
        """Path of a file; FolderError if it does not exist."""
        if not self.has(name):
            raise FolderError(f"{self.path} has no {name}: it is not the complete folder of a {self.kind}")
        return self.path / name

    def read(self, name: str) -> dict[str, Any]:
        """Content of a JSON file that has to contain an object."""
        try:
            content = json.loads(self._text(name))
        except (ValueError, RecursionError) as error:
            raise FolderError(f"{self.path / name}: is not JSON: {error}") from None
        if not isinstance(content, dict):
            raise FolderError(f"{self.path / name}: is not a JSON object")
        for key, (kind, noun) in _TYPES.items():
            if not isinstance(content.get(key), kind | None):
                raise FolderError(f"{self.path / name}: {key} is not {noun}, as this program writes it")
        return content

    def table(self, name: str) -> Table:
        """Content of a CSV file, which is read only once."""
        if name not in self._tables:
            self._tables[name] = self._table(name)
        return self._tables[name]

    def _table(self, name: str) -> Table:
        faults: list[Fault] = []
        table = parse_table(self._text(name), str(self.path / name), faults)
        if table is not None:
            faults += ragged_rows(table)
        if table is None or faults:
            raise FolderError(str(faults[0]))
        return Table(list(table.header), [[_value(cell) for cell in row] for row in table.rows])

    def numbers(self, name: str) -> dict[str, Array]:
        """Columns (rows,) of a CSV file of numbers, by name."""
        file = self.file(name)
        try:
            with file.open(encoding="utf-8") as lines:
                head = lines.readline().rstrip("\n").split(",")
                rows = [line for line in lines if line.strip()]
                table = np.loadtxt(rows, delimiter=",", ndmin=2, comments=None) if rows else np.empty((0, len(head)))
        except (OSError, ValueError) as error:  # cells that are not numbers, or incomplete rows
            reason = str(getattr(error, "strerror", None) or error).partition("\n")[0]
            raise FolderError(f"{file}: can't be read as a table: {reason}") from None
        if not table.size:
            raise FolderError(f"{file}: has no rows")
        if table.shape[1] != len(head):
            raise FolderError(f"{file}: has {table.shape[1]} columns below {len(head)} headings")
        return dict(zip(head, table.T, strict=True))

    def text(self, name: str) -> str | None:
        """Text of a file; None if it does not exist. FolderError for YAML with a fault of syntax."""
        if not self.has(name):
            return None
        text, faults = self._text(name), list[Fault]()
        if name.endswith(".yaml"):
            read_text(text, str(self.path / name), faults)
        if faults:
            raise FolderError(str(faults[0]))
        return text

    def motion(self) -> Motion | None:
        """Motion of the mechanism; None if it was not saved."""
        return None if (saved := self.played()) is None else saved[0]

    def played(self) -> tuple[Motion, Bed] | None:
        """Motion of the mechanism and its bed; None if the motion was not saved."""
        if not self.has(MOTION):
            return None
        saved = self.read(MOTION)
        try:
            bed = saved.get("bed") or {}
            surface = bed.get("surface_m")
            corners = np.array(surface, float) if isinstance(surface, list) else surface
            return of_plain(saved), Bed(corners, tuple(bed.get("layers_m") or ()), bed.get("floor_m"))
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise FolderError(f"{self.path / MOTION}: is not a motion as this program writes it ({error!r})") from None

    def figures(self) -> list[Path]:
        """Paths of the figures, sorted by name."""
        return sorted((self.path / FIGURES).glob("*.png"))

    def _text(self, name: str) -> str:
        try:
            return self.file(name).read_text(encoding="utf-8")
        except UnicodeDecodeError:
            raise FolderError(f"{self.path / name}: is not text") from None
        except OSError as error:
            raise FolderError(f"{self.path / name}: can't be read: {error.strerror}") from None


def _value(cell: str) -> Any:
    try:
        number = float(cell)
    except ValueError:
        return cell or None
    return int(cell) if cell.lstrip("+-").isdecimal() else number


_BEGIN, _END = b"\x89PNG\r\n\x1a\n", b"IEND\xaeB`\x82"  # first and last bytes of a PNG


def picture(path: Path) -> bytes:
    """Content of a PNG file.

    Raises
    ------
    FolderError
        The file is incomplete, or not a PNG.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise FolderError(f"{path}: can't be read: {error.strerror}") from None
    if not content.startswith(_BEGIN) or not content.endswith(_END):
        fault = "is empty" if not content else "is cut short" if content.startswith(_BEGIN) else "is not a picture"
        raise FolderError(f"{path}: {fault}; repeat the command that wrote it, or remove it")
    return content


def open_folder(path: Path) -> Folder:
    """Open the results folder at a path.

    Raises
    ------
    FolderError
        The path is not a results folder.
    """
    if not path.is_dir():
        fault = "is a file" if path.exists() else "does not exist"
        raise FolderError(f"{path} {fault}; a folder of results is needed")
    kind = kind_of(path)
    if kind is None:
        kinds = "; ".join(f"{kind}: {', '.join(names)}" for kind, names in ENTRIES.items())
        raise FolderError(f"{path} is not a folder of results of one kind; the kinds and their files are: {kinds}")
    return Folder(path, kind)
