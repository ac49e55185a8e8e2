"""The editor's commands for tasks and missions: synthesis and verification as child processes."""

from __future__ import annotations

import asyncio
import itertools
import re
import signal
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer

from grammar_lang.diagnostics.diagnostic import Severity
from grammar_lang.diagnostics.wording import counted
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t
from srgc.faults import SPEC_ERRORS, USAGE
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.documents.programs import Programs
from srgc.language_server.documents.projects import bytes_of, is_folder
from srgc.language_server.protocol import RequestRefused
from srgc.language_server.tasks.verdicts import (
    Verdicts,
    current_files,
    folder_of,
    holds_mission,
)

# --- ``srgc synth`` and ``srgc verify`` as child processes, with progress and cancellation --------


_TIME = re.compile(r"^\[ *[0-9.]+ s\] ")
_PATIENCE = 10.0
"""Seconds that a run has to write its results after it was told to end."""


@dataclass(frozen=True, slots=True)
class Ended:
    """A run that has ended: its exit status, and the ends of its output and errors."""

    status: int
    output: str
    errors: str


@dataclass(slots=True)
class Jobs:
    """The runs in progress; they end with the server."""

    _running: set[asyncio.subprocess.Process] = field(
        default_factory=set[asyncio.subprocess.Process]
    )

    async def run(
        self,
        arguments: Sequence[str],
        folder: Path,
        told: Callable[[str], None],
        ended: Callable[[], bool],
    ) -> Ended:
        """Run ``srgc`` with these arguments.

        Args:
            arguments: its command line.
            folder: the working directory.
            told: called with every line of its progress.
            ended: whether the user wants the run to end; called repeatedly.

        Raises:
            OSError: it cannot be started.
        """
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-P",
            "-m",
            "srgc",
            *arguments,
            cwd=folder,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
        )
        self._running.add(process)
        watch = asyncio.create_task(_watch(process, ended))
        try:
            output, errors = await asyncio.gather(
                _lines(process.stdout, lambda _: None), _lines(process.stderr, told)
            )
            status = await process.wait()
        finally:
            watch.cancel()
            self._running.discard(process)
            if process.returncode is None:
                await _stop(process)
        return Ended(status, output, errors)

    def stop(self) -> None:
        """End all runs; they keep what they have found so far."""
        for process in self._running:
            with suppress(ProcessLookupError):
                process.send_signal(signal.SIGINT)


async def _stop(process: asyncio.subprocess.Process) -> None:
    """Interrupt a run, so that it can be resumed; kill it if it does not end in time."""
    with suppress(ProcessLookupError):
        process.send_signal(signal.SIGINT)
        try:
            await asyncio.wait_for(process.wait(), _PATIENCE)
        except TimeoutError:
            process.kill()


async def _watch(process: asyncio.subprocess.Process, ended: Callable[[], bool]) -> None:
    while not ended():
        await asyncio.sleep(0.1)
    await _stop(process)


async def _lines(stream: asyncio.StreamReader | None, told: Callable[[str], None]) -> str:
    """Pass on each line; return the last lines."""
    last: list[str] = []
    while stream is not None:
        try:
            line = await stream.readline()
        except ValueError:
            continue  # lines that are too long are not useful
        if not line:
            break
        text = _TIME.sub("", line.decode("utf-8", "replace").rstrip())
        if text:
            told(text)
            last = [*last[-19:], text]
    return "\n".join(last)


# --- The commands of the lenses: ``srgc.check``, ``srgc.synth`` and ``srgc.verify`` ---------------


Kind: TypeAlias = Literal["task", "mission"]
"""The kind of item that a command is about, which is also the name of its option."""
_REPLACE = "Replace Results"
_VERDICTS = {0: "found", 3: "impossible", 4: "unknown", 130: "interrupted"}
_OUTCOMES = {0: "verified", 1: "refuted", 4: "not decided", 6: "about another task"}


@dataclass(slots=True)
class TaskCommands:
    """The commands; ``refresh`` has the lenses drawn again."""

    server: LanguageServer
    programs: Programs
    verdicts: Verdicts
    refresh: Callable[[], None]
    running: dict[tuple[str, str], str] = field(default_factory=dict[tuple[str, str], str])
    jobs: Jobs = field(default_factory=Jobs)
    _tokens: itertools.count[int] = field(default_factory=itertools.count)

    async def check(self, uri: str, task: str, kind: Kind = "task") -> dict[str, Any]:
        """Count all diagnostics of the program of a task or a mission, and show the numbers."""
        analysis = await self._program(uri, task, kind)
        found = await self.programs.work(lambda: analysis.findings)
        errors = sum(each.severity is Severity.ERROR for each in found)
        warnings = sum(each.severity is Severity.WARNING for each in found)
        text = f"{task}: {counted(errors, 'error')}, {counted(warnings, 'warning')}"
        if not found:
            text = f"{task}: no findings"
        self._say(text, lsp.MessageType.Error if errors else lsp.MessageType.Info)
        return {"errors": errors, "warnings": warnings}

    async def synth(self, uri: str, task: str, kind: Kind = "task") -> dict[str, Any]:
        """Synthesise, and verify the result."""
        path = await self._saved(uri, task, kind)
        folder = folder_of(path, task)
        relative = folder.relative_to(path.parent)
        arguments = ["synth", path.name, f"--{kind}", task, "-o", str(relative)]
        ended = await self._run(path, task, "synth", arguments)
        if ended.status == USAGE and "--force" in ended.errors:
            if not await self._may_replace(folder, relative):
                return {"verdict": None, "status": ended.status}
            ended = await self._run(path, task, "synth", [*arguments, "--force"])
        verdict = _VERDICTS.get(ended.status)
        if verdict is None:
            broken = ended.status == SPEC_ERRORS  # its last line is only the hint of a diagnostic
            reason = "the text has errors" if broken else _last(ended)
            self._say(f"{task}: {reason}", lsp.MessageType.Error)
            return {"verdict": None, "status": ended.status}
        self._say(f"{task}: {verdict}", lsp.MessageType.Info)
        if verdict in {"found", "impossible"}:
            await self.verify(uri, task, kind)
        return {"verdict": verdict, "status": ended.status}

    async def verify(self, uri: str, task: str, kind: Kind = "task") -> dict[str, Any]:
        """Verify the results of a task or a mission.

        Raises:
            RequestRefused: there is no result folder yet.
        """
        path = await self._path(uri, task, kind)
        folder = folder_of(path, task)
        if not is_folder(folder):
            raise RequestRefused(f"{folder} is not a result folder yet: synthesise first")
        relative = str(folder.relative_to(path.parent))
        # Results that `srgc evolve` writes for a task have the claim of a mission.
        about = "--mission" if holds_mission(folder) else f"--{kind}"
        ended = await self._run(path, task, "verify", ["verify", relative, about, task])
        outcome = _OUTCOMES.get(ended.status)
        if outcome is None:
            self._say(f"{task}: {_last(ended)}", lsp.MessageType.Error)
        else:
            self.verdicts.note(folder, outcome)
            self._say(f"{task}: {outcome}", lsp.MessageType.Info)
        self.refresh()
        return {"outcome": outcome, "status": ended.status}

    async def _may_replace(self, folder: Path, shown: Path) -> bool:
        """Whether results of another text or seed may be replaced: the user is asked.

        An unfinished run has no usable results, and is replaced without asking.

        Raises:
            RequestRefused: there are files, but no results.
        """
        if self.verdicts.read(folder, {}) is None:
            if not (folder / "journal.jsonl").exists():
                raise RequestRefused(f"{shown} is not empty and holds no results")
            return True
        request = lsp.ShowMessageRequestParams(
            lsp.MessageType.Warning,
            f"{shown} holds the results of another text or seed.",
            [lsp.MessageActionItem(_REPLACE), lsp.MessageActionItem("Keep Them")],
        )
        try:
            chosen = await self.server.window_show_message_request_async(request)
        except Exception:  # the client cannot ask
            chosen = None
        return chosen is not None and chosen.title == _REPLACE

    # --- What a command is about ---------------------------------------------------------------

    async def _program(self, uri: str, task: str, kind: Kind) -> Analysis:
        for analysis in await self.programs.of(uri):
            declared = analysis.declared
            if task in (declared.missions if kind == "mission" else declared.tasks):
                return analysis
        raise RequestRefused(f"there is no {kind} `{task}` in an open document")

    async def _path(self, uri: str, task: str, kind: Kind) -> Path:
        path = (await self._program(uri, task, kind)).path(0)
        if path is None:
            raise RequestRefused("save the document as a file first")
        return path

    async def _saved(self, uri: str, task: str, kind: Kind) -> Path:
        """The main file; the files on disk must have the texts that the editor shows."""
        analysis = await self._program(uri, task, kind)
        path = await self._path(uri, task, kind)
        for number, (name, data) in enumerate(current_files(analysis).items()):
            at = analysis.path(number)
            if at is None or bytes_of(at) != data:
                raise RequestRefused(f"save {name} first")
        return path

    # --- Runs ----------------------------------------------------------------------------------

    async def _run(self, path: Path, task: str, what: str, arguments: list[str]) -> Ended:
        key = (str(path), task)
        if key in self.running:
            raise RequestRefused(f"{self.running[key]} of {task} is going on")
        self.running[key] = what
        self.refresh()
        token = await self._begin(f"{what} {task}")
        try:
            return await self.jobs.run(
                arguments, path.parent, lambda text: self._report(token, text),
                lambda: self._cancelled(token),
            )  # fmt: skip
        except OSError as error:
            raise RequestRefused(f"srgc cannot be started: {error.strerror}") from None
        finally:
            del self.running[key]
            self._end(token)
            self.programs.disk_changed()
            self.refresh()

    def _say(self, text: str, kind: lsp.MessageType) -> None:
        self.server.window_show_message(lsp.ShowMessageParams(kind, text))

    # --- Progress ------------------------------------------------------------------------------

    async def _begin(self, title: str) -> str | None:
        """A token for progress, if the client shows progress."""
        window = self.server.client_capabilities.window
        if window is None or not window.work_done_progress:
            return None
        token = f"srgc-{next(self._tokens)}"
        progress = self.server.work_done_progress
        try:
            await asyncio.wait_for(progress.create_async(token), 5)
        except Exception:  # a client that refuses gets no progress
            return None
        progress.begin(token, lsp.WorkDoneProgressBegin(title, cancellable=True))
        return token

    def _report(self, token: str | None, text: str) -> None:
        if token is not None:
            self.server.work_done_progress.report(token, lsp.WorkDoneProgressReport(message=text))

    def _cancelled(self, token: str | None) -> bool:
        if token is None:
            return False
        found = self.server.work_done_progress.tokens.get(token)
        return found is not None and found.cancelled()

    def _end(self, token: str | None) -> None:
        if token is not None:
            self.server.work_done_progress.end(token, lsp.WorkDoneProgressEnd())


def _last(ended: Ended) -> str:
    lines = (ended.errors or ended.output).splitlines()
    return lines[-1] if lines else f"exit status {ended.status}"


# --- Code lenses on tasks and missions: check, synth, and the last verdict ------------------------


CHECK, SYNTH, VERIFY = "srgc.check", "srgc.synth", "srgc.verify"


def kind_of(given: Sequence[str]) -> Kind:
    """The kind of item that a command is about, given by its further arguments; a task by default.

    Raises:
        JsonRpcInvalidParams: there is no such kind.
    """
    if given in ((), ("task",)):
        return "task"
    if given == ("mission",):
        return "mission"
    raise JsonRpcInvalidParams("a command is about a `task` or a `mission`")


Running = Mapping[tuple[str, str], str]
"""Maps the path of the file and the name of a task to the name of the running command."""


def task_lenses(
    analysis: Analysis, number: int, uri: str, verdicts: Verdicts, running: Running
) -> list[lsp.CodeLens]:
    """The lenses of a document.

    Args:
        analysis: the program.
        number: the number of the document in it.
        uri: the URI of the document.
        verdicts: the verdicts in result folders.
        running: the running commands.
    """
    path = analysis.path(0)
    files: dict[str, bytes] = {}
    lenses: list[lsp.CodeLens] = []
    for item in analysis.items(number):
        if not isinstance(item, t.Task | m.Mission):
            continue
        name = item.name.text
        # Tasks have no third argument, because clients from before missions existed send none.
        kind = ["mission"] if isinstance(item, m.Mission) else []
        asked = [uri, name, *kind]
        place = analysis.lines(number).range(item.name.span)

        def add(title: str, command: str, at: lsp.Range = place, asked: list[str] = asked) -> None:
            lenses.append(lsp.CodeLens(at, lsp.Command(title, command, arguments=asked)))

        add("check", CHECK)
        if path is None:
            continue
        doing = running.get((str(path), name))
        add("synth (running)" if doing == "synth" else "synth", SYNTH)
        files = files or current_files(analysis)
        verdict = verdicts.read(folder_of(path, name), files)
        if verdict is not None:
            add(f"{verdict.text}, verifying" if doing == "verify" else verdict.text, VERIFY)
    return lenses
