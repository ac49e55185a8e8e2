"""The requests of the page about a text, answered as commands and the language server do.

All of it runs in the worker of a browser, where there are no processes, threads, sockets or files,
and of the native libraries python-flint alone.  What no import finds there is asked for by name:
the page fetches it, if it has it, and repeats the request.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from srgc.faults import NoAnswer, SpecErrors, UsageFault
from srgc.playground.spec import NAME, spec_of

Answer = dict[str, Any]

FETCHED = frozenset({"flint"})
"""The libraries that the page fetches when a text needs them."""
COMMANDS = "run `srgc` on this file instead"


def answer(request: str) -> str:
    """The answer to a request, both as JSON objects; no exception leaves this function.

    Args:
        request: ``ask`` says what for, ``text`` is the spec; the rest is as the functions below
            have it.  Places count code units of UTF-16 from the start of the text.

    Returns:
        ``answer`` with what was asked for, or ``fault`` with a message, or ``needs`` with the name
        of a library without which there is no answer.
    """
    asked = json.loads(request)
    try:
        found: Answer = {"answer": ANSWERS[asked.pop("ask")](**asked)}
    except ModuleNotFoundError as missing:
        found = _without(str(missing.name).partition(".")[0])
    except Exception as error:
        found = {"fault": _message(error)}
    return json.dumps(found, ensure_ascii=False)


def _without(library: str) -> Answer:
    if library in FETCHED:
        return {"needs": library}
    return {"fault": f"error: this needs {library}, which no browser has; {COMMANDS}"}


def _message(error: Exception) -> str:
    """As the command line has it."""
    from compiler.words.budget import BudgetExceededError
    from grammar_lang.diagnostics.render import to_text

    if isinstance(error, SpecErrors):
        return to_text(error.checked.diagnostics, error.checked.sources, colour=True)
    if isinstance(error, UsageFault):
        return error.finding()
    if isinstance(error, BudgetExceededError | NoAnswer):
        return f"unknown: {error}"
    if isinstance(error, MemoryError | RecursionError):
        return f"error: this takes more memory than a browser has; {COMMANDS}"
    return (
        f"internal error: {type(error).__name__}: {error}\n"
        "this is a fault of srgc, not of your file"
    )


def check(text: str) -> Answer:
    """What ``srgc check`` prints, its JSON, places for the editor, and what was not checked."""
    from grammar_lang.diagnostics.render import records, to_text
    from srgc.faults import MOST_FINDINGS
    from srgc.text_reports.findings_text import summary

    spec = spec_of(text)
    checked = spec.checked
    shown = to_text(checked.diagnostics, checked.sources, colour=True, most=MOST_FINDINGS)
    return {
        "shown": f"{shown}{summary([checked])}\n",
        "findings": records(checked.diagnostics, checked.sources),
        "places": [spec.place(found.span) for found in checked.diagnostics],
        "unchecked": [*spec.unchecked],
        "grammars": [] if checked.program is None else [*checked.program.grammars],
    }


def fmt(text: str) -> Answer:
    """What ``srgc fmt`` makes of the text, and whether that is something else."""
    from srgc.formatting.canonical_form import formatted

    made = formatted(text.encode("utf-8", "surrogatepass"), NAME)
    return {"text": made.after.decode("utf-8"), "changes": made.changes}


def explain(text: str, code: str) -> Answer:
    """The page of a code, or the list of all codes where none is given; the spec does not count."""
    del text
    from srgc.text_reports.findings_text import explanation, list_of_codes

    code = code.strip()
    return {"shown": explanation([code], colour=True) if code else list_of_codes()}


def graph(text: str, of: str, grammar: str, word: str, depth: int) -> Answer:
    """What ``srgc graph`` prints: a DOT text, and notes.

    Args:
        text: the spec.
        of: the view.
        grammar: its name; empty for the only one.
        word: of a robot its word, of others the word whose run is coloured; may be empty.
        depth: of words the most modules; 0 if it is not given.
    """
    from compiler.views.dot import to_dot
    from srgc.graphs.graph_request import GraphRequest, drawing_of

    symbols = tuple(word.split()) or None
    robot, run = (symbols, None) if of == "robot" else (None, symbols)
    request = GraphRequest(of, grammar or None, None, depth or None, run, None, robot)
    drawing = drawing_of(spec_of(text).program, request)
    return {"dot": to_dot(drawing.picture), "notes": [*drawing.remarks]}


def complete(text: str, at: int) -> Answer:
    """What the language server offers at a place, and where the word begins that it replaces."""
    from lsprotocol import types as lsp

    from srgc.language_server.completions.completion import completions

    spec = spec_of(text)
    offers = completions(spec.analysis, text, spec.offset(at))
    return {
        "start": spec.code_units(spec.start_of(offers)) if offers else at,
        "offers": [
            {
                "label": offer.label,
                "kind": ""
                if offer.kind is None
                else lsp.CompletionItemKind(offer.kind).name.lower(),
                "detail": offer.detail or "",
                "insert": offer.text_edit.new_text if offer.text_edit else offer.label,
                "snippet": offer.insert_text_format == SNIPPET,
            }
            for offer in offers
        ],
    }


SNIPPET = 2
"""``InsertTextFormat.Snippet`` of the Language Server Protocol."""


def hover(text: str, at: int) -> Answer | None:
    """What the language server says of a place, and of which part of the text; None for nothing."""
    from lsprotocol import types as lsp

    from srgc.language_server.hovers.hover import hover as hovered
    from srgc.language_server.hovers.hover import plain_text

    spec = spec_of(text)
    found = hovered(spec.analysis, 0, spec.offset(at))
    if found is None or not isinstance(found.contents, lsp.MarkupContent):
        return None
    start, end = (at, at) if found.range is None else spec.code_units_of(found.range)
    return {"text": plain_text(found.contents.value), "start": start, "end": end}


ANSWERS: Mapping[str, Callable[..., Answer | None]] = MappingProxyType(
    {each.__name__: each for each in (check, fmt, explain, graph, complete, hover)}
)
