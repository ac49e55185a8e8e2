"""The server: connects each request with the function that answers it."""

from __future__ import annotations

import logging
from typing import Any

from lsprotocol import types as lsp
from pygls.capabilities import ServerCapabilitiesBuilder
from pygls.exceptions import JsonRpcException, JsonRpcInternalError
from pygls.lsp.server import LanguageServer

from srgc.language_server.documents.programs import Programs
from srgc.language_server.documents.projects import is_folder
from srgc.language_server.documents.published import Publishing
from srgc.language_server.documents.uris import path_of
from srgc.language_server.features import Features
from srgc.language_server.outlines.semantic_tokens import LEGEND
from srgc.language_server.protocol import Protocol
from srgc.language_server.tasks.task_commands import (
    CHECK,
    SYNTH,
    VERIFY,
    TaskCommands,
    kind_of,
    task_lenses,
)
from srgc.language_server.tasks.verdicts import Verdicts
from srgc.version import VERSION

_FOLDERS = ("**/out", "**/out/*")
"""If a whole folder is removed, editors do not report the files in it."""
_WATCHED = (
    *(lsp.FileSystemWatcher(one) for one in ("**/*.srg", "**/design.json", "**/certificate.json")),
    *(lsp.FileSystemWatcher(one, lsp.WatchKind.Delete) for one in _FOLDERS),
)


class Server(LanguageServer):
    """A server for one client."""

    protocol: Protocol

    def __init__(self) -> None:
        super().__init__("srgc", VERSION, protocol_cls=Protocol)
        self.programs = Programs()
        self.features = Features(self.programs)
        self.publishing = Publishing(self, self.programs)
        self.verdicts = Verdicts()
        self.commands = TaskCommands(self, self.programs, self.verdicts, self.refresh_lenses)
        _connect_life(self)
        _connect_documents(self)
        _connect_features(self)
        _connect_tasks(self)

    def report_server_error(self, error: Exception, source: Any) -> None:
        """Log errors of the server; mistakes of the client are not logged."""
        del source
        if isinstance(error, JsonRpcInternalError):
            told = error.data.get("traceback", []) if isinstance(error.data, dict) else []
            logging.getLogger(__name__).error("%s\n%s", error, "".join(told))
        elif not isinstance(error, JsonRpcException):
            logging.getLogger(__name__).error("%s", error, exc_info=error)

    @property
    def stopped(self) -> bool:
        """Whether the client has requested shutdown."""
        return self.protocol.stopped

    def close(self) -> None:
        """End all work."""
        self.publishing.stop()
        self.commands.jobs.stop()
        self.programs.close()

    def refresh_lenses(self) -> None:
        """Ask the client to request lenses again, if it supports that."""
        workspace = self.client_capabilities.workspace
        lens = None if workspace is None else workspace.code_lens
        if lens is not None and lens.refresh_support:
            self.workspace_code_lens_refresh(None)

    def started(self, params: lsp.InitializeParams) -> None:
        """Store the capabilities and folders that the client has sent."""
        capabilities = params.capabilities
        encoding = ServerCapabilitiesBuilder.choose_position_encoding(capabilities)
        self.programs.documents.encoding = str(getattr(encoding, "value", encoding))
        uris = [folder.uri for folder in params.workspace_folders or []]
        if not uris and params.root_uri:
            uris = [params.root_uri]
        self.programs.folders = [p for p in map(path_of, uris) if p is not None and is_folder(p)]
        text = capabilities.text_document
        item = None
        if text is not None and text.completion is not None:
            item = text.completion.completion_item
        self.features.snippets = item is not None and bool(item.snippet_support)
        shown = None if text is None or text.hover is None else text.hover.content_format
        self.features.markdown = not shown or lsp.MarkupKind.Markdown in shown

    def watch(self) -> None:
        """Ask the client to report files that change on disk."""
        workspace = self.client_capabilities.workspace
        watched = None if workspace is None else workspace.did_change_watched_files
        if watched is None or not watched.dynamic_registration:
            return
        options = lsp.DidChangeWatchedFilesRegistrationOptions(_WATCHED)
        method = lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES
        registration = lsp.Registration("srgc-files", method, options)
        self.client_register_capability(lsp.RegistrationParams([registration]))

    def folders_changed(self, event: lsp.WorkspaceFoldersChangeEvent) -> None:
        """Update the folders of the workspace."""
        gone = {path_of(folder.uri) for folder in event.removed}
        new = [path_of(folder.uri) for folder in event.added]
        kept = [path for path in self.programs.folders if path not in gone]
        self.programs.folders = [*kept, *(p for p in new if p is not None and is_folder(p))]
        self.programs.disk_changed()
        self.publishing.all_soon()


def _connect_life(server: Server) -> None:
    @server.feature(lsp.INITIALIZE)
    def _(params: lsp.InitializeParams) -> None:
        server.started(params)

    @server.feature(lsp.INITIALIZED)
    def _(params: lsp.InitializedParams) -> None:
        del params
        server.watch()

    @server.feature(lsp.SHUTDOWN)
    def _(params: None) -> None:
        del params
        server.close()

    @server.feature(lsp.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS)
    def _(params: lsp.DidChangeWorkspaceFoldersParams) -> None:
        server.folders_changed(params.event)

    @server.feature(lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES)
    def _(params: lsp.DidChangeWatchedFilesParams) -> None:
        server.programs.disk_changed()
        if any(change.uri.endswith(".srg") for change in params.changes):
            server.publishing.all_soon()
        server.refresh_lenses()  # results arrive together with their copy of the text


def _connect_documents(server: Server) -> None:
    documents, programs = server.programs.documents, server.programs

    @server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
    def _(params: lsp.DidOpenTextDocumentParams) -> None:
        document = params.text_document
        documents.open(document.uri, document.text, document.version)
        programs.disk_changed()
        server.publishing.soon(document.uri, 0)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
    def _(params: lsp.DidChangeTextDocumentParams) -> None:
        document = params.text_document
        documents.change(document.uri, document.version, params.content_changes)
        if documents.get(document.uri) is not None:
            server.publishing.soon(document.uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_SAVE)
    def _(params: lsp.DidSaveTextDocumentParams) -> None:
        del params
        programs.disk_changed()
        server.refresh_lenses()

    @server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
    def _(params: lsp.DidCloseTextDocumentParams) -> None:
        documents.close(params.text_document.uri)
        programs.disk_changed()
        server.publishing.closed(params.text_document.uri)
        server.publishing.all_soon()


def _connect_features(server: Server) -> None:
    features = server.features
    symbols = lsp.WorkspaceSymbolOptions(resolve_provider=False)
    completion = lsp.CompletionOptions(trigger_characters=[".", '"', "/", ">"])
    signature = lsp.SignatureHelpOptions(trigger_characters=["(", ","])
    actions = lsp.CodeActionOptions([lsp.CodeActionKind.QuickFix])
    renames = lsp.RenameOptions(prepare_provider=True)
    table: tuple[tuple[str, Any, Any], ...] = (
        (lsp.TEXT_DOCUMENT_HOVER, features.hover, None),
        (lsp.TEXT_DOCUMENT_DEFINITION, features.definition, None),
        (lsp.TEXT_DOCUMENT_REFERENCES, features.references, None),
        (lsp.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT, features.highlights, None),
        (lsp.TEXT_DOCUMENT_PREPARE_RENAME, features.prepare_rename, None),
        (lsp.TEXT_DOCUMENT_RENAME, features.rename, renames),
        (lsp.TEXT_DOCUMENT_COMPLETION, features.completion, completion),
        (lsp.TEXT_DOCUMENT_SIGNATURE_HELP, features.signature, signature),
        (lsp.TEXT_DOCUMENT_FORMATTING, features.formatting, None),
        (lsp.TEXT_DOCUMENT_CODE_ACTION, features.quick_fixes, actions),
        (lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL, features.outline, None),
        (lsp.WORKSPACE_SYMBOL, features.symbols, symbols),
        (lsp.TEXT_DOCUMENT_FOLDING_RANGE, features.folding, None),
        (lsp.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL, features.tokens, LEGEND),
        (lsp.TEXT_DOCUMENT_DOCUMENT_LINK, features.links, None),
    )
    for method, function, options in table:
        server.feature(method, options)(_handler(function))


def _handler(function: Any) -> Any:
    """Wrap a function so that pygls can set attributes, which bound methods do not allow."""
    import asyncio

    if asyncio.iscoroutinefunction(function):

        async def later(params: Any) -> Any:
            return await function(params)

        return later

    def now(params: Any) -> Any:
        return function(params)

    return now


def _connect_tasks(server: Server) -> None:
    commands = server.commands

    @server.feature(lsp.TEXT_DOCUMENT_CODE_LENS)
    async def _(params: lsp.CodeLensParams) -> list[lsp.CodeLens]:
        uri = params.text_document.uri
        document = server.programs.documents.get(uri)
        for analysis in [] if document is None else await server.programs.of(uri):
            number = None if document is None else analysis.number(document.real)
            if number is not None:
                return task_lenses(analysis, number, uri, server.verdicts, commands.running)
        return []

    @server.command(CHECK)
    async def _(uri: str, task: str, *kind: str) -> dict[str, Any]:
        return await commands.check(uri, task, kind_of(kind))

    @server.command(SYNTH)
    async def _(uri: str, task: str, *kind: str) -> dict[str, Any]:
        return await commands.synth(uri, task, kind_of(kind))

    @server.command(VERIFY)
    async def _(uri: str, task: str, *kind: str) -> dict[str, Any]:
        return await commands.verify(uri, task, kind_of(kind))
