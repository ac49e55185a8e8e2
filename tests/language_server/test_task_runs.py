"""The lenses' commands: a synthesis with progress, its verdict, and one that is cancelled."""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from srgc.language_server.documents.analysis import analyse
from srgc.language_server.documents.uris import uri_of
from srgc.language_server.tasks.task_commands import task_lenses
from srgc.language_server.tasks.verdicts import Verdicts
from tests.language_server.client import PATIENCE, Client
from tests.oracles.small_specs import SLIDER, TURNER
from tests.oracles.some_cases import some

LONG = TURNER.replace("modules <= 1", "").replace("effort <= 10 N*m", "effort <= 1e-9 N*m")
"""Any number of modules with drives too weak for all of them: a search that does not end."""


def titles(client: Client, uri: str) -> list[str]:
    lenses = client.ask("textDocument/codeLens", {"textDocument": {"uri": uri}})
    return [lens["command"]["title"] for lens in lenses]


def command(name: str, uri: str, task: str = "Turn") -> dict[str, Any]:
    return {"command": name, "arguments": [uri, task]}


def test_synthesis(client: Client) -> None:
    path = client.folder / "slider.srg"
    path.write_text(SLIDER, encoding="utf-8", newline="")
    uri = uri_of(path)
    client.open(uri, SLIDER)
    assert titles(client, uri) == ["check", "synth"]
    answer = client.ask("workspace/executeCommand", command("srgc.synth", uri, "Slide"))
    assert answer == {"verdict": "found", "status": 0}
    design = json.loads((client.folder / "out" / "Slide" / "design.json").read_text("utf-8"))
    found = f"found: {' '.join(design['word'])} (verified)"
    assert titles(client, uri) == ["check", "synth", found]
    kinds = [
        message["params"]["value"]["kind"]
        for message in client.notifications
        if message["method"] == "$/progress"
    ]
    assert kinds[0] == "begin"
    assert kinds.count("begin") == kinds.count("end") == 2
    assert "report" in kinds
    asked = {message["method"] for message in client.requests}
    assert asked == {"window/workDoneProgress/create", "workspace/codeLens/refresh"}
    # A blank more, and the verdict is about another text.
    at = {"line": 0, "character": 0}
    client.change(uri, {"range": {"start": at, "end": at}, "text": " "})
    assert titles(client, uri) == ["check", "synth", f"stale: {found}"]
    error = client.error("workspace/executeCommand", command("srgc.synth", uri, "Slide"))
    assert "save slider.srg first" in error["message"]
    client.change(uri, {"text": SLIDER})
    assert titles(client, uri) == ["check", "synth", found]
    # A certificate that is no longer the one that was verified is not called verified.
    certificate = client.folder / "out" / "Slide" / "certificate.json"
    certificate.write_text(certificate.read_text("utf-8") + " ", encoding="utf-8")
    assert titles(client, uri)[2] == found.removesuffix(" (verified)")


def test_cancelling(client: Client) -> None:
    """The run ends, is resumable, and is said to be interrupted."""
    folder = client.folder / "long"
    folder.mkdir()
    path = folder / "long.srg"
    path.write_text(LONG, encoding="utf-8")
    uri = uri_of(path)
    client.open(uri, LONG)
    number = client.begin("workspace/executeCommand", command("srgc.synth", uri))
    begun = client.notified("$/progress", lambda p: p["value"]["kind"] == "report")
    assert "synth (running)" in titles(client, uri)
    again = client.error("workspace/executeCommand", command("srgc.synth", uri))
    assert "going on" in again["message"]
    client.notify("window/workDoneProgress/cancel", {"token": begun["token"]})
    answer = client.response(number)["result"]
    assert answer["verdict"] == "interrupted"
    assert (folder / "out" / "Turn" / "journal.jsonl").exists()
    assert titles(client, uri) == ["check", "synth"]


@pytest.mark.slow
def test_results_of_another_text(client: Client, made: Callable[[str], Path]) -> None:
    """They are replaced only if the user says so; a client that does not ask keeps them."""
    folder = client.folder / "twice"
    folder.mkdir()
    shutil.copytree(made("slider") / "out", folder / "out" / "Slide")
    one, other = folder / "slider.srg", folder / "other.srg"
    for path, text in ((one, SLIDER), (other, SLIDER + "// another\n")):
        path.write_text(text, encoding="utf-8", newline="")
        client.open(uri_of(path), text)
    found = {"verdict": "found", "status": 0}
    design = folder / "out" / "Slide" / "design.json"
    before = design.read_bytes()
    asked: list[Any] = []

    def answer(title: str | None) -> Any:
        def say(params: Any) -> Any:
            asked.append(params)
            return None if title is None else {"title": title}

        return say

    for kept in (None, "Keep Them"):
        client.answers["window/showMessageRequest"] = answer(kept)
        told = client.ask("workspace/executeCommand", command("srgc.synth", uri_of(other), "Slide"))
        assert told["verdict"] is None
        assert design.read_bytes() == before
    assert "another text" in asked[0]["message"]
    # The same text again is no question.
    assert (
        client.ask("workspace/executeCommand", command("srgc.synth", uri_of(one), "Slide")) == found
    )
    assert len(asked) == 2
    client.answers["window/showMessageRequest"] = answer("Replace Results")
    assert (
        client.ask("workspace/executeCommand", command("srgc.synth", uri_of(other), "Slide"))
        == found
    )
    assert design.read_bytes() != before
    del client.answers["window/showMessageRequest"]


def test_results_and_their_copy_of_the_text_come_together(client: Client) -> None:
    """A run in a terminal writes both at once; the lenses are drawn again, whatever came."""
    for changed in (["design.json", "spec/turner.srg"], ["spec/turner.srg"], ["design.json"], [""]):
        uris = [uri_of(client.folder / "out" / "Turn" / name) for name in changed]
        changes = [{"uri": uri, "type": 1} for uri in uris]
        client.requests.clear()
        client.notify("workspace/didChangeWatchedFiles", {"changes": changes})
        client.ask("workspace/symbol", {"query": ""})
        asked = [request["method"] for request in client.requests]
        assert asked == ["workspace/codeLens/refresh"], changed


def test_a_result_folder_that_is_removed_is_watched(
    started: Callable[..., Client], tmp_path: Path
) -> None:
    """Of a folder that goes as a whole, VS Code tells that it is gone, not what was in it."""
    client = started()
    client.initialize(tmp_path, workspace={"didChangeWatchedFiles": {"dynamicRegistration": True}})
    client.ask("workspace/symbol", {"query": ""})
    [asked] = [m for m in client.requests if m["method"] == "client/registerCapability"]
    [registration] = asked["params"]["registrations"]
    watched = {w["globPattern"]: w.get("kind") for w in registration["registerOptions"]["watchers"]}
    deleted = 4  # WatchKind.Delete
    assert watched["**/out"] == watched["**/out/*"] == deleted
    assert watched["**/*.srg"] is watched["**/design.json"] is None  # all kinds


def test_a_text_with_errors_is_not_synthesised(client: Client) -> None:
    """The message says so: the last line of a finding is no reason."""
    path = client.folder / "broken.srg"
    text = TURNER.replace("reach T;", "reach T")
    assert text != TURNER
    path.write_text(text, encoding="utf-8", newline="")
    client.open(uri_of(path), text)
    client.notifications.clear()
    answer = client.ask("workspace/executeCommand", command("srgc.synth", uri_of(path)))
    assert answer == {"verdict": None, "status": 5}
    [told] = [m["params"] for m in client.notifications if m["method"] == "window/showMessage"]
    assert told == {"type": 1, "message": "Turn: the text has errors"}
    client.notifications.clear()
    answer = client.ask("workspace/executeCommand", command("srgc.check", uri_of(path)))
    assert answer == {"errors": 1, "warnings": 0}
    [told] = [m["params"] for m in client.notifications if m["method"] == "window/showMessage"]
    assert told == {"type": 1, "message": "Turn: 1 error, 0 warnings"}


@pytest.mark.parametrize("end", some(["shutdown", "SIGTERM", "exit", "end of input"], 1))
def test_an_end_while_a_synthesis_runs(
    started: Callable[..., Client], tmp_path: Path, end: str
) -> None:
    """The run ends with the server, can be resumed, and nothing is said of how it ended."""
    path = tmp_path / "long.srg"
    path.write_text(LONG, encoding="utf-8")
    client = started()
    client.initialize(tmp_path, window={"workDoneProgress": True})
    client.open(uri_of(path), LONG)
    client.begin("workspace/executeCommand", command("srgc.synth", uri_of(path)))
    client.notified("$/progress", lambda p: p["value"]["kind"] == "report")
    server = client.process
    children = Path(f"/proc/{server.pid}/task/{server.pid}/children")
    runs = [Path(f"/proc/{child}/stat") for child in children.read_text().split()]
    assert runs
    if end == "shutdown":
        assert client.ask("shutdown") is None
        client.notify("exit")
    elif end == "exit":
        client.notify("exit")
    elif end == "SIGTERM":
        server.terminate()
    else:
        assert server.stdin is not None
        server.stdin.close()
    expected = {"shutdown": 0, "SIGTERM": 130}.get(end, 1)
    assert server.wait(PATIENCE) == expected
    ends = time.monotonic() + PATIENCE
    while any(map(_lives, runs)):
        assert time.monotonic() < ends
        time.sleep(0.05)
    assert (tmp_path / "out" / "Turn" / "journal.jsonl").exists()
    assert b"Traceback" not in b"".join(client.log), b"".join(client.log).decode()


def _lives(stat: Path) -> bool:
    """Whether a process is more than its exit status."""
    try:
        return stat.read_text().rpartition(") ")[2][0] not in "ZX"
    except OSError:
        return False


def test_lenses_of_other_verdicts(tmp_path: Path) -> None:
    path = tmp_path / "turner.srg"
    path.write_bytes(b"\xef\xbb\xbf" + TURNER.encode())
    folder = tmp_path / "out" / "Turn"
    folder.mkdir(parents=True)
    analysis = analyse(str(path), TURNER, {})

    def title(content: str) -> str | None:
        (folder / "design.json").write_text(content, encoding="utf-8")
        lenses = task_lenses(analysis, 0, uri_of(path), Verdicts(), {})
        found = [lens.command.title for lens in lenses if lens.command is not None]
        return found[2] if len(found) > 2 else None

    assert title("{") is None
    assert title("[]") is None
    assert title('{"verdict": 3}') == "stale: 3"
    assert title('{"verdict": "impossible", "reason": null}') == "stale: impossible"
    assert title('{"verdict": "unknown", "reason": "no\\n time"}') == "stale: unknown: no time"


def test_the_bytes_of_a_file_count_where_the_buffer_is_the_same(tmp_path: Path) -> None:
    """An editor takes the byte order mark away; the results are not stale for that."""
    from solvers.verifier.claims.certificate import spec_digest

    path = tmp_path / "turner.srg"
    data = b"\xef\xbb\xbf" + TURNER.encode()
    path.write_bytes(data)
    folder = tmp_path / "out" / "Turn"
    folder.mkdir(parents=True)
    digest = spec_digest({"turner.srg": data})
    design = {"verdict": "found", "word": ["B"], "spec_sha256": digest}
    (folder / "design.json").write_text(json.dumps(design), encoding="utf-8")
    for text, title in ((TURNER, "found: B"), (TURNER + "\n", "stale: found: B")):
        analysis = analyse(str(path), text, {})
        lenses = task_lenses(analysis, 0, uri_of(path), Verdicts(), {})
        assert lenses[2].command is not None
        assert lenses[2].command.title == title
