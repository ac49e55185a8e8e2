"""Run SMT solvers on SMT-LIB 2 scripts, each in a process of its own.

The verifier uses this, since it imports no solver, and so do searches that ask another solver than
z3's library. A solver is found by its name: a command next to this Python or on the path that reads
a script on standard input, the Python package of z3 or cvc5, or a solver that pySMT has. An answer
is exactly one word. Anything else (the command is missing, ends with an error, prints something
else, or takes too long) is no answer, and the message names the solver.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from threading import Thread
from typing import IO

from compiler.time_limits.time_limit import check_time
from grammar_lang.files.file_tree import visible
from solvers.verdict import Answer, Fails, Holds, Reason, Unknown

# Twice what the searchers spend, so that whatever they decide is decided here, too.
RESOURCES = 2_000_000
SECONDS = 600.0
"""A process is ended after this time: most solvers have no other budget."""
PULSE = 0.2
"""Seconds between two checks of a time limit."""
REST = 10.0
"""Seconds to read the output of an ended process, whose children may keep the pipe open."""
SHOWN = 200
"""The most characters of a process's output that a message quotes."""
MOST = 1_000_000
"""A process that prints more bytes than this is ended."""

# -P keeps the working directory out of the module path.
_Z3 = """\
import sys, z3
solver = z3.SolverFor("QF_NRA")
solver.set("rlimit", int(sys.argv[1]))
solver.from_string(sys.stdin.read())
print(solver.check())
"""
_CVC5 = """\
import sys, cvc5
solver = cvc5.Solver(cvc5.TermManager())
solver.setOption("rlimit-per", sys.argv[1])
parser = cvc5.InputParser(solver)
parser.setStringInput(cvc5.InputLanguage.SMT_LIB_2_6, sys.stdin.read(), "script")
while not (command := parser.nextCommand()).isNull():
    print(command.invoke(solver, parser.getSymbolManager()), end="")
"""
_PYSMT = """\
import sys
from io import StringIO
from pysmt.shortcuts import Solver
from pysmt.smtlib.parser import SmtLibParser
script = SmtLibParser().get_script(StringIO(sys.stdin.read()))
with Solver(name=sys.argv[1], logic="QF_NRA") as solver:
    answers = [answer for name, answer in script.evaluate(solver) if name == "check-sat"]
print({True: "sat", False: "unsat"}.get(answers[-1], "unknown"))
"""
_PYSMT_NAMES = """\
from pysmt.logics import QF_NRA
from pysmt.shortcuts import get_env
print(*get_env().factory.all_solvers(logic=QF_NRA))
"""


class UnknownSolverError(ValueError):
    """No SMT solver has this name here; the message lists those that are available."""


class DisagreementError(Exception):
    """One solver answers sat to a ``script`` and another unsat, so at least one of them is wrong.

    ``answers`` maps the name of each solver to its answer.
    """

    def __init__(self, name: str, script: str, answers: Mapping[str, str]) -> None:
        said = ", ".join(f"{solver} says {answer}" for solver, answer in answers.items())
        super().__init__(name, script, answers)
        self.text = f"the solvers disagree about {name}: {said}"
        self.script, self.answers = script, answers

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True)
class SmtSolver:
    """The name of a solver, and the command that reads a script on standard input."""

    name: str
    command: tuple[str, ...]

    def run(self, script: str, *, seconds: float | None = None) -> Answer[None, None]:
        """Decide a QF_NRA script: ``Holds`` is sat, ``Fails`` is unsat, anything else ``Unknown``.

        Args:
            script: SMT-LIB 2 with one ``check-sat``.
            seconds: the time after which the process is ended; None: ``SECONDS``.

        Raises:
            OutOfTimeError: the current time limit was reached without an answer.
        """
        limit = SECONDS if seconds is None else seconds
        try:
            process = subprocess.Popen(  # noqa: S603 (the command is the user's choice)
                self.command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                # A command may start other processes; they are ended with it.
                start_new_session=True,
            )
        except OSError as error:
            return Unknown(Reason.INCOMPLETE, f"{self.name} does not start: {error.strerror}")
        talk = _Talk(process, script)
        try:
            ended = talk.ended_within(limit)
        finally:
            talk.close()
        output, errors = (each.text for each in talk.said)
        if talk.flooded:
            return self._no_answer(output or errors)
        if not ended:
            said = f"{self.name} did not answer within {limit:g} s"
            return Unknown(Reason.TIME_LIMIT, said)
        return self._answer(process.returncode, output, errors)

    def _answer(self, status: int, output: str, errors: str) -> Answer[None, None]:
        match status, output.strip():
            case 0, "unsat":
                return Fails(None)
            case 0, "sat":
                return Holds(None)
            case 0, "unknown":
                said = f"{self.name} answers unknown"
                return Unknown(Reason.RESOURCE_LIMIT, said)
            case 0, output:
                return self._no_answer(output or errors)
            case code, output:
                message = next(iter(reversed((errors or output).strip().splitlines())), "")[:SHOWN]
                said = f"{self.name} ended with status {code}: {visible(message)}"
                return Unknown(Reason.INCOMPLETE, said)

    def _no_answer(self, printed: str) -> Unknown:
        """The result for output that is not an answer."""
        message = visible(" ".join(printed[: 2 * SHOWN].split())[:SHOWN]) or "nothing"
        said = f"{self.name} prints what is no answer: {message}"
        return Unknown(Reason.INCOMPLETE, said)


class _Printed(Thread):
    """Reads the output of a pipe, up to ``MOST`` bytes."""

    def __init__(self, pipe: IO[bytes]) -> None:
        super().__init__(daemon=True)
        self.content = bytearray()
        self._pipe = pipe
        self.start()

    def run(self) -> None:
        """Read to the end, or until there is too much."""
        with suppress(OSError, ValueError):
            while len(self.content) <= MOST and (part := os.read(self._pipe.fileno(), 65536)):
                self.content += part

    @property
    def text(self) -> str:
        """The output as text, cut off after ``MOST`` bytes."""
        return self.content[:MOST].decode("utf-8", "replace")


class _Talk:
    """Passes a script to a process; threads write and read, so no side blocks on a full pipe."""

    def __init__(self, process: subprocess.Popen[bytes], script: str) -> None:
        self._process = process
        self.said = tuple(_Printed(pipe) for pipe in (process.stdout, process.stderr) if pipe)
        self._given = Thread(target=self._give, args=(script.encode(),), daemon=True)
        self._given.start()

    def _give(self, script: bytes) -> None:
        pipe = self._process.stdin
        # The process may end without reading the whole script.
        with suppress(OSError, ValueError):
            if pipe is not None:
                pipe.write(script)
                pipe.close()

    @property
    def flooded(self) -> bool:
        """Whether the process prints too much."""
        return any(len(each.content) > MOST for each in self.said)

    def ended_within(self, limit: float) -> bool:
        """Whether the process ended within ``limit`` seconds without printing too much."""
        left = limit
        while left > 0 and not self.flooded:
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(min(PULSE, left))
                self._read_rest()
                return not self.flooded
            left -= PULSE
            check_time()
        return False

    def _read_rest(self) -> None:
        """Read what an ended process has printed, which takes time on a busy machine."""
        left = REST
        while left > 0 and any(each.is_alive() for each in self.said):
            for each in self.said:
                each.join(PULSE)
            left -= PULSE
            check_time()

    def close(self) -> None:
        """End the process and those that it started."""
        if hasattr(os, "killpg"):
            with suppress(OSError):
                os.killpg(self._process.pid, signal.SIGKILL)
        self._process.kill()
        self._process.wait()
        for each in (self._given, *self.said):
            each.join(PULSE)
        for pipe in (self._process.stdin, self._process.stdout, self._process.stderr):
            with suppress(OSError, ValueError):
                if pipe is not None:
                    pipe.close()


# --- Several solvers ------------------------------------------------------------------------------


def agreed(
    script: str, name: str, solvers: Sequence[SmtSolver], *, seconds: float | None = None
) -> Answer[None, None]:
    """The common answer of solvers; if one has none and the others agree, its ``Unknown``.

    Args:
        script: SMT-LIB 2.
        name: the name of the script in messages.
        solvers: at least one.
        seconds: the time after which a process is ended; None: ``SECONDS``.

    Raises:
        DisagreementError: two answers contradict each other.
        OutOfTimeError: the current time limit was reached.
    """
    answers = [(solver.name, solver.run(script, seconds=seconds)) for solver in solvers]
    words = {
        each: "sat" if isinstance(answer, Holds) else "unsat"
        for each, answer in answers
        if not isinstance(answer, Unknown)
    }
    if len(set(words.values())) > 1:
        raise DisagreementError(name, script, words)
    return next((a for _, a in answers if isinstance(a, Unknown)), answers[0][1])


# --- Available solvers ----------------------------------------------------------------------------


def _executable(*names: str) -> str | None:
    """The path of a command next to this Python, or else on the path."""
    suffix = ".exe" if sys.platform == "win32" else ""
    for folder in (Path(sys.executable).parent, Path(sysconfig.get_path("scripts"))):
        for name in names:
            if (folder / f"{name}{suffix}").is_file():
                return str(folder / f"{name}{suffix}")
    return next((found for found in map(shutil.which, names) if found is not None), None)


def z3_command(resources: int = RESOURCES) -> tuple[str, ...]:
    """The z3 command next to this Python or on the path, or else a call of its Python package."""
    found = _executable("z3")
    if found is not None:
        return found, "-smt2", "-in", f"rlimit={resources}"
    return sys.executable, "-P", "-c", _Z3, str(resources)


def _cvc5_command() -> tuple[str, ...] | None:
    found = _executable("cvc5")
    if found is not None:
        return found, "--lang=smt2", "--quiet", f"--rlimit-per={RESOURCES}"
    if find_spec("cvc5") is not None:
        return sys.executable, "-P", "-c", _CVC5, str(RESOURCES)
    return None


def _yices_command() -> tuple[str, ...] | None:
    found = _executable("yices-smt2", "yices_smt2")
    return None if found is None else (found,)


def _mathsat_command() -> tuple[str, ...] | None:
    found = _executable("mathsat")
    return None if found is None else (found, "-input=smt2")


COMMANDS: dict[str, Callable[[], tuple[str, ...] | None]] = {
    "z3": z3_command,
    "cvc5": _cvc5_command,
    "yices": _yices_command,
    "mathsat": _mathsat_command,
}


def smt_solvers() -> tuple[SmtSolver, ...]:
    """The available solvers: first those with a command of their own, then those only pySMT has."""
    found = [(name, command()) for name, command in sorted(COMMANDS.items())]
    known = [SmtSolver(name, command) for name, command in found if command is not None]
    names = {solver.name for solver in known} | {
        "msat" if s.name == "mathsat" else "" for s in known
    }
    others = [
        SmtSolver(name, (sys.executable, "-P", "-c", _PYSMT, name))
        for name in _of_pysmt()
        if name not in names
    ]
    return (*known, *others)


def _of_pysmt() -> Sequence[str]:
    """The names of the solvers for nonlinear arithmetic that pySMT has, if it is installed."""
    if find_spec("pysmt") is None:
        return ()
    finished = subprocess.run(  # noqa: S603 (the command is our own)
        [sys.executable, "-P", "-c", _PYSMT_NAMES], capture_output=True, text=True, check=False
    )
    return finished.stdout.split() if finished.returncode == 0 else ()


def smt_solver(name: str) -> SmtSolver:
    """The solver with a name, or with the path of a command that reads SMT-LIB 2 on standard input.

    Raises:
        UnknownSolverError: there is no such solver.
    """
    if any(separator in name for separator in ("/", "\\")):
        if not Path(name).is_file():
            raise UnknownSolverError(f"there is no command `{name}`")
        if not os.access(name, os.X_OK):
            raise UnknownSolverError(f"`{name}` cannot be run: it is not executable")
        return SmtSolver(name, (str(Path(name).resolve()),))
    command = COMMANDS[name]() if name in COMMANDS else None
    if command is not None:
        return SmtSolver(name, command)
    here = smt_solvers()
    for solver in here:
        if solver.name == name:
            return solver
    listed = ", ".join(f"`{solver.name}`" for solver in here) or "none"
    hint = '; `pip install "srgc[cvc5]"` brings it' if name == "cvc5" else ""
    raise UnknownSolverError(f"there is no SMT solver `{name}`; here are {listed}{hint}")


def named_solvers(names: str | None) -> tuple[SmtSolver, ...]:
    """The solvers of a comma-separated list of names; no solvers for None.

    Raises:
        UnknownSolverError: a name is empty or unknown.
    """
    if names is None:
        return ()
    each = dict.fromkeys(part.strip() for part in names.split(","))
    if "" in each:
        raise UnknownSolverError(f"a name of a solver is empty in `{names}`")
    return tuple(smt_solver(name) for name in each)
