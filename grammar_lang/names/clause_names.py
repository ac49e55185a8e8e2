"""The names in accept conditions, clauses of tasks and formulas."""

from __future__ import annotations

from collections.abc import Iterator

from grammar_lang import syntax as s
from grammar_lang.syntax import formulas as f
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t


def condition_symbols(condition: s.Condition) -> Iterator[s.Ident]:
    """The symbols that an accept condition names."""
    match condition:
        case s.Factor(word=word):
            yield from word
        case s.Count(symbol=symbol):
            if symbol is not None:
                yield symbol
        case s.Matches(regex=regex):
            yield from _regex_symbols(regex)
        case s.Not(part=part):
            yield from condition_symbols(part)
        case s.And(parts=parts) | s.Or(parts=parts):
            for each in parts:
                yield from condition_symbols(each)


def _regex_symbols(regex: s.Regex) -> Iterator[s.Ident]:
    match regex:
        case s.RegexSymbol(symbol=symbol):
            yield symbol
        case s.RegexSequence(parts=parts) | s.RegexChoice(parts=parts):
            for each in parts:
                yield from _regex_symbols(each)
        case s.RegexRepeat(part=part):
            yield from _regex_symbols(part)
        case s.RegexEmpty():
            pass


def region_names(item: t.TaskItem) -> Iterator[s.Ident]:
    """The regions and maps that a clause of a task names."""
    match item:
        case t.StartIn(region=region) | t.Reach(region=region):
            yield region
        case t.Carry(source=source, target=target):
            yield from (source, target)
        case t.Avoid(regions=regions):
            yield from regions
        case t.Satisfy(formula=formula):
            yield from _atoms(formula)
        case _:
            pass


def named_modules(item: t.TaskItem) -> Iterator[s.Ident]:
    """The modules that ``avoid … except`` and ``robust mass`` name."""
    match item:
        case t.Avoid(excepted=excepted):
            for pair in excepted:
                yield from pair
        case t.RobustPercent(module=module) if module is not None:
            yield module
        case _:
            pass


def summed_attributes(item: t.TaskItem | m.MissionItem) -> Iterator[s.Ident]:
    """The attributes of modules that objectives sum up."""
    for objective in item.objectives if isinstance(item, m.Minimize) else ():
        if objective.attribute is not None:
            yield objective.attribute


def symbols_of(grammar: s.Grammar) -> Iterator[str]:
    """The symbols on the right sides of a grammar; for a grammar from ports, its modules."""
    for item in grammar.items:
        match item:
            case s.Production(right=right):
                yield from (each.symbol.text for each in right)
            case s.StartSymbol(name=name) if grammar.from_ports:
                yield name.text
            case s.Listed(names=modules):
                yield from (name.text for name in modules)
            case _:
                pass


def _atoms(formula: f.Formula) -> Iterator[s.Ident]:
    match formula:
        case f.Atom(region=region):
            yield region
        case f.Unary(operand=operand) | f.Last(operand=operand):
            yield from _atoms(operand)
        case f.Joined(operands=operands):
            for operand in operands:
                yield from _atoms(operand)
        case f.Binary(left=left, right=right):
            yield from _atoms(left)
            yield from _atoms(right)
