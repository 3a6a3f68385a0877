"""Run all examples, and write examples/README.md with their pictures and what they print.

python examples/make_gallery.py
"""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
PICTURES = HERE / "pictures"
NO_EXAMPLES = {"common", "make_gallery"}
HEAD = """# Examples

Scripts to open, change and run in a checkout, each with its picture and what it prints. Most take a second after a
first run that compiles their forces, the fit some seconds. Runs that need a config alone are in the
[gallery](../configs/README.md). This page is written by `python examples/make_gallery.py`; the tests run every script,
and compare what it prints.
"""
MUJOCO = """
## More in MuJoCo

`python examples/mujoco/ball.py`, `wheel.py` and `hexapod.py` put sand into models of MuJoCo; `--video film.gif` draws
them ([tutorial](../docs/tutorials/mujoco.md)).
"""


def scripts() -> list[Path]:
    """The examples, by name."""
    return [path for path in sorted(HERE.glob("*.py")) if path.stem not in NO_EXAMPLES]


def section(script: Path) -> str:
    """Run a script, and return its section of the page."""
    words = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8")))
    command = [sys.executable, str(script), "--out", str(PICTURES)]
    output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    name = script.stem
    shown = (
        f"![{words}](pictures/{name}.png)\n\n```sh\npython examples/{name}.py\n```\n\n```text\n{output.rstrip()}\n```\n"
    )
    return f"\n## [{name}]({name}.py)\n\n{words}\n\n{shown}"


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    (HERE / "README.md").write_text(HEAD + "".join(map(section, scripts())) + MUJOCO, encoding="utf-8")
