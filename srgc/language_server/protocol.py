"""JSON-RPC on top of pygls, as JSON-RPC 2.0 and LSP 3.17 specify it.

pygls leaves some messages unanswered: text that is not JSON, requests with wrong parameters, and
requests before ``initialize`` or after ``shutdown``.  Here each of them gets an error.  Documents
are not stored twice: the copies that pygls keeps are never made.
"""

from __future__ import annotations

import json
from typing import Any

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException
from pygls.protocol import LanguageServerProtocol, lsp_method

from srgc.language_server.documents.uris import is_malformed

_PARSE_ERROR = lsp.ErrorCodes.ParseError.value
_INVALID_REQUEST = lsp.ErrorCodes.InvalidRequest.value
_INVALID_PARAMS = lsp.ErrorCodes.InvalidParams.value
_NOT_INITIALIZED = lsp.ErrorCodes.ServerNotInitialized.value


class Answered(Exception):
    """A message that has already been answered."""


class RequestRefused(JsonRpcException):
    """A request that cannot be carried out; the message is for the user."""

    CODE = lsp.LSPErrorCodes.RequestFailed.value
    MESSAGE = "Request failed"


class Protocol(LanguageServerProtocol):
    """The protocol of one connection."""

    initialized = False
    stopped = False

    def refuse(self, request: Any, code: int, message: str) -> None:
        """Answer a request with an error; ``request`` is None for a message that is no request."""
        self._send_data(
            {"jsonrpc": "2.0", "id": request, "error": {"code": code, "message": message}}
        )

    def receive(self, body: bytes) -> None:
        """Handle the body of a message; an unreadable one is answered with an error."""
        try:
            message = json.loads(body)
            # The form of objects within the parameters does not matter here.
            found = self.structure_message(message) if isinstance(message, dict) else message
            self.handle_message(found)
        except Exception as error:
            self._refuse_unreadable(error)

    def structure_message(self, data: dict[str, Any]) -> Any:
        """The message in an object; a malformed request is refused with an error."""
        try:
            return super().structure_message(data)
        except Exception as error:
            if "method" in data and isinstance(data.get("id"), int | str):
                self.refuse(data["id"], _INVALID_PARAMS, f"wrong parameters: {data['method']}")
            raise Answered from error

    def _refuse_unreadable(self, error: Exception) -> None:
        """Answer a message that could not be handled, unless it has been answered already."""
        if isinstance(error, Answered):
            return
        if isinstance(error, json.JSONDecodeError | UnicodeDecodeError | RecursionError):
            self.refuse(None, _PARSE_ERROR, "this is no JSON")
        else:
            self.refuse(None, _INVALID_REQUEST, "this is no message")

    def handle_message(self, message: Any) -> None:
        """Handle a message if the state of the connection allows it."""
        if not hasattr(message, "jsonrpc"):
            self.refuse(None, _INVALID_REQUEST, "this is no message")
            return
        method = getattr(message, "method", None)
        request = getattr(message, "id", None) if method is not None else None
        if request is not None and message.jsonrpc != self.VERSION:
            self.refuse(request, _INVALID_REQUEST, "this is not JSON-RPC 2.0")
        elif method == lsp.EXIT:
            try:
                super().handle_message(message)
            finally:
                self.writer = None  # results that arrive later are discarded
        elif method is None:
            super().handle_message(message)
        elif self.stopped:
            if request is not None:
                self.refuse(request, _INVALID_REQUEST, "the server is shut down")
        elif not self.initialized and method != lsp.INITIALIZE:
            if request is not None:
                self.refuse(request, _NOT_INITIALIZED, "the server is not initialized")
        elif self.initialized and method == lsp.INITIALIZE:
            self.refuse(request, _INVALID_REQUEST, "the server is initialized already")
        else:
            self.initialized = True
            self.stopped = method == lsp.SHUTDOWN
            super().handle_message(message)

    @lsp_method(lsp.INITIALIZE)
    def lsp_initialize(self, params: lsp.InitializeParams) -> Any:
        """Initialise as pygls does, but without folders that are not URIs, on which pygls fails."""
        params.root_path = None
        if params.root_uri and is_malformed(params.root_uri):
            params.root_uri = None
        params.workspace_folders = [
            folder for folder in params.workspace_folders or [] if not is_malformed(folder.uri)
        ]
        return (yield from super().lsp_initialize(params))

    @lsp_method(lsp.SHUTDOWN)
    def lsp_shutdown(self, *args: Any) -> Any:
        """Shut down as pygls does, but answer even if other requests are running."""
        yield self.fm.features[lsp.SHUTDOWN], args, None
        own = self.msg_id
        for request, future in [*self._request_futures.items()]:
            if request != own:
                future.cancel()
        self._shutdown = True

    def _run_generator(self, future: Any, *, gen: Any, result_future: Any) -> None:
        """Run as pygls does; work that was cancelled at the end of the loop has no result."""
        if future is None or not future.cancelled():
            super()._run_generator(future, gen=gen, result_future=result_future)

    # --- Documents: only ``OpenDocuments`` keeps them --------------------------------------------

    @lsp_method(lsp.TEXT_DOCUMENT_DID_OPEN)
    def lsp_text_document__did_open(self, params: lsp.DidOpenTextDocumentParams) -> Any:
        """Handle that a document was opened."""
        yield self.fm.features[lsp.TEXT_DOCUMENT_DID_OPEN], (params,), None

    @lsp_method(lsp.TEXT_DOCUMENT_DID_CHANGE)
    def lsp_text_document__did_change(self, params: lsp.DidChangeTextDocumentParams) -> Any:
        """Handle that a document was changed."""
        yield self.fm.features[lsp.TEXT_DOCUMENT_DID_CHANGE], (params,), None

    @lsp_method(lsp.TEXT_DOCUMENT_DID_CLOSE)
    def lsp_text_document__did_close(self, params: lsp.DidCloseTextDocumentParams) -> Any:
        """Handle that a document was closed."""
        yield self.fm.features[lsp.TEXT_DOCUMENT_DID_CLOSE], (params,), None
