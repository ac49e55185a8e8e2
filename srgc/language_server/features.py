"""The requests of an editor; each method answers one of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeVar

from lsprotocol import types as lsp

from grammar_lang.files.file_tree import LIMIT
from srgc.language_server.completions.completion import completions, signature
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.documents.open_documents import Document
from srgc.language_server.documents.places import definition, highlights, references
from srgc.language_server.documents.programs import Programs, holding
from srgc.language_server.edits.quick_fixes import format_edits, quick_fixes
from srgc.language_server.edits.rename import RenameRefused, renamable, rename
from srgc.language_server.hovers.hover import hover, plain_text
from srgc.language_server.outlines.outline import folding, include_links, outline, workspace_symbols
from srgc.language_server.outlines.semantic_tokens import semantic_tokens
from srgc.language_server.protocol import RequestRefused

Answer = TypeVar("Answer")


class _Placed(Protocol):
    """A request about a position in a document."""

    text_document: lsp.TextDocumentIdentifier
    position: lsp.Position


@dataclass(slots=True)
class Features:
    """The answers to requests about open documents; requests about others get no result."""

    programs: Programs
    snippets: bool = True
    markdown: bool = True
    """Whether the client shows Markdown in hovers."""

    def _document(self, uri: str) -> Document | None:
        document = self.programs.documents.get(uri)
        return document if document is not None and len(document.text) <= LIMIT else None

    async def _at(
        self,
        params: _Placed,
        function: Callable[[Analysis, int, int], Answer],
    ) -> Answer | None:
        """Apply a function to a program, the document's number in it, and an offset."""
        document = self._document(params.text_document.uri)
        if document is None:
            return None
        offset = document.lines.offset(params.position)
        found = holding(await self.programs.of(document.uri), document.real)
        return None if found is None else function(found[0], found[1], offset)

    async def _in(
        self, uri: str, function: Callable[[Analysis, int], list[Answer]]
    ) -> list[Answer]:
        """Apply a function to a program and the document's number in it."""
        document = self._document(uri)
        found = None
        if document is not None:
            found = holding(await self.programs.of(uri), document.real)
        return [] if found is None else function(*found)

    # --- Names ---------------------------------------------------------------------------------

    async def hover(self, params: lsp.HoverParams) -> lsp.Hover | None:
        """The hover text for a position."""
        found = await self._at(params, hover)
        if self.markdown or found is None or not isinstance(found.contents, lsp.MarkupContent):
            return found
        text = plain_text(found.contents.value)
        return lsp.Hover(lsp.MarkupContent(lsp.MarkupKind.PlainText, text), found.range)

    async def definition(self, params: lsp.DefinitionParams) -> list[lsp.Location]:
        """The declarations of the name at a position."""
        uri_of = self.programs.documents.uri
        return await self._at(params, lambda a, n, o: definition(a, n, o, uri_of)) or []

    async def references(self, params: lsp.ReferenceParams) -> list[lsp.Location]:
        """The places where the entity at a position is named."""
        document = self._document(params.text_document.uri)
        if document is None:
            return []
        offset = document.lines.offset(params.position)
        analyses = await self.programs.of(document.uri)
        return references(
            analyses,
            document.real,
            offset,
            self.programs.documents.uri,
            declarations=params.context.include_declaration,
        )

    async def highlights(self, params: lsp.DocumentHighlightParams) -> list[lsp.DocumentHighlight]:
        """The places of a name in its document."""
        return await self._at(params, highlights) or []

    async def prepare_rename(self, params: lsp.PrepareRenameParams) -> lsp.Range | None:
        """The range of the name at a position, if it can be renamed.

        Raises:
            RequestRefused: nothing there can be renamed; the message says why.
        """

        def prepared(analysis: Analysis, number: int, offset: int) -> lsp.Range | None:
            found = renamable(analysis, number, offset)
            return None if found is None else analysis.lines(number).range(found.span)

        try:
            return await self._at(params, prepared)
        except RenameRefused as refused:
            raise RequestRefused(str(refused)) from None

    async def rename(self, params: lsp.RenameParams) -> lsp.WorkspaceEdit | None:
        """The edits for a new name.

        Raises:
            RequestRefused: the name cannot be changed like that; the message says why.
        """
        document = self._document(params.text_document.uri)
        if document is None:
            return None
        documents = self.programs.documents
        offset = document.lines.offset(params.position)
        analyses = await self.programs.of(document.uri)
        held, place, uri_of = documents.files(), document.real, documents.uri
        try:
            return await self.programs.work(
                rename, analyses, place, offset, params.new_name, held, uri_of
            )
        except RenameRefused as refused:
            raise RequestRefused(str(refused)) from None

    # --- Writing -------------------------------------------------------------------------------

    async def completion(self, params: lsp.CompletionParams) -> lsp.CompletionList:
        """The completions at a position."""
        document = self._document(params.text_document.uri)
        if document is None:
            return lsp.CompletionList(is_incomplete=False, items=[])
        text, offset = document.text, document.lines.offset(params.position)

        def offered(analysis: Analysis, number: int, _: int) -> list[lsp.CompletionItem]:
            return completions(analysis, text, offset, number, snippets=self.snippets)

        return lsp.CompletionList(is_incomplete=False, items=await self._at(params, offered) or [])

    def signature(self, params: lsp.SignatureHelpParams) -> lsp.SignatureHelp | None:
        """The signature of the call that is being written."""
        document = self._document(params.text_document.uri)
        if document is None:
            return None
        return signature(document.text, document.lines.offset(params.position))

    def formatting(self, params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
        """The edits to the canonical form."""
        document = self._document(params.text_document.uri)
        return [] if document is None else format_edits(document.text, document.lines)

    def quick_fixes(self, params: lsp.CodeActionParams) -> list[lsp.CodeAction]:
        """The quick fixes for diagnostics."""
        document = self._document(params.text_document.uri)
        only = params.context.only
        if document is None or (only and not any(_wants_fixes(kind) for kind in only)):
            return []
        place = document.lines.offset
        return quick_fixes(document.uri, document.text, place, params.context.diagnostics)

    # --- The document as a whole ---------------------------------------------------------------

    async def outline(self, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
        """The items of the document, with their declarations."""
        return await self._in(params.text_document.uri, outline)

    async def symbols(self, params: lsp.WorkspaceSymbolParams) -> list[lsp.WorkspaceSymbol]:
        """The declarations in all programs that match a query."""
        analyses = await self.programs.everything()
        return workspace_symbols(analyses, params.query, self.programs.documents.uri)

    def folding(self, params: lsp.FoldingRangeParams) -> list[lsp.FoldingRange]:
        """The ranges that can be folded."""
        document = self._document(params.text_document.uri)
        return [] if document is None else folding(document.text, document.lines)

    async def tokens(self, params: lsp.SemanticTokensParams) -> lsp.SemanticTokens:
        """The semantic tokens of the document."""
        found = await self._in(params.text_document.uri, lambda a, n: [semantic_tokens(a, n)])
        return found[0] if found else lsp.SemanticTokens([])

    async def links(self, params: lsp.DocumentLinkParams) -> list[lsp.DocumentLink]:
        """The links to the files that the document names."""
        uri_of = self.programs.documents.uri
        return await self._in(params.text_document.uri, lambda a, n: include_links(a, n, uri_of))


def _wants_fixes(kind: str) -> bool:
    return lsp.CodeActionKind.QuickFix.value in {str(kind), str(getattr(kind, "value", kind))}
