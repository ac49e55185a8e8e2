"""What docstrings of public functions say: shapes of arrays, and errors.

That there are docstrings at all is what ruff checks (its rules D).
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TypeAlias

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ["grammar_lang", "compiler", "solvers", "srgc"]

Function: TypeAlias = ast.FunctionDef | ast.AsyncFunctionDef

ALIAS = re.compile(r"^(\w+)(?:: TypeAlias)? = (?:Array\b|NDArray\[)", re.MULTILINE)
"""Other names for arrays, as in ``Flags = NDArray[np.bool_]``."""
LENGTH = r"(?:\.{2,3}|\w+(?:\(\w+\))?(?: ?[-+*] ?\w+| \w)*)"
SHAPE = re.compile(rf"\bshape|\({LENGTH},(?: ?{LENGTH},?)*\)|\b\w+ x \w+")
"""The word, or lengths as in ``(n,)``, ``(steps + 1, 2 n)``, ``(.., p)`` and ``4 x 4``."""
IMPOSSIBLE = {"AssertionError", "NotImplementedError", "TypeError"}
"""Errors of calls that the types rule out, or of mistakes in here."""
EXEMPT = {"command", "group", "override", "overload"}
"""Decorators: the docstring of a command is its help, that of an override is the base's."""


def sources() -> dict[Path, str]:
    return {
        path: path.read_text(encoding="utf-8")
        for package in PACKAGES
        for path in sorted((ROOT / package).rglob("*.py"))
    }


def arrays(text: str, aliases: dict[str, set[str]]) -> set[str]:
    """The names of array types in a file: those of NumPy, its own, and those that it imports.

    ``aliases`` are the names that each module defines.
    """
    imported = {
        each.asname or each.name
        for node in ast.parse(text).body
        if isinstance(node, ast.ImportFrom) and node.module is not None
        for each in node.names
        if each.name in aliases.get(node.module, ())
    }
    return {"NDArray", "ndarray", *ALIAS.findall(text), *imported}


def names(*nodes: ast.AST | None) -> set[str]:
    """The names in some expressions."""
    within = (n for node in nodes if node is not None for n in ast.walk(node))
    return {name for n in within if (name := getattr(n, "id", getattr(n, "attr", None)))}


def public(body: list[ast.stmt], prefix: str = "") -> Iterator[tuple[str, Function]]:
    """Public functions and the methods of public classes, with their names."""
    for node in body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from public(node.body, f"{prefix}{node.name}.")
        elif isinstance(node, Function) and not node.name.startswith("_"):
            decorators = names(*node.decorator_list)
            if not decorators & EXEMPT:
                yield prefix + node.name, node


def errors(node: ast.AST) -> Iterator[str]:
    """The classes raised in a function, but for those of functions within it."""
    parts = ("body", "orelse", "handlers", "finalbody", "cases")
    for child in (child for part in parts for child in getattr(node, part, ())):
        if isinstance(child, ast.Raise) and child.exc is not None:
            kind = child.exc.func if isinstance(child.exc, ast.Call) else child.exc
            yield getattr(kind, "id", getattr(kind, "attr", ""))
        elif not isinstance(child, Function):
            yield from errors(child)


def missing(text: str, kinds: set[str]) -> list[str]:
    """The line, name and fault of every docstring that says too little."""
    found = []
    for name, node in public(ast.parse(text).body):
        said, given = ast.get_docstring(node, clean=False) or "", node.args
        arguments = [*given.posonlyargs, *given.args, *given.kwonlyargs]
        annotated = names(node.returns, *(each.annotation for each in arguments))
        if annotated & kinds and not SHAPE.search(said):
            found.append(f"{node.lineno} {name}: no shape")
        raised = {error for error in errors(node) if error[:1].isupper()} - IMPOSSIBLE
        if raised and not re.search(rf"(?i)\brais|\brefus|{'|'.join(raised)}", said):
            found.append(f"{node.lineno} {name}: no word of {', '.join(sorted(raised))}")
    return found


def test_docstrings_say_shapes_and_errors():
    texts = sources()
    aliases = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts): set(ALIAS.findall(text))
        for path, text in texts.items()
    }
    faults = [
        f"{path.relative_to(ROOT)}:{fault}"
        for path, text in texts.items()
        for fault in missing(text, arrays(text, aliases))
    ]
    assert not faults, "\n".join(faults)


@pytest.mark.parametrize(
    ("code", "faults"),
    [
        ("def f(x: Array) -> None:\n    '''Move x.'''", ["1 f: no shape"]),
        ("def f(x: Array) -> None:\n    '''Move x (see also it).'''", ["1 f: no shape"]),
        ("def f() -> Array | None:\n    '''Points (k + 1, 2 n) or None.'''", []),
        ("class A:\n    def f(self) -> Ints:\n        ''''''", ["2 A.f: no shape"]),
        ("class _A:\n    def f(self) -> Array:\n        ''''''", []),
        ("def f():\n    '''Do.'''\n    if x:\n        raise Fault(3)", ["1 f: no word of Fault"]),
        ("def f():\n    '''Do.\n\n    Raises:\n        Fault: x.'''\n    raise a.Fault", []),
        ("def f():\n    '''Do.'''\n    def g():\n        raise Fault", []),
        ("@click.command()\ndef f():\n    '''Do.'''\n    raise Fault", []),
    ],
)
def test_what_is_missing(code, faults):
    own = arrays("Array = NDArray[x]\nInts: TypeAlias = NDArray[y]\n", {})
    assert missing(code, own) == faults


def test_a_class_with_the_name_of_an_array_elsewhere_is_none() -> None:
    aliases = {"a.poses": {"Pose"}}
    assert "Pose" in arrays("from a.poses import Pose, Rest", aliases)
    assert "Pose" not in arrays("from b.poses import Pose", aliases)
