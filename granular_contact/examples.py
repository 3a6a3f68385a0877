"""Shipped models and configs: find them by name, and write them into a folder where a user can change them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

PACKAGE = Path(__file__).parent
FOLDERS = ("models", "configs")
ENDINGS = (".yaml", ".csv", ".txt", ".urdf", ".stl")  # (.txt: licences of data)


def home() -> Path:
    """The folder that contains the folders of models and configs; for an editable install the checkout.

    Raises
    ------
    FileNotFoundError
        The package was installed without models.
    """
    folder = next((place for place in (PACKAGE, PACKAGE.parent) if (place / FOLDERS[0]).is_dir()), None)
    if folder is None:
        raise FileNotFoundError(f"no models in {PACKAGE}: this installation is incomplete")
    return folder


def config(name: str) -> Path | None:
    """Path of the shipped config with this name, as `runner` or `runner.yaml`; None if there is none."""
    folder = home() / FOLDERS[1]
    path = folder / (name if name.endswith(".yaml") else f"{name}.yaml")
    return path if path.parent == folder and path.is_file() else None


def named(path: Path, folder: Path | None = None) -> Path:
    """The file at `path` (relative to `folder`) if it exists, else the shipped config of this name if there is one.

    If neither exists, the path of the missing file is returned.
    """
    file = path if folder is None else folder / path
    if file.exists() or path.name != str(path):
        return file
    return config(path.name) or file


def config_names() -> list[str]:
    """Names of the shipped configs."""
    return sorted(path.stem for path in (home() / FOLDERS[1]).glob("*.yaml"))


def shipped() -> dict[str, bytes]:
    """Contents of all shipped files by relative path, for example `configs/pendulum.yaml`; raises as `home`."""
    top = home()
    files = [path for folder in FOLDERS for path in sorted((top / folder).rglob("*")) if path.suffix in ENDINGS]
    return {path.relative_to(top).as_posix(): path.read_bytes() for path in files}


def write(directory: Path, further: Mapping[str, bytes] | None = None) -> list[str]:
    """Write all shipped files into a folder.

    Parameters
    ----------
    directory : Path
        The folder; it is made if it does not exist.
    further : mapping from str to bytes, optional
        Contents of other files to write, by relative path.

    Returns
    -------
    list of str
        Relative paths of all files.

    Raises
    ------
    FileExistsError
        Files with these names and another content exist. The message names them, and no file is written.
    OSError
        A file can't be written.
    """
    files = {**shipped(), **(further or {})}
    conflicts = [name for name, content in files.items() if _differs(directory / name, content)]
    if conflicts:
        rest = f" and {len(conflicts) - 3} more" if len(conflicts) > 3 else ""
        listed = f"{', '.join(conflicts[:3])}{rest}"
        raise FileExistsError(f"{listed} in {directory} would be overwritten: give another folder")
    for name, content in files.items():
        path = directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists():
            path.write_bytes(content)
    return list(files)


def _differs(path: Path, content: bytes) -> bool:
    """Whether a path exists and is no file with this content."""
    return path.exists() and not (path.is_file() and path.read_bytes() == content)
