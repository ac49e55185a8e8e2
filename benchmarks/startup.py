"""What it costs to have srgc and to call it: cold starts of every command, and installed size.

Every time is that of a whole process with a small real invocation, in turn with one that only
imports click, which no command line that is made with it can undercut; the ratio is the median of
the ratios of the pairs.  Compiled modules are in a cache, as an installer leaves them.

    .venv/bin/python benchmarks/startup.py --runs 21 --json out/startup/startup.json
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path
from re import match
from statistics import median

from timing import ROOT, SRGC, machine, process

CLICK = [sys.executable, "-c", "import click"]
MOST = 2.0
"""The required ratio of ``srgc --version`` to the import of click."""
ARM, DEMO = "specs/planar_arm.srg", "{result}"
WORD = "B eps JO eps L eps JO eps L eps EN"
COMMANDS = {
    "version": ["--version"],
    "help": ["--help"],
    "new": ["new"],
    "check": ["check", ARM],
    "fmt": ["fmt", "--check", ARM],
    "import": ["import", "timor", "specs/imports/scara_modules", "-o", "{scratch}/kit.srg",
               "--force"],
    "expand": ["expand", "specs/serial_kit.srg"],
    "synth": ["synth", ARM, "-o", "{scratch}", "--force", "--quiet"],
    "evolve": ["evolve", DEMO, ARM, "-o", "{scratch}", "--force", "--quiet"],
    "verify": ["verify", DEMO],
    "words": ["words", ARM],
    "accepts": ["accepts", ARM, "--", *WORD.split()],
    "language": ["language", ARM],
    "compare": ["compare", ARM, "PlanarArm", "PlanarArm"],
    "graph": ["graph", ARM, "--of", "sra"],
    "model": ["model", ARM, "--word", WORD],
    "plan": ["plan", ARM],
    "landscape": ["landscape", DEMO, "--over", "4.length", "--points", "2", "-o",
                  "{scratch}/l.svg", "--csv", "{scratch}/l.csv"],
    "why": ["why", "{impossible}", "--no-runs"],
    "explain": ["explain", "SRG0301"],
    "report": ["report", DEMO, "-o", "{scratch}/r.html", "--quiet"],
    "export": ["export", DEMO, "--to", "urdf"],
    "replay": ["replay", DEMO, "--in", "mujoco"],
    "view": ["view", "--help"],
    "lsp": ["lsp", "--help"],
    "completion": ["completion", "bash"],
}  # fmt: skip
"""A small real invocation of every command; of ``view`` and ``lsp``, which serve, the help."""
PEERS = {
    "ruff --version": ["ruff", "--version"],
    "mypy --version": ["mypy", "--version"],
    "pytest --version": ["pytest", "--version"],
}
"""Commands that its users know, from the same environment: the first of them is no Python."""


@dataclass(frozen=True)
class Start:
    """A cold start: medians in seconds, the ratio to the import of click, and the peak in MiB."""

    command: str
    runs: int
    wall: float
    ratio: float
    peak: float


@dataclass(frozen=True)
class Size:
    """What a distribution takes on the disk, without compiled modules."""

    name: str
    version: str
    bytes: int


@contextmanager
def _compiled() -> Iterator[None]:
    """Modules are compiled once and kept apart from the sources."""
    with tempfile.TemporaryDirectory() as cache:
        before = dict(os.environ)
        os.environ["PYTHONPYCACHEPREFIX"] = cache
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
        try:
            yield
        finally:
            os.environ.clear()
            os.environ.update(before)


def start(name: str, command: list[str], runs: int, expected: int = 0) -> Start:
    """Measure a command in turn with the import of click."""
    process(CLICK), process(command, expected)
    pairs = [(process(CLICK), process(command, expected)) for _ in range(runs)]
    ratio = median(ours.wall / click.wall for click, ours in pairs)
    wall, peak = median(b.wall for _, b in pairs), max(b.peak for _, b in pairs)
    return Start(name, runs, wall, ratio, peak)


def starts(names: list[str], runs: int, result: Path, impossible: Path) -> list[Start]:
    """The cold starts of commands, of the import of click itself, and of the peers."""
    found = [start("python -c 'import click'", CLICK, runs)]
    with tempfile.TemporaryDirectory() as scratch:
        places = {"result": result, "impossible": impossible, "scratch": scratch}
        for name in names:
            command = [each.format(**places) for each in COMMANDS[name]]
            # A command that works for seconds is not measured as often.
            few = max(1, runs // 5) if name in ("synth", "evolve", "landscape", "why") else runs
            called = command[0]  # --version, of `version`
            found.append(start(f"srgc {called}", [*SRGC, *command], few))
    for name, (program, *arguments) in PEERS.items():
        path = Path(sys.executable).parent / program
        if path.is_file():
            found.append(start(name, [str(path), *arguments], runs))
    return found


def _required(name: str) -> set[str]:
    """The distributions that one needs, itself first, extras left out."""
    seen: set[str] = set()
    due = [name]
    while due:
        each = due.pop()
        with suppress(PackageNotFoundError):
            lines = distribution(each).requires or []
            if each not in seen:
                seen.add(each)
                due += [_name(line) for line in lines if "extra ==" not in line]
    return seen


def _name(requirement: str) -> str:
    found = match(r"[\w.-]+", requirement)
    assert found is not None
    return found.group().lower().replace("_", "-")


def size(found: Distribution) -> Size:
    """The bytes of a distribution's files; of srgc installed in place, those of its packages."""
    name, total = found.metadata["Name"], 0
    if name == "srgc":
        packages = ("srgc", "solvers", "compiler", "grammar_lang")
        paths = [path for each in packages for path in (ROOT / each).rglob("*")]
    else:
        paths = [Path(str(file.locate())) for file in found.files or []]
    for path in paths:
        if path.is_file() and path.suffix != ".pyc":
            total += path.stat().st_size
    return Size(name, found.version, total)


def sizes() -> list[Size]:
    """srgc and all it needs, the largest first."""
    found = [size(distribution(name)) for name in _required("srgc")]
    return sorted(found, key=lambda each: -each.bytes)


def started_text(found: list[Start]) -> str:
    """The table of cold starts."""
    lines = [f"{'cold start':<30}{'runs':>5}{'wall s':>10}{'x click':>9}{'MiB':>7}"]
    lines += [
        f"{s.command:<30}{s.runs:>5}{s.wall:>10.3f}{s.ratio:>9.2f}{s.peak:>7.0f}" for s in found
    ]
    for each in found:
        if each.command == "srgc --version":
            verdict = "met" if each.ratio <= MOST else "MISSED"
            lines.append(f"required: srgc --version <= {MOST:.0f} x click: {verdict}")
    return "\n".join(lines)


def sized_text(found: list[Size]) -> str:
    """The table of sizes."""
    lines = [f"{'installed':<30}{'version':>12}{'MB':>9}"]
    lines += [f"{s.name:<30}{s.version:>12}{s.bytes / 1e6:>9.2f}" for s in found]
    lines.append(f"{'all':<42}{sum(s.bytes for s in found) / 1e6:>9.2f}")
    return "\n".join(lines)


@contextmanager
def _results(result: Path | None, names: list[str]) -> Iterator[tuple[Path, Path]]:
    """A result of the arm, and one without a design, made where they are asked for."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        demo, impossible = place / "demo", place / "impossible"
        if result is not None:
            shutil.copytree(result, demo)
        elif any(DEMO in COMMANDS[name] for name in names):
            process([*SRGC, "synth", ARM, "-o", str(demo), "--quiet"])
        if "why" in names:
            text = (ROOT / ARM).read_text(encoding="utf-8").replace("[0.5, 5] m", "[0.1, 0.2] m")
            spec = place / "short.srg"
            spec.write_text(text.replace("reach T;", "reach T; modules <= 5;"), encoding="utf-8")
            process([*SRGC, "synth", str(spec), "-o", str(impossible), "--quiet"], expected=3)
        yield demo, impossible


def main(arguments: list[str] | None = None) -> None:
    """Measure and print; with ``--json`` also write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=21)
    parser.add_argument("--only", nargs="*", choices=list(COMMANDS), default=list(COMMANDS))
    parser.add_argument("--result", type=Path, help="a result of the arm; default: made anew")
    parser.add_argument("--json", type=Path, help="write the figures here")
    options = parser.parse_args(arguments)
    print(machine())
    with _compiled(), _results(options.result, options.only) as (demo, impossible):
        measured = starts(options.only, options.runs, demo, impossible)
    taken = sizes()
    print(started_text(measured))
    print()
    print(sized_text(taken))
    if options.json is not None:
        options.json.parent.mkdir(parents=True, exist_ok=True)
        content = {
            "machine": machine(),
            "starts": [asdict(each) for each in measured],
            "sizes": [asdict(each) for each in taken],
        }
        options.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
