"""Answer the requests of the page about a text, as the commands and the language server do.

All of this runs in the worker of a browser, which has no processes, threads, sockets or files, and
of the native libraries only python-flint.  If an import fails, the answer names the library; the
page fetches it, if it can, and repeats the request.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from srgc.faults import NoAnswer, SpecErrors, UsageFault
from srgc.playground.spec import NAME, spec_of

Answer = dict[str, Any]

FETCHED = {
    "flint": "flint",
    "compiler": "srgc",
    "grammar_lang": "srgc",
    "solvers": "srgc",
    "srgc": "srgc",
}
"""What the page fetches when a text needs it: a library, or those modules of srgc that its first
archive does not have."""
COMMANDS = "run `srgc` on this file instead"


def answer(request: str) -> str:
    """The answer to a request, both as JSON objects; no exception leaves this function.

    Args:
        request: ``ask`` names the function below, ``text`` is the spec, and the rest are the
            function's arguments.  Places count UTF-16 code units from the start of the text.

    Returns:
        ``answer`` with the result, ``fault`` with a message, or ``needs`` with the name of a
        library that has to be loaded first.
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
        return {"needs": FETCHED[library]}
    return {"fault": f"error: this needs {library}, which no browser has; {COMMANDS}"}


def _message(error: Exception) -> str:
    """The message that the command line prints."""
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
    """The output of ``srgc check``, its JSON, places for the editor, and what was not checked."""
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
    """The output of ``srgc fmt``, and whether it differs from the text."""
    from srgc.formatting.canonical_form import formatted

    made = formatted(text.encode("utf-8", "surrogatepass"), NAME)
    return {"text": made.after.decode("utf-8"), "changes": made.changes}


def explain(text: str, code: str) -> Answer:
    """The page of a code, or the list of codes if ``code`` is empty; the spec is not used."""
    del text
    from srgc.text_reports.findings_text import explanation, list_of_codes

    code = code.strip()
    return {"shown": explanation([code], colour=True) if code else list_of_codes()}


def graph(text: str, of: str, grammar: str, word: str, depth: int) -> Answer:
    """The output of ``srgc graph``: a DOT text and notes.

    Args:
        text: the spec.
        of: the view.
        grammar: its name; empty for the only one.
        word: the word of a robot; in other views, the word whose run is coloured.  May be empty.
        depth: the most modules of a word; 0 for the default.
    """
    from compiler.views.dot import to_dot
    from srgc.graphs.graph_request import GraphRequest, drawing_of

    symbols = tuple(word.split()) or None
    robot, run = (symbols, None) if of == "robot" else (None, symbols)
    request = GraphRequest(of, grammar or None, None, depth or None, run, None, robot)
    drawing = drawing_of(spec_of(text).program, request)
    return {"dot": to_dot(drawing.picture), "notes": [*drawing.remarks]}


def complete(text: str, at: int) -> Answer:
    """The language server's completions at a place, and the start of the word that they replace."""
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
    """The language server's hover text for a place, and its range; None if there is no text."""
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
