"""Python calls kernels, and kernels parts: one called by Python would run as it is written, a hundred times slower."""

from __future__ import annotations

import ast
from pathlib import Path

from test_imports import MODULES, dotted, nodes, wrong

COMPILED = {"kernels", "jit", "laws"}  # rooms whose functions are compiled, but for those that make records of them


def parts_of(path: Path) -> set[str]:
    """Full names of the functions of a module that are marked as parts of kernels."""
    parts = {
        node.name
        for node in nodes(path)
        if isinstance(node, ast.FunctionDef)
        and any(ast.unparse(mark).partition("(")[0] == "part" for mark in node.decorator_list)
    }
    return {f"granular_contact.{dotted(path)}.{name}" for name in parts}


PARTS = set().union(*map(parts_of, MODULES))


def test_python_calls_no_part() -> None:
    def called(path: Path) -> set[str]:
        if COMPILED & set(path.parts):
            return set()
        taken = [
            (node.module, alias) for node in nodes(path) if isinstance(node, ast.ImportFrom) for alias in node.names
        ]
        homes = {alias.asname or alias.name: f"{module}.{alias.name}" for module, alias in taken}
        calls = [ast.unparse(node.func).partition(".") for node in nodes(path) if isinstance(node, ast.Call)]
        return {f"{homes[begin]}{dot}{rest}" for begin, dot, rest in calls if begin in homes} & PARTS

    assert len(PARTS) > 400
    assert wrong(called) == {}
