"""Journal of a sweep: rows stored on the disk as soon as they are computed, as JSON lines, one file per process.

A row is written by one system call. So a killed process leaves complete rows and at most one incomplete line, which is
ignored when the journal is read. A power failure can lose the rows of the last seconds.
"""

from __future__ import annotations

import json
import os
import re
import secrets
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from granular_contact.results import FINISHED

SYNC_SECONDS = 2.0  # interval between syncs; a sync takes milliseconds, about as long as a case
_ENDING = ".jsonl"
_START = re.compile(rb'{"index": (\d+), ')


@dataclass(frozen=True)
class Row:
    """Result of a case. values: of the varied keys; summary: flat, by dotted key, at least `status` and `message`."""

    index: int
    name: str
    values: dict[str, Any]
    summary: dict[str, Any]

    @property
    def failed(self) -> bool:
        """Whether the case did not end regularly."""
        return self.summary["status"] not in FINISHED

    @property
    def useless(self) -> bool:
        """Whether the case ended regularly with a result that is not usable."""
        return not self.failed and self.summary.get("usable") is False

    def line(self) -> bytes:
        """The row as a line of JSON; raises TypeError for values that are not plain data."""
        return (json.dumps(vars(self), ensure_ascii=False, default=_plain) + "\n").encode()

    @staticmethod
    def of(line: bytes) -> Row:
        """The row of a complete line of a journal.

        Parameters
        ----------
        line : bytes
            A line as `line` returns it.

        Returns
        -------
        Row

        Raises
        ------
        ValueError
            The line is no complete JSON.
        """
        return Row(**json.loads(line))


class Writer:
    """Appends rows to a new file in a folder."""

    def __init__(self, folder: Path) -> None:
        path = folder / f"{os.getpid()}-{secrets.token_hex(4)}{_ENDING}"
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
        self._end, self._synced = 0, time.monotonic()
        self._lock = threading.Lock()

    def append(self, line: bytes) -> None:
        """Write the complete line of a row.

        Raises
        ------
        OSError
            The line cannot be written; the file then ends with the row before it.
        """
        with self._lock:
            try:
                written = os.write(self._file, line)
                while written < len(line):
                    written += os.write(self._file, line[written:])
            except OSError:
                os.ftruncate(self._file, self._end)
                os.lseek(self._file, self._end, os.SEEK_SET)
                raise
            self._end += len(line)
            if time.monotonic() - self._synced > SYNC_SECONDS:
                os.fsync(self._file)
                self._synced = time.monotonic()

    def close(self) -> None:
        """Close the file."""
        os.close(self._file)


class Journal:
    """The rows in a folder of journal files, one per case, in the order of the sweep; read again at each iteration."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def writer(self) -> Writer:
        """Return a writer for this process."""
        return Writer(self.folder)

    def done(self) -> set[int]:
        """Indices of the cases that have a row."""
        return set(self._places())

    def __len__(self) -> int:
        return len(self._places())

    def __iter__(self) -> Iterator[Row]:
        places = self._places()
        files = {path: path.open("rb") for path in {path for path, _ in places.values()}}
        try:
            for index in sorted(places):
                path, offset = places[index]
                files[path].seek(offset)
                yield Row.of(files[path].readline())
        finally:
            for file in files.values():
                file.close()

    def _places(self) -> dict[int, tuple[Path, int]]:
        """File and offset of each row, by index of its case."""
        places: dict[int, tuple[Path, int]] = {}
        for path in sorted(self.folder.glob(f"*{_ENDING}")):
            offset = 0
            with path.open("rb") as file:
                for line in file:
                    if (index := _index(line)) is not None:
                        places.setdefault(index, (path, offset))
                    offset += len(line)
        return places


def _index(line: bytes) -> int | None:
    """Index of the case of a line, which is the first entry of its row; None for an incomplete line."""
    start = _START.match(line)
    return int(start[1]) if start and line.endswith(b"}\n") else None


def _plain(value: Any) -> Any:
    """Convert scalars of NumPy to those of Python."""
    if hasattr(value, "item"):
        return value.item()
    raise TypeError(f"{type(value).__name__} is not plain data")
