"""z3 on the text of an SMT-LIB 2 script, in a process of its own: the verifier loads no solver."""

from __future__ import annotations

import subprocess
import sys
import sysconfig
from pathlib import Path

from solvers.verdict import Answer, Fails, Holds, Reason, Unknown

# As much again as the searchers spend, so that what they decided is decided here too.
RESOURCES = 2_000_000

# Without the executable, the Python package does the same; -P keeps the working directory out of
# the module path.
_PROGRAM = """\
import sys, z3
solver = z3.SolverFor("QF_NRA")
solver.set("rlimit", int(sys.argv[1]))
solver.from_string(sys.stdin.read())
print(solver.check())
"""


def z3_command(resources: int = RESOURCES) -> list[str]:
    """The command that reads a script on standard input: z3 as installed beside this Python."""
    name = "z3.exe" if sys.platform == "win32" else "z3"
    for folder in (Path(sys.executable).parent, Path(sysconfig.get_path("scripts"))):
        if (folder / name).is_file():
            return [str(folder / name), "-smt2", "-in", f"rlimit={resources}"]
    return [sys.executable, "-P", "-c", _PROGRAM, str(resources)]


def run_z3_subprocess(
    script: str, *, resources: int = RESOURCES, command: list[str] | None = None
) -> Answer[None, None]:
    """Decide a QF_NRA script elsewhere: ``Holds`` is sat, ``Fails`` is unsat.

    An answer is exactly one word; any other output, an error among them, is ``Unknown``.

    Raises:
        ValueError: ``resources`` is not positive.
    """
    if resources < 1:
        raise ValueError("a budget is at least one unit")
    try:
        finished = subprocess.run(  # noqa: S603 (the command is our own)
            z3_command(resources) if command is None else command,
            input=script,
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
        )
    except OSError as error:
        return Unknown(Reason.INCOMPLETE, f"z3 does not start: {error}")
    match finished.returncode, finished.stdout.strip():
        case 0, "unsat":
            return Fails(None)
        case 0, "sat":
            return Holds(None)
        case 0, "unknown":
            return Unknown(Reason.RESOURCE_LIMIT, f"within {resources} z3 resource units")
        case code, output:
            message = " ".join((output or finished.stderr).split())[:200]
            return Unknown(Reason.INCOMPLETE, f"z3 ended with status {code}: {message}")
