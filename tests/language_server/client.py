"""A minimal client of the Language Server Protocol: frames, requests, notifications.

Written from the specification alone; it shares nothing with the server.
"""

from __future__ import annotations

import contextlib
import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

PATIENCE = 60.0


def uri_of(path: Path) -> str:
    return path.as_uri()


class Client:
    """A server as a subprocess, and what it says."""

    def __init__(self, *arguments: str, env: Mapping[str, str] | None = None) -> None:
        command = [sys.executable, "-m", "srgc", "lsp", *arguments]
        self.process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2]), **(env or {})},
        )
        self.messages: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self.notifications: list[dict[str, Any]] = []
        self.published: dict[str, list[dict[str, Any]]] = {}
        self.replies: dict[int | None, dict[str, Any]] = {}
        self.requests: list[dict[str, Any]] = []
        self.answers: dict[str, Callable[[Any], Any]] = {}
        self.log: list[bytes] = []
        self.versions: dict[str, int] = {}
        self.folder = Path()
        self._number = 0
        threading.Thread(target=self._read, daemon=True).start()
        self.reader = threading.Thread(target=self._read_log, daemon=True)
        self.reader.start()

    # --- frames --------------------------------------------------------------------------------

    def _read(self) -> None:
        stream = self.process.stdout
        assert stream is not None
        while True:
            length = None
            while (line := stream.readline()) not in {b"\r\n", b""}:
                name, _, value = line.partition(b":")
                assert value, f"no header: {line!r}"
                if name.lower() == b"content-length":
                    length = int(value)
            if length is None:
                self.messages.put(None)
                return
            self.messages.put(json.loads(stream.read(length)))

    def _read_log(self) -> None:
        assert self.process.stderr is not None
        self.log.extend(iter(self.process.stderr.readline, b""))

    def raw(self, data: bytes) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(data)
        self.process.stdin.flush()

    def send(self, message: Any) -> None:
        body = json.dumps(message).encode()
        self.raw(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))

    # --- messages ------------------------------------------------------------------------------

    def notify(self, method: str, params: Any = None) -> None:
        self.send({"jsonrpc": "2.0", "method": method, "params": params})

    def begin(self, method: str, params: Any = None) -> int:
        self._number += 1
        self.send({"jsonrpc": "2.0", "id": self._number, "method": method, "params": params})
        return self._number

    def next(self) -> dict[str, Any] | None:
        """The next message; requests of the server are answered at once."""
        message = self.messages.get(timeout=PATIENCE)
        if message is None:
            return None
        if "method" in message and "id" in message:
            self.requests.append(message)
            answer = self.answers.get(message["method"], lambda _: None)
            result = answer(message.get("params"))
            self.send({"jsonrpc": "2.0", "id": message["id"], "result": result})
        elif "method" in message:
            self.notifications.append(message)
            if message["method"] == "textDocument/publishDiagnostics":
                params = message["params"]
                self.published.setdefault(params["uri"], []).append(params)
        return message

    def response(self, number: int | None) -> dict[str, Any]:
        """The response to a request; others are kept."""
        while number not in self.replies:
            message = self.next()
            assert message is not None, b"".join(self.log).decode()
            if "method" not in message:
                self.replies[message.get("id")] = message
        return self.replies.pop(number)

    def ask(self, method: str, params: Any = None) -> Any:
        """The result of a request that succeeds."""
        answer = self.response(self.begin(method, params))
        assert "error" not in answer, answer
        return answer["result"]

    def error(self, method: str, params: Any = None) -> dict[str, Any]:
        """The error of a request that fails."""
        answer = self.response(self.begin(method, params))
        assert "result" not in answer, answer
        return answer["error"]

    def notified(self, method: str, test: Callable[[Any], bool] = lambda _: True) -> Any:
        """The parameters of the next notification of a kind."""
        while True:
            message = self.next()
            assert message is not None, b"".join(self.log).decode()
            if message.get("method") == method and test(message["params"]):
                return message["params"]

    # --- life ----------------------------------------------------------------------------------

    def initialize(self, folder: Path | None = None, **capabilities: Any) -> Any:
        uri = None if folder is None else uri_of(folder)
        result = self.ask(
            "initialize",
            {"processId": os.getpid(), "rootUri": uri, "capabilities": capabilities},
        )
        self.notify("initialized", {})
        return result

    def close(self) -> int:
        """Shut down in order; the exit status."""
        self.ask("shutdown")
        self.notify("exit")
        return self.process.wait(PATIENCE)

    def kill(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait(PATIENCE)
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            if stream is not None:
                with contextlib.suppress(OSError):
                    stream.close()

    # --- documents -----------------------------------------------------------------------------

    def open(self, uri: str, text: str) -> list[dict[str, Any]]:
        """Open a document; its findings."""
        self.versions[uri] = 1
        item = {"uri": uri, "languageId": "srg", "version": 1, "text": text}
        self.notify("textDocument/didOpen", {"textDocument": item})
        return self.findings(uri, 1)

    def change(self, uri: str, *changes: Any) -> int:
        """Change a document; its new version."""
        self.versions[uri] += 1
        document = {"uri": uri, "version": self.versions[uri]}
        params = {"textDocument": document, "contentChanges": list(changes)}
        self.notify("textDocument/didChange", params)
        return self.versions[uri]

    def findings(self, uri: str, version: int) -> list[dict[str, Any]]:
        """The next findings about a version of a document that were not asked for before."""
        while True:
            unread = self.published.setdefault(uri, [])
            while unread:
                params = unread.pop(0)
                if params.get("version") == version:
                    found: list[dict[str, Any]] = params["diagnostics"]
                    return found
            message = self.next()
            assert message is not None, b"".join(self.log).decode()

    def at(self, uri: str, line: int, character: int, **more: Any) -> dict[str, Any]:
        """The parameters of a request about a place."""
        position = {"line": line, "character": character}
        return {"textDocument": {"uri": uri}, "position": position, **more}
