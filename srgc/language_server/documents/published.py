"""Findings as an editor shows them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence, Set
from pathlib import Path

from lsprotocol import types as lsp

from grammar_lang.diagnostics.code_pages import FOLDER, has_page
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Diagnostic, Severity
from grammar_lang.source import Span
from srgc.language_server.documents.analysis import Analysis

_SEVERITIES = {
    Severity.ERROR: lsp.DiagnosticSeverity.Error,
    Severity.WARNING: lsp.DiagnosticSeverity.Warning,
    Severity.NOTE: lsp.DiagnosticSeverity.Information,
}
_FADED = frozenset({Code.UNUSED_NAME, Code.UNUSED_SYMBOL, Code.UNPRODUCTIVE, Code.UNREACHABLE})
"""An obstacle that nothing avoids is not among them: that is likely to be a mistake."""
MOST = 500
"""So many findings of a file are shown; errors come first."""

UriOf = Callable[[Path], str]


def code_link(code: Code) -> lsp.CodeDescription | None:
    """The page of a code, in the installed catalogue: no network is needed."""
    if not has_page(code):
        return None
    return lsp.CodeDescription((FOLDER / f"{code.value}.md").absolute().as_uri())


def _range(analysis: Analysis, span: Span) -> lsp.Range:
    """The range of a finding; what ends behind a line ends with the line."""
    return analysis.lines(span.file).range(span)


def _related(
    analysis: Analysis, found: Diagnostic, uri_of: UriOf
) -> list[lsp.DiagnosticRelatedInformation]:
    related: list[lsp.DiagnosticRelatedInformation] = []
    for span, text in found.notes:
        path = analysis.path(span.file)
        uri = analysis.name if path is None else uri_of(path)
        location = lsp.Location(uri, _range(analysis, span))
        related.append(lsp.DiagnosticRelatedInformation(location, text))
    return related


def as_diagnostic(analysis: Analysis, found: Diagnostic, uri_of: UriOf) -> lsp.Diagnostic:
    """A finding; its hint ends the message, and is ``data`` for the quick fixes."""
    message = found.message if found.hint is None else f"{found.message}\nhint: {found.hint}"
    return lsp.Diagnostic(
        range=_range(analysis, found.span),
        message=message,
        severity=_SEVERITIES[found.severity],
        code=found.code.value,
        code_description=code_link(found.code),
        source="srgc",
        tags=[lsp.DiagnosticTag.Unnecessary] if found.code in _FADED else None,
        related_information=_related(analysis, found, uri_of) or None,
        data={"hint": found.hint} if found.hint else None,
    )


def _told(found: Iterable[Diagnostic]) -> list[Diagnostic]:
    ranks = list(Severity)
    return sorted(found, key=lambda each: ranks.index(each.severity))[:MOST]


def diagnostics_of(analyses: Sequence[Analysis], place: str, uri_of: UriOf) -> list[lsp.Diagnostic]:
    """The findings about one file, each once, as a part of every program that it belongs to.

    Args:
        analyses: the programs.
        place: the path of the file without links, or the URI of a document.
        uri_of: gives the client's URI of a file.

    Only those are given that are known: ask for ``findings`` before, to have all.
    """
    texts: dict[tuple[object, ...], lsp.Diagnostic] = {}
    for analysis in analyses:
        number = analysis.number(place)
        for found in _told(d for d in analysis.known_findings if d.span.file == number):
            key = (found.code, found.span.start, found.span.end, found.message)
            if key not in texts:
                texts[key] = as_diagnostic(analysis, found, uri_of)
    return [*texts.values()]


def errors_beside(
    analyses: Sequence[Analysis], opened: Set[str], uri_of: UriOf
) -> dict[str, list[lsp.Diagnostic]]:
    """The errors of those files of some programs that are not open, by the URIs of the files.

    Args:
        analyses: the programs.
        opened: the paths without links of the open files.
        uri_of: gives the client's URI of a file.
    """
    errors: dict[str, list[lsp.Diagnostic]] = {}
    for analysis in analyses:
        for place in analysis.places:
            number = analysis.number(place)
            path = None if number is None or place in opened else analysis.path(number)
            if path is None:
                continue
            here = (d for d in analysis.known_findings if d.span.file == number)
            told = _told(d for d in here if d.severity is Severity.ERROR)
            known = errors.setdefault(uri_of(path), [])
            shown = [as_diagnostic(analysis, found, uri_of) for found in told]
            known += [each for each in shown if each not in known]
    return errors
