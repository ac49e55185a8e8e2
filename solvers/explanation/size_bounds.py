"""The lines that bound how large a robot is: the task's ``modules``, and counts in ``accept``.

They are about the set of structures, not about one.
"""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction

from compiler.robots.normal_form import family_of
from compiler.words.derivation import Derivation
from grammar_lang import ir
from grammar_lang.conditions import condition_text
from grammar_lang.source import Span
from solvers.conclusion import DEFAULT_MODULES, module_bound
from solvers.explanation.change import Change
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.task_line import TaskLine, modules_line

MORE_SYMBOLS = 12
"""By how many symbols longer words may be, among which poses are searched."""


def size_lines(posed: PosedTask) -> tuple[TaskLine, ...]:
    """The lines that bound the size of robots from above."""
    modules = modules_line(posed)
    counts = _counts(_accept(posed))
    lines = (_line(posed, number, count) for number, count in enumerate(counts) if _is_upper(count))
    return (*(() if modules is None else (modules,)), *lines)


def beyond(posed: PosedTask, line: TaskLine) -> PosedTask:
    """The task with a far larger bound."""
    family = family_of(posed.program, posed.task)
    allowed, fewest = module_bound(family, posed.task), family.language.fewest_modules()
    modules = max(DEFAULT_MODULES, allowed + 1, fewest or 0)
    if line.kind == "modules":
        return posed.with_task(modules=modules)
    wider = _with_count(posed, line, _allowed(posed, line) + MORE_SYMBOLS)
    return wider if posed.task.modules is not None else wider.with_task(modules=modules)


def exceeds(posed: PosedTask, line: TaskLine, derivation: Derivation) -> bool:
    """Whether a structure has more of what a line bounds than it allows."""
    return _size(posed, line, derivation) > _allowed(posed, line)


def with_size_of(posed: PosedTask, line: TaskLine, derivation: Derivation) -> Change:
    """The bound that just allows a structure."""
    size = _size(posed, line, derivation)
    if line.kind == "modules":
        changed = posed.with_task(modules=size)
        return Change(line, f"with `modules <= {size}`", changed, Fraction(size))
    count = replace(_counts(_accept(posed))[int(line.key[0])], comparison="<=", bound=size)
    says = f"with `{condition_text(count)}` in `accept`"
    return Change(line, says, _with_count(posed, line, size), Fraction(size))


def _size(posed: PosedTask, line: TaskLine, derivation: Derivation) -> int:
    word = derivation.word
    if line.kind == "modules":
        return sum(map(posed.program.is_module, word))
    symbol = _counts(_accept(posed))[int(line.key[0])].symbol
    return len(word) if symbol is None else word.count(symbol)


def _allowed(posed: PosedTask, line: TaskLine) -> int:
    """The largest size that a line allows."""
    if line.kind == "modules":
        return module_bound(family_of(posed.program, posed.task), posed.task)
    count = _counts(_accept(posed))[int(line.key[0])]
    return count.bound - (count.comparison == "<")


# --- Counts in an accept condition ----------------------------------------------------------------


def _accept(posed: PosedTask) -> ir.Accept:
    return posed.program.grammars[posed.task.grammar].accept


def _counts(condition: ir.Accept) -> tuple[ir.Count, ...]:
    """The counts of a condition that are not negated, in order."""
    match condition:
        case ir.Count():
            return (condition,)
        case ir.AllOf(parts) | ir.AnyOf(parts):
            return tuple(count for part in parts for count in _counts(part))
        case _:
            return ()


def _is_upper(count: ir.Count) -> bool:
    return count.comparison in ("<=", "<", "==")


def _with_count(posed: PosedTask, line: TaskLine, bound: int) -> PosedTask:
    """The task with another upper bound in the condition of its grammar."""
    grammars, name = posed.program.grammars, posed.task.grammar
    numbers = iter(range(len(_counts(_accept(posed)))))

    def changed(condition: ir.Accept) -> ir.Accept:
        match condition:
            case ir.Count():
                own = next(numbers) == line.key[0]
                return replace(condition, comparison="<=", bound=bound) if own else condition
            case ir.AllOf(parts) | ir.AnyOf(parts):
                return replace(condition, parts=tuple(map(changed, parts)))
            case _:
                return condition

    grammar = replace(grammars[name], accept=changed(_accept(posed)))
    program = replace(posed.program, grammars={**grammars, name: grammar})
    return replace(posed, program=program)


def _line(posed: PosedTask, number: int, count: ir.Count) -> TaskLine:
    exactly = "" if count.comparison == "==" else "at most "
    most = count.bound - (count.comparison == "<")
    what = "symbols" if count.symbol is None else f"`{count.symbol}`"
    return TaskLine("accept", (number,), f"a robot has {exactly}{most} {what}", _span(posed, count))


def _span(posed: PosedTask, count: ir.Count) -> Span:
    """Where a count is written, if its text is found; else the grammar."""
    whole, sources = posed.program.grammars[posed.task.grammar].span, posed.program.sources
    if whole.file >= len(sources):
        return whole
    text = sources[whole.file].text[whole.start : whole.end]
    symbol = count.symbol or ""
    what = rf"count\s*\(\s*['\"]?{re.escape(symbol)}['\"]?\s*\)" if symbol else r"\blength"
    for clause in re.finditer(r"\baccept\b[^;]*", text):
        found = re.search(rf"{what}\s*{count.comparison}\s*[0-9]+", clause[0])
        if found is not None:
            begin = whole.start + clause.start()
            return Span(begin + found.start(), begin + found.end(), whole.file)
    return whole
