"""Write syntax nodes as canonical text, for programs that write programs; the parser's inverse.

Each statement follows the grammar, and the formatter sets the layout.  The text is parsed again: if
that gives other nodes than the given ones, this file is at fault.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, assert_never

from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.formatter import NotFaithful, canonical
from grammar_lang.formatting.phrases import (
    arguments,
    condition,
    domain,
    effector,
    expression,
    formula,
    listed,
    pose,
    quantity,
    quoted,
    row,
    symbol,
    word,
)
from grammar_lang.parsing.parse import parse
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t


def syntax_text(items: Iterable[t.Item]) -> str:
    """A file with the given items, in canonical form.

    Raises:
        ValueError: a number in them was too large to be read.
        NotFaithful: the text has another meaning: this file is at fault, or no text has the nodes.
    """
    given = tuple(items)
    text = canonical("".join(f"{_item(item)}\n" for item in given), Sink())
    if text is None:
        raise NotFaithful("syntax errors")
    if parse(text, Sink()).items != given:
        raise NotFaithful("other syntax than the nodes")
    return text


def _item(item: t.Item) -> str:
    match item:
        case t.Include(path=path, std=std):
            return f"include {'std ' if std else ''}{quoted(path)};"
        case s.Edges(names=names):
            return f"edge {', '.join(map(symbol, names))};"
        case s.Semantics(grammar=name, blocks=blocks):
            return _braced(f"semantics {name.text}", map(_block, blocks))
        case s.Grammar(name=name, from_ports=from_ports):
            ports = " from ports" if from_ports else ""
            return _braced(f"grammar {name.text}{ports}", map(_statement, item.items))
        case s.Module(name=name):
            return _braced(f"module {name.text}", map(_statement, item.items))
        case t.Workspace(name=name):
            return _braced(f"workspace {name.text}", map(_statement, item.items))
        case t.Task(name=name):
            return _braced(f"task {name.text}", map(_statement, item.items))
        case m.Mission(name=name):
            return _braced(f"mission {name.text}", map(_statement, item.items))
        case _:
            assert_never(item)


def _braced(head: str, lines: Iterable[str]) -> str:
    return "\n".join([f"{head} {{", *lines, "}"])


def _block(block: s.Block) -> str:
    return _braced(block.label.text, map(_statement, block.statements))


def _statement(node: object) -> str:
    return f"{_STATEMENTS[type(node)](node)};"


# --- modules --------------------------------------------------------------------------------------


def _dof(node: s.Dof) -> str:
    parts = (
        ("in", node.range and domain(node.range)),
        ("rate in", node.rate and domain(node.rate)),
        ("accel <=", node.accel and expression(node.accel)),
        ("effort <=", node.effort and expression(node.effort)),
    )
    said = "".join(f" {head} {text}" for head, text in parts if text)
    said += "" if node.named is None else f" named {quoted(node.named)}"
    return f"dof {node.name.text}: {node.kind} {node.axis}{said}"


def _drive(node: s.Drive) -> str:
    parts = "".join(f" {part.kind} {expression(part.value)}" for part in node.parts)
    return f"drive {node.name.text}:{parts}"


def _state(node: s.State) -> str:
    unit = "" if node.unit is None else f" {node.unit.text}"
    start = "" if node.initial is None else f" = {expression(node.initial)}"
    return f"state {node.name.text}{unit}{start}"


def _port(node: s.Port) -> str:
    gender = "" if node.gender is None else f" {node.gender}"
    return f"port {node.name.text}: {node.type.text}{gender}"


_MODULES: dict[type, Callable[[Any], str]] = {
    s.Role: lambda n: f"role {n.name.text}",
    s.Named: lambda n: f"named {quoted(n.text)}",
    s.Param: lambda n: f"param {n.name.text} in {domain(n.domain)}",
    s.Const: lambda n: f"const {n.name.text} = {expression(n.value)}",
    s.Dof: _dof,
    s.Drive: _drive,
    s.State: _state,
    s.Input: lambda n: f"input {n.name.text} in {domain(n.domain)}",
    s.Derivative: lambda n: f"der({n.name.text}) = {expression(n.value)}",
    s.Torque: lambda n: f"torque({n.name.text}) = {expression(n.value)}",
    s.Frame: lambda n: f"frame {n.name.text} = {expression(n.value)}",
    s.Port: _port,
    s.Emission: lambda n: f"{n.kind.text}({arguments(n.arguments)})",
}

# --- grammars and semantics -----------------------------------------------------------------------


def _production(node: s.Production) -> str:
    right = (
        f"{'' if each.alias is None else f'{each.alias.text}:'}{symbol(each.symbol)}"
        for each in node.right
    )
    return f"{node.label.text}: {node.left.text} -> {' '.join(right) or 'empty'}"


_GRAMMARS: dict[type, Callable[[Any], str]] = {
    s.StartSymbol: lambda n: f"start {n.name.text}",
    s.Listed: lambda n: f"with {listed(n.names)}",
    s.Production: _production,
    s.Accept: lambda n: f"accept {condition(n.condition)}",
    s.Rule: lambda n: f"{n.target.owner.text}.{n.target.name.text} = {expression(n.value)}",
    s.Let: lambda n: f"let {n.name.text} = {expression(n.value)}",
}

# --- workspaces -----------------------------------------------------------------------------------


def point(node: t.Point) -> str:
    """A point or a vector."""
    return row(node.items, node.unit)


def shape(node: t.Shape) -> str:
    """The shape of a region."""
    match node:
        case t.Box(sides=sides):
            return f"box {' x '.join(map(domain, sides))}"
        case t.Polytope(rows=rows, unit=unit):
            inner = "".join(
                f"{expression(each.left)} {each.comparison} {expression(each.right)}; "
                for each in rows
            )
            return f"polytope {{ {inner}}}{'' if unit is None else f' {unit.text}'}"
        case t.Hull(points=points):
            return f"hull {', '.join(map(point, points))}"
        case t.Round(kind=kind, points=points, radius=radius):
            return f"{kind} {', '.join(map(point, points))} radius {expression(radius)}"
        case _:
            assert_never(node)


def _region(node: t.Region) -> str:
    name = "" if node.name is None else f"{node.name.text} "
    return f"{node.kind} {name}{shape(node.shape)}"


def _obstacles_from(node: t.ObstaclesFrom) -> str:
    unit = "" if node.unit is None else f" in {node.unit.text}"
    frame = "" if node.frame is None else f" at {expression(node.frame)}"
    return f"obstacles from {quoted(node.path)}{unit}{frame}"


_WORKSPACES: dict[type, Callable[[Any], str]] = {
    t.Dimension: lambda n: "plane xy" if n.value == 2 else "space xyz",
    t.Region: _region,
    t.ObstaclesFrom: _obstacles_from,
}

# --- tasks and missions ---------------------------------------------------------------------------


def _start_in(node: t.StartIn) -> str:
    rest = f"at rest{' held' if node.held else ''}"
    rates = rest if node.rates is None else f"rates <= {expression(node.rates)}"
    return f"start in {node.region.text}{effector(node.effector)} {rates}"


def _final(node: t.FinalRates | None) -> str:
    if node is None:
        return ""
    rates = " at rest" if node.bound is None else f" rates <= {expression(node.bound)}"
    return f"{rates}{'' if node.duration is None else f' for {expression(node.duration)}'}"


def _reach(node: t.Reach) -> str:
    poses = "".join(map(pose, node.poses))
    return f"reach {node.region.text}{effector(node.effector)}{poses}{_final(node.rates)}"


def _avoid(node: t.Avoid) -> str:
    margin = "" if node.margin is None else f", margin {expression(node.margin)}"
    pairs = ", ".join(f"{one.text} {other.text}" for one, other in node.excepted)
    pairs = f", except {pairs}" if pairs else ""
    return f"avoid {listed(node.regions)} with {node.subject}{margin}{pairs}"


def _effort(node: t.Effort) -> str:
    norm = "" if node.norm is None else f" norm {node.norm.text}"
    return f"effort <= {expression(node.bound)}{norm}"


def _horizon(node: t.Horizon) -> str:
    most = "at most " if node.at_most else ""
    return f"horizon {most}{expression(node.steps)} steps of {expression(node.step)}"


def _from(node: t.From) -> str:
    fixed = ", ".join(
        f"{each.occurrence.text}.{each.name.text} = {expression(each.value)}" for each in node.fixed
    )
    return f"from {word(node.word)}{f' fixed {fixed}' if fixed else ''}"


def _carry(node: t.Carry) -> str:
    way = f"from {node.source.text} to {node.target.text}{effector(node.effector)}"
    return f"carry {expression(node.mass)} {way}{_final(node.rates)}"


def _percent(node: t.RobustPercent) -> str:
    of = {"effort of bound": " of bound"}.get(node.of, "")
    module = "" if node.module is None else f" of {node.module.text}"
    return f"robust {node.of.partition(' ')[0]} {expression(node.percent)} %{of}{module}"


def _objective(node: m.Objective) -> str:
    attribute = "" if node.attribute is None else f"({node.attribute.text})"
    within = "" if node.within is None else f" within {expression(node.within)} %"
    return f"{node.name.text}{attribute}{within}"


def _reconfigure(node: m.Reconfigure) -> str:
    prices = ", ".join(f"{each.of} {expression(each.value)}" for each in node.prices)
    return f"reconfigure {prices}".rstrip()


_TASKS: dict[type, Callable[[Any], str]] = {
    t.Robot: lambda n: f"robot {n.name.text}",
    t.TaskWorkspace: lambda n: f"workspace {n.name.text}",
    t.StartIn: _start_in,
    t.StartAt: lambda n: f"start at {point(n.point)}",
    t.Reach: _reach,
    t.Avoid: _avoid,
    t.Effort: _effort,
    t.Horizon: _horizon,
    t.Slack: lambda n: f"slack {expression(n.value)}",
    t.Gravity: lambda n: f"gravity {point(n.point)}",
    t.Modules: lambda n: f"modules {n.comparison} {expression(n.bound)}",
    t.BoundsBody: lambda _: "bounds with body",
    t.From: _from,
    t.Satisfy: lambda n: f"satisfy {formula(n.formula)}",
    t.Control: lambda n: f"control {n.loop}",
    t.Repeat: lambda _: "repeat",
    t.Payload: lambda n: f"payload {expression(n.mass)}{effector(n.effector)}",
    t.Carry: _carry,
    t.RobustRadii: lambda n: f"robust {n.of} {', '.join(map(quantity, n.values))}",
    t.RobustPercent: _percent,
    m.Minimize: lambda n: f"minimize {' then '.join(map(_objective, n.objectives))}",
    m.MissionTasks: lambda n: f"tasks {listed(n.names)}",
    m.OneRobot: lambda _: "one robot",
    m.Reconfigure: _reconfigure,
    m.Free: lambda n: (
        f"free {', '.join(f'{each.module.text}.{each.name.text}' for each in n.parameters)}"
    ),
    m.Changes: lambda n: f"changes {n.comparison} {expression(n.bound)}",
}

_STATEMENTS: Mapping[type, Callable[[Any], str]] = _MODULES | _GRAMMARS | _WORKSPACES | _TASKS
