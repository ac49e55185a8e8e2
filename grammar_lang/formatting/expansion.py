"""Replace grammars made from ports by ordinary grammars, for ``srgc expand``.

Each becomes a grammar with productions and a semantics; comments inside it are moved before it.
Everything else stays as it is written.  An included file with such a grammar replaces its
``include``, without the grammars and modules that no task needs.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.elaboration.modules import INPUT
from grammar_lang.elaboration.recovery import Spans
from grammar_lang.files.file_tree import STD
from grammar_lang.formatting.formatter import NotFaithful, canonical
from grammar_lang.ir.expression_text import occurrence_names
from grammar_lang.load import Loaded
from grammar_lang.names.table import NameTable
from grammar_lang.parsing.parse import parse
from grammar_lang.source import Source, Span
from grammar_lang.syntax import tasks as t

_COMMENT = re.compile(r"//[^\n]*|/\*(?:[^*]|\*(?!/))*\*/")
_COMMENTS = re.compile(r"(?:^[ \t]*//[^\n]*\n)+[ \t]*\Z", re.MULTILINE)

# --- One grammar ---------------------------------------------------------------------------------


def _rule(production: ir.Production) -> str:
    symbols = (
        symbol.name if symbol.alias is None else f"{symbol.alias}:{symbol.name}"
        for symbol in production.right
    )
    return f"  {production.label}: {production.left} -> {' '.join(symbols)};"


def _block(production: ir.Production, block: ir.SemanticBlock) -> str:
    """The semantic block of a production: it mounts the module and passes its outputs on."""
    called = occurrence_names(production)
    statements: list[str] = []
    for rule in block.rules:
        match rule.target, rule.value:
            case ir.AttributeOf(occurrence, name), ir.AttributeOf(_, source) if occurrence >= 0:
                statements.append(f"{called[occurrence]}.{name} = {source};")
            case ir.AttributeOf(_, name), ir.AttributeOf(ir.THIS, source):
                if name == f"{called[0]}.{INPUT}":
                    statements.append(f"{name} = this.{source};")
            case _:
                pass
    return f"  {production.label} {{ {' '.join(statements)} }}"


def _grammar(item: s.Grammar, grammar: ir.Grammar, text: str) -> str:
    """A grammar from ports as text, with its productions and its semantics."""
    accepts = [
        f"  {text[part.span.start : part.span.end]}"
        for part in item.items
        if isinstance(part, s.Accept)
    ]
    rules = [_rule(production) for production in grammar.productions]
    blocks = [_block(p, (grammar.semantics or {})[p.label]) for p in grammar.productions]
    inside = (part.span for part in item.items if isinstance(part, s.Accept))
    head = _comments_outside(item.span, sorted(inside), text)
    head += [f"grammar {grammar.name} {{", f"  start {grammar.start};"]
    lines = [*head, *rules, *accepts, "}", "", f"semantics {grammar.name} {{", *blocks, "}"]
    return "\n".join(lines)


def _comments_outside(whole: Span, kept: list[Span], text: str) -> list[str]:
    """The comments in a span, except those in the spans that are kept."""
    found: list[str] = []
    start = whole.start
    for span in (*kept, Span(whole.end, whole.end)):
        found += _COMMENT.findall(text, start, span.start)
        start = span.end
    return found


# --- Files ---------------------------------------------------------------------------------------


@dataclass(slots=True)
class _Expansion:
    """Assembles the expanded text from the texts of the files.

    ``whole`` are the files that replace their includes; ``idle`` are the items in them to leave
    out.
    """

    program: ir.Program
    file: t.File
    names: NameTable
    opened: Mapping[Span, int]
    whole: set[int] = field(default_factory=set[int])
    idle: set[Span] = field(default_factory=set[Span])

    def __post_init__(self) -> None:
        above = {number: span.file for span, number in self.opened.items()}
        for item in self.file.items:
            if isinstance(item, s.Grammar) and item.from_ports:
                number = item.span.file
                while number and number not in self.whole:
                    self.whole.add(number)
                    number = above[number]
        self._find_idle()

    def _find_idle(self) -> None:
        """Find grammars of included files that no task names, and modules that only they use."""
        tasks = self.program.tasks.values()
        used = {task.grammar for task in tasks} if tasks else {*self.program.grammars}
        for item in self.file.items:
            if isinstance(item, s.Grammar | s.Semantics) and item.span.file in self.whole:
                name = item.name if isinstance(item, s.Grammar) else item.grammar
                if name.text not in used:
                    self.idle.add(item.span)
        left = Spans(self.idle)
        for item in self.file.items if self.idle else ():
            if isinstance(item, s.Module) and item.span.file in self.whole:
                module = self.names.declared.terminals[item.name.text]
                uses = self.names.uses(module)
                if uses and all(left.covering(use.span) for use in uses):
                    self.idle.add(item.span)

    def text(self, number: int) -> str:
        """The text of a file with its replacements."""
        source = self.program.sources[number]
        parts: list[str] = []
        done = 0
        for span, new in sorted(self._replacements(number, source)):
            parts += [source.text[done : span.start], new]
            done = span.end
        return "".join((*parts, source.text[done:]))

    def _replacements(self, number: int, source: Source) -> Iterator[tuple[Span, str]]:
        for item in self.file.items:
            if item.span.file != number:
                continue
            if item.span in self.idle:
                yield _with_comments(item.span, source.text), ""
                continue
            match item:
                case s.Grammar(name=name, from_ports=True):
                    found = self.program.grammars[name.text]
                    yield item.span, _grammar(item, found, source.text)
                case t.Include():
                    yield from self._include(item, source)
                case _:
                    for path in named_files(item) if number else ():
                        yield path.span, f'"{_from_top(path.text, source)}"'

    def _include(self, item: t.Include, source: Source) -> Iterator[tuple[Span, str]]:
        number = self.opened.get(item.path.span)
        if number in self.whole and number is not None:
            yield item.span, self.text(number)
        elif number is None:
            yield item.span, ""  # the file was included before
        elif item.span.file and not item.std:
            path = _from_top(item.path.text, source)
            if path.startswith(f"{STD}/"):
                yield item.span, f'include std "{path.removeprefix(f"{STD}/")}";'
            else:
                yield item.path.span, f'"{path}"'


def _with_comments(span: Span, text: str) -> Span:
    """A span extended by the comment lines directly above it."""
    above = _COMMENTS.search(text, 0, span.start)
    return span if above is None else Span(above.start(), span.end, span.file)


def named_files(item: t.Item) -> Iterator[s.Ident]:
    """The paths of maps and meshes in an item."""
    match item:
        case t.Workspace(items=items):
            yield from (each.path for each in items if isinstance(each, t.ObstaclesFrom))
        case s.Module(items=items):
            yield from _meshes(each for each in items if isinstance(each, s.Emission))
        case s.Semantics(blocks=blocks):
            for block in blocks:
                yield from _meshes(x for x in block.statements if isinstance(x, s.Emission))
        case _:
            pass


def _meshes(emissions: Iterator[s.Emission]) -> Iterator[s.Ident]:
    for emission in emissions:
        for argument in emission.arguments:
            if isinstance(argument.value, s.Text):
                yield argument.value.ident


def _from_top(written: str, source: Source) -> str:
    """A path in an included file, rewritten relative to the folder of the main file."""
    return posixpath.normpath(posixpath.join(posixpath.dirname(source.path), written))


def names_files(text: str) -> bool:
    """Whether a text refers to files by paths relative to its own folder."""
    file = parse(text, Sink())
    return any(
        (isinstance(item, t.Include) and not item.std) or any(named_files(item))
        for item in file.items
    )


def expanded(loaded: Loaded) -> str:
    """The canonical text of a program without grammars from ports.

    Paths in it are relative to the folder of the main file.

    Raises:
        ValueError: the program has errors.
        NotFaithful: the text cannot be read again, which is a fault of srgc.
    """
    if loaded.program is None or loaded.syntax is None or loaded.names is None:
        raise ValueError("the program has errors")
    text = _Expansion(loaded.program, loaded.syntax, loaded.names, loaded.opened).text(0)
    made = canonical(text, Sink())
    if made is None:
        raise NotFaithful("syntax errors")
    return made
