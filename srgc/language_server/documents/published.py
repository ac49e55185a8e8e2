"""Diagnostics in the form that editors show, and when to publish them."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass, field
from typing import TypeAlias

from lsprotocol import types as lsp
from pygls.lsp.server import LanguageServer

from grammar_lang.diagnostics.code_pages import FOLDER, has_page
from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Severity
from grammar_lang.source import Span
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.documents.open_documents import Document
from srgc.language_server.documents.programs import Programs
from srgc.language_server.documents.uris import UriOf

# --- Diagnostics in the form that editors show ----------------------------------------------------


_SEVERITIES = {
    Severity.ERROR: lsp.DiagnosticSeverity.Error,
    Severity.WARNING: lsp.DiagnosticSeverity.Warning,
    Severity.NOTE: lsp.DiagnosticSeverity.Information,
}
_FADED = frozenset({Code.UNUSED_NAME, Code.UNUSED_SYMBOL, Code.UNPRODUCTIVE, Code.UNREACHABLE})
"""Obstacles that nothing avoids are not in this set: they are probably mistakes."""
MOST = 500
"""The number of diagnostics of a file to show; errors come first."""


def code_link(code: Code) -> lsp.CodeDescription | None:
    """A link to the page of a code in the installed catalogue, which needs no network."""
    if not has_page(code):
        return None
    return lsp.CodeDescription((FOLDER / f"{code.value}.md").absolute().as_uri())


def _range(analysis: Analysis, span: Span) -> lsp.Range:
    """The range of a diagnostic; one that ends beyond a line ends with the line."""
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
    """A diagnostic; its hint ends the message, and is ``data`` for the quick fixes."""
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
    """The diagnostics about one file, each once, from all programs that it belongs to.

    Args:
        analyses: the programs.
        place: the resolved path of the file, or the URI of a document.
        uri_of: gives the client's URI of a file.

    Only diagnostics that are already known are given: to have all of them, ask for ``findings``
    first.
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
    """The errors in those files of some programs that are not open, by the URIs of the files.

    Args:
        analyses: the programs.
        opened: the resolved paths of the open files.
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


# --- Publishing while the user types: soon, not at every key, and never about an outdated text ----
#
# For files that are not open but belong to the program of an open one, errors are published, too,
# as ``srgc check`` prints them.


DEBOUNCE = 0.12
"""Seconds without a change before a text is checked."""
_PATIENCE = 0.4
"""Seconds after which the diagnostics known by then are shown."""


_Shown: TypeAlias = tuple[int, list[lsp.Diagnostic]]
"""The version of a document and the diagnostics published about it."""
_Errors: TypeAlias = dict[str, list[lsp.Diagnostic]]
"""Errors by the URI of their file."""


@dataclass(slots=True)
class Publishing:
    """Publishes the diagnostics of open documents, with one task per document.

    ``_beside`` has, for every open document, the errors in files of its programs that are not open,
    by URI; ``_told`` has the errors published about such files.
    """

    server: LanguageServer
    programs: Programs
    _tasks: dict[str, asyncio.Task[None]] = field(default_factory=dict[str, asyncio.Task[None]])
    _shown: dict[str, _Shown] = field(default_factory=dict[str, _Shown])
    _beside: dict[str, _Errors] = field(default_factory=dict[str, _Errors])
    _told: _Errors = field(default_factory=dict[str, list[lsp.Diagnostic]])

    def soon(self, uri: str, wait: float = DEBOUNCE) -> None:
        """Schedule a check of a document after it, or a program with it, has changed."""
        old = self._tasks.get(uri)
        if old is not None:
            old.cancel()
        self._tasks[uri] = asyncio.get_running_loop().create_task(self._later(uri, wait))

    def all_soon(self) -> None:
        """Schedule a check of all documents."""
        for document in [*self.programs.documents]:
            self.soon(document.uri)

    def closed(self, uri: str) -> None:
        """Withdraw the diagnostics of a document that was closed."""
        old = self._tasks.pop(uri, None)
        if old is not None:
            old.cancel()
        if self._shown.pop(uri, (0, []))[1]:
            self._publish(uri, None, [])
        self._beside.pop(uri, None)
        self._tell_beside()

    def stop(self) -> None:
        """Stop publishing."""
        for task in self._tasks.values():
            task.cancel()

    async def _later(self, uri: str, wait: float) -> None:
        await asyncio.sleep(wait)
        try:
            await self._now(uri)
        except Exception:
            logging.getLogger(__name__).exception("the findings of %s", uri)

    async def _now(self, uri: str) -> None:
        analyses = await self.programs.of(uri)
        work = asyncio.ensure_future(self.programs.work(_find_all, analyses))
        done, _ = await asyncio.wait([work], timeout=_PATIENCE)
        if not done:
            self._show(analyses, uri)
            await work
        else:
            work.result()
        self._show(analyses, uri)

    def _show(self, analyses: list[Analysis], uri: str) -> None:
        """Publish what is known about a document and the other documents of its programs."""
        documents = self.programs.documents
        places = {place for analysis in analyses for place in analysis.places}
        for document in [*documents]:
            if document.uri == uri or document.real in places:
                self._show_one(analyses, document, own=document.uri == uri)
        if documents.get(uri) is not None:
            opened = {document.real for document in documents}
            self._beside[uri] = errors_beside(analyses, opened, documents.uri)
        self._tell_beside()

    def _tell_beside(self) -> None:
        """Publish new errors of files that are not open, and withdraw outdated ones."""
        found: _Errors = {uri: [] for uri in self._told}
        for errors in self._beside.values():
            for uri, each in errors.items():
                known = found.get(uri, [])
                found[uri] = known + [error for error in each if error not in known]
        for uri, each in found.items():
            if self.programs.documents.get(uri) is None and self._told.get(uri, []) != each:
                self._publish(uri, None, each)
        closed = {uri for uri in found if self.programs.documents.get(uri) is None}
        self._told = {uri: each for uri, each in found.items() if each and uri in closed}

    def _show_one(self, analyses: list[Analysis], document: Document, *, own: bool) -> None:
        numbers = [analysis.number(document.real) for analysis in analyses]
        pairs = zip(analyses, numbers, strict=True)
        if any(n is not None and a.sources[n].text != document.text for a, n in pairs):
            return  # it has changed, and its own task will publish
        if not own and any(number is None for number in numbers):
            self.soon(document.uri)  # it is part of other programs, too
            return
        found = diagnostics_of(analyses, document.real, self.programs.documents.uri)
        if self._shown.get(document.uri) != (document.version, found):
            self._shown[document.uri] = (document.version, found)
            self._publish(document.uri, document.version, found)

    def _publish(self, uri: str, version: int | None, found: Iterable[lsp.Diagnostic]) -> None:
        self.server.text_document_publish_diagnostics(
            lsp.PublishDiagnosticsParams(uri, [*found], version)
        )


def _find_all(analyses: list[Analysis]) -> None:
    for analysis in analyses:
        _ = analysis.findings
