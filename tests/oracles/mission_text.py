"""Families with missions as specifications."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from tests.oracles.mission_arms import Box, Task

if TYPE_CHECKING:
    from tests.oracles.mission_families import Kind, MissionFamily


def family_text(family: MissionFamily) -> str:
    """Modules, grammar, workspaces, tasks and the mission."""
    edges = "open, close, eps" if family.form == "branches" else "eps"
    parts = [_module(kind) for kind in family.kinds.values()]
    parts += [f"edge {edges};", family.grammar.text]
    parts += [_hall(family, number) for number in range(family.halls)]
    parts += [_task(family, number) for number in range(len(family.tasks))]
    return "\n".join([*parts, _mission(family), ""])


def _module(kind: Kind) -> str:
    said = f"role {kind.role}; const price = {_n(kind.price)};"
    if kind.role == "joint":
        said += " dof q: revolute z;"
    if kind.mass:
        said += f" const weight = {_n(kind.mass)} kg;"
    if kind.between:
        low, high = kind.lengths
        said += f" param length in [{_n(low)}, {_n(high)}] m;"
    elif kind.is_chosen:
        said += f" param length in {{{', '.join(map(_n, kind.lengths))}}} m;"
    elif kind.lengths:
        said += f" const length = {_n(kind.lengths[0])} m;"
    return f"module {kind.name} {{ {said} }}"


def _n(value: Fraction) -> str:
    """A decimal, or a quotient."""
    return str(value) if value.denominator == 3 else str(float(value))


def _hall(family: MissionFamily, number: int) -> str:
    said = ["plane xy; bounds box [-5, 5] x [-5, 5] m;"]
    for task in family.tasks:
        if task.hall == number:
            said.append(f"region Home{task.name} {_box(task.home)};")
            said.append(f"region Shelf{task.name} {_box(task.shelf)};")
            if task.post is not None:
                said.append(f"obstacle Post{task.name} {_box(task.post.box)};")
    return f"workspace Hall{number} {{ {' '.join(said)} }}"


def _box(box: Box) -> str:
    return box.text


def _task(family: MissionFamily, number: int) -> str:
    task: Task = family.tasks[number]
    name = task.name
    said = [
        f"robot Arms; workspace Hall{task.hall}; start in Home{name} at rest; reach Shelf{name};",
        f"effort <= {task.effort} N*m; control open loop;",
        f"horizon {task.steps} steps of {_n(task.step)} s;",
    ]
    if task.modules is not None:
        said.append(f"modules <= {task.modules};")
    if task.payload:
        said.append(f"payload {_n(task.payload)} kg;")
    if task.post is not None:
        said.append(f"avoid Post{name} with body;")
    if not number and family.existing is not None:
        said.append(_origin(family))
    return f"task {name} {{ {' '.join(said)} }}"


def _origin(family: MissionFamily) -> str:
    robot = family.existing or ()
    fixed = [f"{name}.length = {_n(value)} m" for name, value in robot if value is not None]
    word = family.grammar.spelled(tuple(name for name, _ in robot))
    return f"from {word}{' fixed ' if fixed else ''}{', '.join(fixed)};"


def _mission(family: MissionFamily) -> str:
    said = [f"tasks {', '.join(task.name for task in family.tasks)};"]
    if family.one_robot:
        said.append(f"one robot; minimize {' then '.join(family.wishes)};")
    else:
        prices = family.prices
        change = f", change {_n(prices.change)}" if prices.free and prices.change else ""
        said.append(f"reconfigure add {_n(prices.add)}, remove {_n(prices.remove)}{change};")
        if prices.free:
            said.append(f"free {', '.join(f'{name}.length' for name in sorted(prices.free))};")
        if family.most is not None:
            said.append(f"changes <= {family.most};")
        said.append("minimize changes;")
    return f"mission M {{ {' '.join(said)} }}"
