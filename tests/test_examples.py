"""The examples: written from a checkout and from an installed wheel, ready to run, and never over a user's files."""

from __future__ import annotations

import contextlib
import io
import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import pytest
from support_runs import ROOT

from granular_contact import cli, examples
from granular_contact.cli import schema

PATTERNS = ("models/*.yaml", "configs/*.yaml")
SOURCES = sorted(p.relative_to(ROOT).as_posix() for pattern in PATTERNS for p in ROOT.glob(pattern))


@pytest.fixture(scope="module", autouse=True)
def _schemas_once() -> Iterator[None]:
    """The schemas that are written beside the examples are made once, which takes a second."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(schema, "files", cache(schema.files))
        yield


@pytest.fixture(scope="module")
def copied(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A folder with the examples, and what was said."""
    folder, out = tmp_path_factory.mktemp("examples") / "my sand", io.StringIO()
    with contextlib.redirect_stdout(out):
        assert cli.main(["examples", str(folder)]) == 0
    return folder, out.getvalue()


@pytest.mark.slow
def test_all_models_and_configs_are_written_and_say_what_next(copied: tuple[Path, str]) -> None:
    folder, out = copied
    written = {p.relative_to(folder).as_posix(): p for p in folder.rglob("*.*")}
    assert set(SOURCES) <= set(written)
    for name in SOURCES:
        assert written[name].read_bytes() == (ROOT / name).read_bytes()
    assert {path.suffix for path in written.values()} <= {".yaml", ".csv", ".json", ".txt", ".urdf", ".stl"}
    assert "models/hexapod/meshes/leg.stl" in written
    assert f"cd '{folder}'" in out
    assert "granular-contact run configs/pendulum.yaml" in out


def test_a_changed_file_is_never_overwritten_and_an_equal_one_is_fine(
    copied: tuple[Path, str], capsys: pytest.CaptureFixture[str]
) -> None:
    folder, _ = copied
    assert cli.main(["examples", str(folder)]) == 0
    mine = folder / "configs" / "pendulum.yaml"
    mine.write_text("mine")
    (folder / "configs" / "impact_22deg.yaml").unlink()
    capsys.readouterr()
    assert cli.main(["examples", str(folder)]) == 2
    assert capsys.readouterr().err.startswith("examples: configs/pendulum.yaml in ")
    assert mine.read_text() == "mine"
    assert not (folder / "configs" / "impact_22deg.yaml").exists()  # nothing half-written


def test_a_file_in_the_way_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "models").touch()
    assert cli.main(["examples", str(tmp_path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_an_installation_without_examples_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(examples, "PACKAGE", tmp_path / "nowhere")
    assert cli.main(["examples", str(tmp_path / "out")]) == 2
    assert not (tmp_path / "out").exists()


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel of the checkout, unpacked as pip does it."""
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(folder), str(ROOT)]
    if find_spec("hatchling") is not None:  # else it is had for this build alone, which takes seconds
        build.append("--no-build-isolation")
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(build, capture_output=True, text=True, env=environment)
    if done.returncode and "hatchling" in done.stderr:
        pytest.skip("the build backend can't be had here: no network")
    assert done.returncode == 0, done.stderr
    (packed,) = folder.glob("*.whl")
    with zipfile.ZipFile(packed) as archive:
        archive.extractall(folder / "site")
    return folder / "site"


@pytest.mark.slow
def test_an_installed_wheel_writes_all_files_without_a_checkout(wheel: Path, tmp_path: Path) -> None:
    """In a clean folder, with the unpacked wheel first on the path and no checkout in sight."""
    # One of each kind: whether all are right says test_cli_check.py. A fit would compile its law for this copy alone.
    # Without their own folder of models they find those of the package.
    code = """if True:
        import os, shutil, granular_contact
        from granular_contact.cli import main
        assert main(["examples", "out"]) == 0
        os.chdir("out")
        names = ("pendulum", "hexapod", "paper_cases", "optimise_c_leg")
        check = ["check", *(f"configs/{name}.yaml" for name in names)]
        assert main(check) == 0
        shutil.move("models", "elsewhere")
        assert main(check[:3]) == 0
        print(granular_contact.__file__)
    """
    environment = {**os.environ, "PYTHONPATH": str(wheel)}
    line = [sys.executable, "-c", code]
    done = subprocess.run(line, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    out = tmp_path / "out"
    shutil.move(out / "elsewhere", out / "models")
    assert set(SOURCES) <= {path.relative_to(out).as_posix() for path in out.rglob("*.yaml")}
    assert done.stdout.count(": ok") == 4 + 2
    assert done.stdout.splitlines()[-1].startswith(str(wheel))
