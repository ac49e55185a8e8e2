"""Semantic tokens: the kind of every word, keywords only where they are keywords."""

from __future__ import annotations

from lsprotocol import types as lsp

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.names.declarations import Kind
from grammar_lang.parsing.parse import parse_tokens
from grammar_lang.parsing.tokens import SKIPPED, Tokens
from srgc.language_server.completions.call_forms import EMISSIONS, FUNCTIONS
from srgc.language_server.documents.analysis import Analysis

_KEYWORD, _NUMBER, _STRING, _UNIT = "keyword", "number", "string", "type"
TYPES = (
    _KEYWORD, _NUMBER, _STRING, _UNIT, "class", "enumMember", "interface", "function", "variable",
    "property", "namespace", "event", "parameter",
)  # fmt: skip
MODIFIERS = ("declaration",)
_OF_KIND: dict[Kind, str] = {
    "module": "class",
    "edge": "enumMember",
    "nonterminal": "interface",
    "production": "function",
    "occurrence": "parameter",
    "parameter": "property",
    "constant": "property",
    "degree of freedom": "property",
    "state": "property",
    "input": "property",
    "frame": "property",
    "port type": "interface",
    "attribute": "property",
    "local value": "variable",
    "grammar": "namespace",
    "workspace": "namespace",
    "region": "variable",
    "obstacle": "variable",
    "target": "variable",
    "map": "variable",
    "task": "event",
    "mission": "event",
}
LEGEND = lsp.SemanticTokensLegend(list(TYPES), list(MODIFIERS))


def _of_token(tokens: Tokens, index: int) -> str | None:
    kind, text = tokens.kinds[index], tokens.at(index)
    if kind == "NUMBER":
        return _NUMBER
    if kind == "STRING":
        return _STRING
    if kind == "UNIT":
        return _UNIT
    if kind == "NAME":
        called = index + 1 < len(tokens) and tokens.kinds[index + 1] == "("
        return "function" if called and (text in EMISSIONS or text in FUNCTIONS) else None
    return _KEYWORD if kind == text and text.isidentifier() else None


def semantic_tokens(analysis: Analysis, number: int) -> lsp.SemanticTokens:
    """The tokens of a document, each relative to the one before."""
    tokens = parse_tokens(analysis.sources[number].text, Sink(), number)[1]
    lines = analysis.lines(number)
    named = {
        name.whole.start: name for name in analysis.names.mentions if name.whole.file == number
    }
    data: list[int] = []
    line = column = 0
    for index, start in enumerate(tokens.starts):
        if tokens.kinds[index] == SKIPPED:
            continue
        name = named.get(start)
        kind = _of_token(tokens, index) if name is None else _OF_KIND[name.entity.kind]
        if kind is None:
            continue
        begin, end = lines.position(start), lines.position(tokens.ends[index])
        if begin.line != end.line:
            continue
        column = column if begin.line == line else 0
        declares = int(name is not None and name.declares)
        size = end.character - begin.character
        data += [begin.line - line, begin.character - column, size, TYPES.index(kind), declares]
        line, column = begin.line, begin.character
    return lsp.SemanticTokens(data)
