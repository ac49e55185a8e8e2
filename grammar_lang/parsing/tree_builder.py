"""Build the abstract syntax: each rule of ``srg.lark`` maps the values of its symbols to a node."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any, TypeAlias

from grammar_lang import syntax as s
from grammar_lang.parsing.lalr import Builder, Token
from grammar_lang.source import Span
from grammar_lang.syntax import formulas as f
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t

MAX_LITERAL = 300

Children: TypeAlias = list[Any]


def _ident(token: Token) -> s.Ident:
    text = token.text[1:-1] if token.kind == "STRING" else token.text
    return s.Ident(text, token.span)


def _optional(token: Token | None) -> s.Ident | None:
    return None if token is None else _ident(token)


def _literal(text: str) -> Fraction | None:
    """The exact value of a number; None if its length or exponent exceeds ``MAX_LITERAL``."""
    exponent = text.lower().partition("e")[2]
    if len(text) > MAX_LITERAL or (exponent and abs(int(exponent)) > MAX_LITERAL):
        return None
    return Fraction(text)


def _present(children: Children) -> Children:
    return [c for c in children if c is not None]


def _binary(operator: s.Operator) -> Builder:
    return lambda c, span: s.Binary(operator, c[0], c[1], span)


def _call(c: Children, span: Span) -> object:
    unit = c[-1] if isinstance(c[-1], Token) else None
    call = s.Call(_ident(c[0]), tuple(_present(c[1:-1])), span)
    return call if unit is None else s.Scaled(call, _ident(unit), span)


def _dof(c: Children, span: Span) -> object:
    limits = c[3], c[4], c[5], c[6]
    return s.Dof(_ident(c[0]), c[1], c[2], *limits, _optional(c[7]), span)


def _symbol_word(where: Any) -> Builder:
    return lambda c, _: s.Factor(where, tuple(c))


def _start_in(c: Children, span: Span) -> object:
    begins = c[2] if isinstance(c[2], t.StartIn) else None
    rates, held = (None, False) if begins is None else (begins.rates, begins.held)
    return t.StartIn(_ident(c[0]), c[1], rates, span, held)


def _final_rates(c: Children, span: Span) -> object:
    bound = c[0].rates if isinstance(c[0], t.StartIn) else None
    return t.FinalRates(bound, c[1], span)


def _carry(c: Children, span: Span) -> object:
    rates = None if c[4] is None else t.FinalRates(c[4].rates, None, span)
    return t.Carry(c[0], _ident(c[1]), _ident(c[2]), c[3], rates, span)


def _avoid(c: Children, span: Span) -> object:
    names = tuple(_ident(n) for n in c[:-3])
    return t.Avoid(names, c[-3], c[-2], c[-1] or (), span)


def _rates(c: Children, span: Span) -> object:
    return t.StartIn(s.Ident(""), None, c[0], span)


_EXPRESSIONS: dict[str, Builder] = {
    "number": lambda c, span: s.Number(_literal(c[0].text), _optional(c[1]), span),
    "name": lambda c, _: s.Name(_ident(c[0])),
    "member": lambda c, span: s.Member(c[0], _ident(c[1]), span),
    "owner": lambda c, _: _ident(c[0]),
    "target": lambda c, _: _ident(c[0]),
    "call": _call,
    "text": lambda c, span: s.Text(_ident(c[0]), span),
    "argument": lambda c, span: s.Argument(_optional(c[0]), c[1], span),
    "world": lambda _, span: s.WorldName(span),
    "axis_x": lambda _, span: s.AxisName("x", span),
    "axis_y": lambda _, span: s.AxisName("y", span),
    "axis_z": lambda _, span: s.AxisName("z", span),
    "scaled": lambda c, span: s.Scaled(c[0], _ident(c[1]), span),
    "tuple": lambda c, span: s.Tuple(tuple(c[:-1]), _optional(c[-1]), span),
    "negate": lambda c, span: s.Negate(c[0], span),
    "add": _binary("+"),
    "subtract": _binary("-"),
    "multiply": _binary("*"),
    "divide": _binary("/"),
    "raise": _binary("^"),
    "interval": lambda c, span: s.Interval(c[0], c[1], _optional(c[2]), span),
    "choices": lambda c, span: s.Choices(tuple(c[:-1]), _optional(c[-1]), span),
    "comparison": lambda c, _: c[0].text,
    "symbol": lambda c, _: _ident(c[0]),
}

_MODULES: dict[str, Builder] = {
    "module": lambda c, span: s.Module(_ident(c[0]), tuple(c[1:]), span),
    "role": lambda c, span: s.Role(_ident(c[0]), span),
    "named": lambda c, span: s.Named(_ident(c[0]), span),
    "param": lambda c, span: s.Param(_ident(c[0]), c[1], span),
    "const": lambda c, span: s.Const(_ident(c[0]), c[1], span),
    "dof": _dof,
    "drive": lambda c, span: s.Drive(_ident(c[0]), tuple(c[1:]), span),
    "drive_part": lambda c, span: s.DrivePart(c[0], c[1], span),
    "drive_kind": lambda c, _: c[0].text,
    "dof_kind": lambda c, _: c[0].text,
    "axis": lambda c, _: "".join(token.text for token in c),
    "state": lambda c, span: s.State(_ident(c[0]), _optional(c[1]), c[2], span),
    "input": lambda c, span: s.Input(_ident(c[0]), c[1], span),
    "derivative": lambda c, span: s.Derivative(_ident(c[0]), c[1], span),
    "torque": lambda c, span: s.Torque(_ident(c[0]), c[1], span),
    "frame": lambda c, span: s.Frame(_ident(c[0]), c[1], span),
    "port": lambda c, span: s.Port(_ident(c[0]), _ident(c[1]), c[2], span),
    "gender": lambda c, _: c[0].text,
    "edges": lambda c, span: s.Edges(tuple(c), span),
    "include": lambda c, span: t.Include(_ident(c[1]), span, std=c[0] is not None),
    "std": lambda _, span: span,
}

_GRAMMARS: dict[str, Builder] = {
    "grammar": lambda c, span: s.Grammar(_ident(c[0]), tuple(c[2:]), span, c[1] is not None),
    "ports": lambda _, span: span,
    "start_symbol": lambda c, span: s.StartSymbol(_ident(c[0]), span),
    "listed": lambda c, span: s.Listed(tuple(map(_ident, c)), span),
    "production": lambda c, span: s.Production(c[0], _ident(c[1]), c[2], span),
    "label": lambda c, _: _ident(c[0]),
    "right": lambda c, _: tuple(c),
    "occurrence": lambda c, _: s.Occurrence(_optional(c[0]), c[1]),
    "accept": lambda c, span: s.Accept(c[0], span),
    "disjunction": lambda c, _: s.Or(tuple(c)),
    "conjunction": lambda c, _: s.And(tuple(c)),
    "negation": lambda c, _: s.Not(c[0]),
    "contains": _symbol_word("contains"),
    "starts_with": _symbol_word("starts"),
    "ends_with": _symbol_word("ends"),
    "count": lambda c, _: s.Count(c[0], c[1], c[2]),
    "word_length": lambda c, _: s.Count(None, c[0], c[1]),
    "matches": lambda c, _: s.Matches(c[0]),
    "choice": lambda c, _: s.RegexChoice(tuple(c)),
    "sequence": lambda c, _: s.RegexSequence(tuple(c)),
    "repeat": lambda c, _: s.RegexRepeat(c[0], c[1]),
    "mark": lambda c, _: c[0].text,
    "regex_symbol": lambda c, _: s.RegexSymbol(c[0]),
    "regex_empty": lambda _, __: s.RegexEmpty(),
    "semantics": lambda c, span: s.Semantics(_ident(c[0]), tuple(c[1:]), span),
    "block": lambda c, span: s.Block(_ident(c[0]), tuple(c[1:]), span),
    "rule": lambda c, span: s.Rule(
        s.Member(c[0], _ident(c[1]), c[0].span.to(_ident(c[1]).span)), c[2], span
    ),
    "let": lambda c, span: s.Let(_ident(c[0]), c[1], span),
    "emission": lambda c, span: s.Emission(_ident(c[0]), tuple(_present(c[1:])), span),
}

_WORKSPACES: dict[str, Builder] = {
    "workspace": lambda c, span: t.Workspace(_ident(c[0]), tuple(c[1:]), span),
    "plane": lambda _, span: t.Dimension(2, span),
    "space": lambda _, span: t.Dimension(3, span),
    "bounds": lambda c, span: t.Region("bounds", None, c[0], span),
    "region": lambda c, span: t.Region(c[0], _ident(c[1]), c[2], span),
    "region_kind": lambda c, _: c[0].text,
    "obstacles_from": lambda c, span: t.ObstaclesFrom(_ident(c[0]), _optional(c[1]), c[2], span),
    "box": lambda c, span: t.Box(tuple(c), span),
    "polytope": lambda c, span: t.Polytope(tuple(c[:-1]), _optional(c[-1]), span),
    "inequality": lambda c, span: t.Inequality(c[0], c[1], c[2], span),
    "hull": lambda c, span: t.Hull(tuple(c), span),
    "ball": lambda c, span: t.Round("ball", tuple(c[:-1]), c[-1], span),
    "capsule": lambda c, span: t.Round("capsule", tuple(c[:-1]), c[-1], span),
    "cylinder": lambda c, span: t.Round("cylinder", tuple(c[:-1]), c[-1], span),
    "point": lambda c, span: t.Point(tuple(c[:-1]), _optional(c[-1]), span),
}

_TASKS: dict[str, Builder] = {
    "task": lambda c, span: t.Task(_ident(c[0]), tuple(c[1:]), span),
    "robot": lambda c, span: t.Robot(_ident(c[0]), span),
    "task_workspace": lambda c, span: t.TaskWorkspace(_ident(c[0]), span),
    "start_in": _start_in,
    "start_at": lambda c, span: t.StartAt(c[0], span),
    "reach": lambda c, span: t.Reach(_ident(c[0]), c[1], tuple(c[2:-1]), c[-1], span),
    "aligned": lambda c, span: f.Aligned(c[0], c[1].items, c[1].unit, c[2], span),
    "oriented": lambda c, span: f.Oriented(c[0], c[1], span),
    "final_rates": _final_rates,
    "by_effector": lambda c, _: c[0],
    "at_rest": lambda _, span: span,
    "start_rest": lambda c, span: t.StartIn(s.Ident(""), None, None, span, c[0] is not None),
    "held": lambda _, span: span,
    "rates": _rates,
    "avoid": _avoid,
    "subject": lambda c, _: c[0].text,
    "margin": lambda c, _: c[0],
    "except_": lambda c, _: tuple(c),
    "excepted": lambda c, _: (_ident(c[0]), _ident(c[1])),
    "effort": lambda c, span: t.Effort(c[0], c[1], span),
    "norm": lambda c, _: _ident(c[0]),
    "horizon": lambda c, span: t.Horizon(c[1], c[2], span, c[0] is not None),
    "at_most": lambda _, span: span,
    "slack": lambda c, span: t.Slack(c[0], span),
    "gravity": lambda c, span: t.Gravity(c[0], span),
    "modules": lambda c, span: t.Modules(c[0], c[1], span),
    "bounds_body": lambda _, span: t.BoundsBody(span),
    "from_word": lambda c, span: t.From(c[0], tuple(_present(c[1:])), span),
    "word": lambda c, _: tuple(c),
    "fixing": lambda c, span: t.Fixing(_ident(c[0]), _ident(c[1]), c[2], span),
    "control": lambda c, span: t.Control(c[0], span),
    "repeated": lambda _, span: t.Repeat(span),
    "loop": lambda c, _: " ".join(token.text for token in c),
    "robust_start": lambda c, span: t.RobustRadii("start", tuple(c), span),
    "robust_measure": lambda c, span: t.RobustRadii("measure", tuple(c), span),
    "robust_effort": lambda c, span: t.RobustPercent("effort", c[0], span=span),
    "robust_effort_of_bound": lambda c, span: t.RobustPercent("effort of bound", c[0], span=span),
    "payload": lambda c, span: t.Payload(c[0], c[1], span),
    "carry": _carry,
    "minimize": lambda c, span: m.Minimize(tuple(c), span),
    "objective": lambda c, span: m.Objective(_ident(c[0]), _optional(c[1]), c[2], span),
    "robust_payload": lambda c, span: t.RobustPercent("payload", c[0], span=span),
    "robust_mass": lambda c, span: t.RobustPercent("mass", c[0], _optional(c[1]), span),
    "item": lambda c, _: c[0],
}


_MISSIONS: dict[str, Builder] = {
    "mission": lambda c, span: m.Mission(_ident(c[0]), tuple(c[1:]), span),
    "mission_tasks": lambda c, span: m.MissionTasks(tuple(map(_ident, c)), span),
    "one_robot": lambda _, span: m.OneRobot(span),
    "reconfigure": lambda c, span: m.Reconfigure(tuple(_present(c)), span),
    "price": lambda c, span: m.Price(c[0], c[1], span),
    "price_of": lambda c, _: c[0].text,
    "free": lambda c, span: m.Free(tuple(c), span),
    "freed": lambda c, span: m.Freed(_ident(c[0]), _ident(c[1]), span),
    "changes": lambda c, span: m.Changes(c[0], c[1], span),
}


def _temporal(operator: Any) -> Builder:
    return lambda c, span: f.Unary(operator, c[-1], c[0] if len(c) > 1 else None, span)


_FORMULAS: dict[str, Builder] = {
    "satisfy": lambda c, span: t.Satisfy(c[0], span),
    "implies": lambda c, span: f.Binary("implies", c[0], c[1], span),
    "either": lambda c, span: f.Joined("or", tuple(c), span),
    "both": lambda c, span: f.Joined("and", tuple(c), span),
    "strong_until": lambda c, span: f.Binary("until", c[0], c[1], span),
    "not_formula": _temporal("not"),
    "always": _temporal("always"),
    "eventually": _temporal("eventually"),
    "next_step": _temporal("next"),
    "last": lambda c, span: f.Last(c[0], c[1], span),
    "atom": lambda c, span: f.Atom(_ident(c[0]), c[1], span, tuple(c[2:])),
    "window": lambda c, span: f.Window(c[0], c[1], span),
}

BUILDERS: Mapping[str, Builder] = (
    _EXPRESSIONS | _MODULES | _GRAMMARS | _WORKSPACES | _TASKS | _MISSIONS | _FORMULAS
)


def item_of(value: object) -> t.Item:
    """The value of a whole item, with its type checked."""
    match value:
        case (
            s.Module()
            | s.Edges()
            | s.Grammar()
            | s.Semantics()
            | t.Workspace()
            | t.Task()
            | m.Mission()
            | t.Include()
        ):
            return value
        case _:
            raise TypeError(f"not an item: {value!r}")
