"""Names that are declared and never used: the last check of a file that has no errors.

Of modules: parameters and constants that no semantics reads, states and inputs on which no torque
depends.  Of semantics: attributes that no rule and no emission reads.  Beside the tasks of a file:
grammars, workspaces, regions and targets that none of them names.  What an included file declares
is a library's and need not be used.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang import syntax_formulas as f
from grammar_lang import syntax_tasks as t
from grammar_lang.attributes import Key, members, nonterminal_at
from grammar_lang.findings.codes import Code
from grammar_lang.findings.diagnostics import Sink
from grammar_lang.module_scope import kinds
from grammar_lang.productions import GrammarInfo, ProductionInfo
from grammar_lang.readings import bounds, readings

_HINTS: dict[str, str] = {
    "parameter": "read `{module}.{name}` in the semantics, or remove it",
    "constant": "read `{module}.{name}` in the semantics, or remove it",
    "state": "read it in a `torque`, or remove it with its `der`",
    "input": "read it in a `der` or a `torque`, or remove it",
}


def _warn(what: str, name: s.Ident, why: str, hint: str, sink: Sink) -> None:
    if name.span.file == 0:
        sink.warning(Code.UNUSED_NAME, f"{what} `{name.text}` {why}", name.span, hint)


# --- semantics ---------------------------------------------------------------------------------


@dataclass(slots=True)
class _Reads:
    """What the semantics of a file reads; ``modules``: the names read of each that it describes."""

    modules: dict[str, set[str]] = field(default_factory=dict[str, set[str]])
    attributes: set[Key] = field(default_factory=set[Key])

    def block(self, block: s.Block, info: ProductionInfo) -> None:
        """Take note of what the block of a production reads."""
        right = info.production.right
        for symbol in right:
            if symbol.kind == "module":
                self.modules.setdefault(symbol.name, set())
        for member in members(block):
            nonterminal = _nonterminal(member.owner, info)
            if nonterminal is not None:
                self.attributes.add((nonterminal, member.name.text))
            elif member.owner.text in info.names:
                module = right[info.names[member.owner.text]].name
                self.modules.setdefault(module, set()).add(member.name.text)


def _nonterminal(owner: s.Ident, info: ProductionInfo) -> str | None:
    occurrence = ir.THIS if owner.text == "this" else info.names.get(owner.text)
    return None if occurrence is None else nonterminal_at(info, occurrence)


def _attributes(
    blocks: Iterable[tuple[s.Block, ProductionInfo]], read: set[Key], sink: Sink
) -> None:
    """Warn of the attributes of one grammar that nothing reads, where they are first defined."""
    seen = set(read)
    for block, info in blocks:
        for statement in block.statements:
            if not isinstance(statement, s.Rule):
                continue
            target = statement.target
            nonterminal = _nonterminal(target.owner, info)
            if nonterminal is not None and (nonterminal, target.name.text) not in seen:
                seen.add((nonterminal, target.name.text))
                hint = "read it in a rule or an emission, or remove its definitions"
                _warn("the attribute", target.name, f"of `{nonterminal}` is never read", hint, sink)


# --- modules -----------------------------------------------------------------------------------


def _uses(module: s.Module) -> tuple[dict[str, set[str]], set[str]]:
    """What each name of a module is made of, and the names that its motion depends on."""
    made: dict[str, set[str]] = {name: set() for name in kinds(module)}
    moving: set[str] = set()
    for item in module.items:
        match item:
            case s.Param(name=name, domain=domain) | s.Input(name=name, domain=domain):
                made[name.text] |= _names(bounds(domain))
            case s.Const(name=name, value=value) | s.Derivative(name=name, value=value):
                made[name.text] |= _names([value])
            case s.State(name=name, initial=initial):
                made[name.text] |= _names([] if initial is None else [initial])
            case s.Dof(range=range_, rate=rate):
                moving |= _names([*bounds(range_), *bounds(rate)])
            case s.Torque(value=value):
                moving |= _names([value])
            case s.Role():
                pass
    return made, moving


def _names(expressions: Iterable[s.Expr]) -> set[str]:
    return {r.ident.text for r in readings(expressions) if isinstance(r, s.Name)}


def _live(made: Mapping[str, set[str]], roots: Iterable[str]) -> set[str]:
    """Whatever the roots are made of, directly or not."""
    found: set[str] = set()
    stack = list(roots)
    while stack:
        name = stack.pop()
        if name not in found and name in made:
            found.add(name)
            stack.extend(made[name])
    return found


def _module(module: s.Module, read: set[str], sink: Sink) -> None:
    made, moving = _uses(module)
    live = _live(made, read | moving)
    what = kinds(module)
    readers: dict[str, str] = {}
    for reader, names in made.items():
        readers |= {name: reader for name in names if name not in readers or reader != name}
    for item in module.items:
        if not isinstance(item, s.Param | s.Const | s.State | s.Input) or item.name.text in live:
            continue
        name, kind = item.name.text, what[item.name.text]
        hint = _HINTS[kind].format(module=module.name.text, name=name)
        if readers.get(name, name) != name:
            hint = f"only `{readers[name]}` reads it, which is not used either"
        _warn(f"the {kind}", item.name, f"of module `{module.name.text}` is never used", hint, sink)


# --- tasks -------------------------------------------------------------------------------------


def _atoms(formula: f.Formula) -> Iterator[str]:
    """The regions that a formula names."""
    stack = [formula]
    while stack:
        match stack.pop():
            case f.Atom(region=region):
                yield region.text
            case f.Unary(operand=operand) | f.Last(operand=operand):
                stack.append(operand)
            case f.Joined(operands=operands):
                stack.extend(operands)
            case f.Binary(left=left, right=right):
                stack.extend((left, right))


def _regions(item: t.TaskItem) -> Iterator[str]:
    match item:
        case t.StartIn(region=region) | t.Reach(region=region):
            yield region.text
        case t.Avoid(regions=regions):
            yield from (region.text for region in regions)
        case t.Satisfy(formula=formula):
            yield from _atoms(formula)
        case _:
            pass


@dataclass(slots=True)
class _Named:
    """What the tasks of a file name; ``workspaces``: the regions named of each."""

    grammars: set[str] = field(default_factory=set[str])
    workspaces: dict[str, set[str]] = field(default_factory=dict[str, set[str]])

    def task(self, task: t.Task) -> None:
        """Take note of what a task names."""
        regions = {name for item in task.items for name in _regions(item)}
        for item in task.items:
            if isinstance(item, t.Robot):
                self.grammars.add(item.name.text)
            elif isinstance(item, t.TaskWorkspace):
                self.workspaces.setdefault(item.name.text, set()).update(regions)


def _workspace(workspace: t.Workspace, named: _Named, sink: Sink) -> None:
    regions = named.workspaces.get(workspace.name.text)
    hint = "name it in a task, or remove it"
    if regions is None:
        _warn("the workspace", workspace.name, "is named by no task", hint, sink)
        return
    for item in workspace.items:
        if not isinstance(item, t.Region) or item.name is None or item.name.text in regions:
            continue
        if item.kind in {"region", "target"}:
            _warn(f"the {item.kind}", item.name, "is named by no task", hint, sink)


def _check_tasks(file: t.File, sink: Sink) -> None:
    named = _Named()
    for item in file.items:
        if isinstance(item, t.Task):
            named.task(item)
    for item in file.items:
        if isinstance(item, t.Workspace):
            _workspace(item, named, sink)
        elif isinstance(item, s.Grammar) and item.name.text not in named.grammars:
            hint = "name it in a task, or remove it"
            _warn("the grammar", item.name, "is named by no task", hint, sink)


def report_unused(file: t.File, grammars: Mapping[str, GrammarInfo], sink: Sink) -> None:
    """Warn of the names that a file declares and never uses; silent after errors.

    Args:
        file: the file with all it includes.
        grammars: its grammars by name, as lowered.
        sink: takes the warnings; an error in it may stand where a name was to be read.
    """
    if sink.has_errors:
        return
    reads = _Reads()
    for item in file.items:
        if not isinstance(item, s.Semantics):
            continue
        productions = grammars[item.grammar.text].productions
        blocks = [(block, productions[block.label.text]) for block in item.blocks]
        reads.attributes.clear()
        for block, info in blocks:
            reads.block(block, info)
        _attributes(blocks, reads.attributes, sink)
    for item in file.items:
        if isinstance(item, s.Module) and item.name.text in reads.modules:
            _module(item, reads.modules[item.name.text], sink)
    if any(isinstance(item, t.Task) for item in file.items):
        _check_tasks(file, sink)
