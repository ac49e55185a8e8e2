"""Run the examples of the gallery, measure them, and write its page, docs/gallery/index.md.

Each command is a process of its own, and each synthesis begins anew. An example that is finished
is kept while the code, its spec and what that reads are the same, so that the same command goes on
after an interruption; shards may run side by side.

    python benchmarks/gallery.py                       # what has not been run with this code
    python benchmarks/gallery.py --shard 1/4           # of every fourth example, the first one on
    python benchmarks/gallery.py drone_gauge --again   # this one, whether finished or not
    python benchmarks/gallery.py --page                # the page alone, from what was measured
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from threading import Timer

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from docs._extensions.gallery_page import (  # noqa: E402
    GALLERY,
    MADE,
    Example,
    Run,
    Step,
    page,
    read_examples,
    read_run,
)

SRGC = [sys.executable, "-c", "from srgc.cli import main; main()"]
CODE = ("grammar_lang", "compiler", "solvers", "srgc")
NO_CODE = {".pyc", ".so"}
LIMIT = 1800.0
"""Seconds for a command; an idle machine needs two minutes at most for each."""
LARGEST = 150_000
"""Bytes of a picture."""
STATUS = {"found": 0, "impossible": 3}
ANSWER = ("verdict:", "robot:", "  ")
"""How the lines of ``synth`` begin that the page shows: verdict, robot and parameters."""


@dataclass(frozen=True)
class Ran:
    """A process that has ended: its exit status, what it printed, and what it took."""

    status: int
    printed: list[str]
    errors: str
    step: Step


Runner = Callable[[str], Ran]


def run_process(command: str, limit: float = LIMIT, root: Path = ROOT) -> Ran:
    """Run a command line of srgc to its end, with the processes that it starts and waits for.

    Args:
        command: without the ``srgc`` in front.
        limit: seconds after which it is killed.
        root: the working directory.
    """
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        started = time.perf_counter()
        child = subprocess.Popen(
            [*SRGC, *command.split()],
            cwd=root,
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=err,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )
        watch = Timer(limit, child.kill)
        watch.start()
        _, status, usage = os.wait4(child.pid, 0)
        watch.cancel()
        wall = time.perf_counter() - started
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        printed, errors = (file.read().decode() for file in (out, err))
    # ru_maxrss counts kilobytes on Linux, bytes on macOS.
    unit = 2**20 if sys.platform == "darwin" else 2**10
    step = Step(
        round(wall, 2), round(usage.ru_utime + usage.ru_stime, 2), round(usage.ru_maxrss / unit)
    )
    return Ran(child.returncode, printed.splitlines(), errors, step)


# --- what a run is about --------------------------------------------------------------------------


def code_digest(root: Path = ROOT) -> str:
    """Of all files of the packages, by their names and bytes, and of the locked versions."""
    digest = hashlib.sha256()
    files = [file for part in CODE for file in (root / part).rglob("*") if file.is_file()]
    files += [file for file in [root / "requirements" / "run.lock"] if file.is_file()]
    for file in sorted(files):
        if file.suffix not in NO_CODE:
            digest.update(str(file.relative_to(root)).encode() + b"\0" + _digest(file).encode())
    return digest.hexdigest()[:16]


def _digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()[:16]


def file_digests(copies: Path) -> dict[str, str]:
    """Of the copies that a result keeps of its spec and of what that reads, but for the library."""
    return {
        file.relative_to(copies).as_posix(): _digest(file)
        for file in sorted(copies.rglob("*"))
        if file.is_file() and file.relative_to(copies).parts[0] != "@std"
    }


def machine() -> str:
    """Where this is measured."""
    return (
        f"{os.cpu_count()} cores, {platform.system()} {platform.machine()}, "
        f"Python {platform.python_version()}"
    )


# --- the gallery ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Gallery:
    """The folders of a gallery, and what runs its commands.

    ``root`` has the specs and the results; ``folder`` has the list, the runs, the pictures and the
    page.
    """

    root: Path = ROOT
    folder: Path = GALLERY
    runner: Runner = run_process

    def is_finished(self, example: Example, code: str) -> bool:
        """Whether the example was run here with the same commands, code and files."""
        run, made = read_run(example, self.folder), self.root / MADE / example.name
        if run is None or not (made / "report.html").is_file():
            return False
        if run.code != code or run.commands != example.commands or not self._picture(example):
            return False
        specs = (self.root / example.spec).parent
        return all(
            (specs / name).is_file() and _digest(specs / name) == digest
            for name, digest in run.files.items()
        )

    def _picture(self, example: Example) -> bool:
        return (self.folder / f"{example.name}.svg").is_file()

    def make(self, example: Example, code: str) -> Run:
        """Run an example from its beginning and keep its picture and what was measured.

        Raises:
            SystemExit: a command fails, the verdict is another one, or the picture is too large.
        """
        folder = self.root / MADE / example.name
        picture = folder.with_suffix(".svg")
        shutil.rmtree(folder, ignore_errors=True)
        picture.unlink(missing_ok=True)
        folder.parent.mkdir(parents=True, exist_ok=True)
        ran = dict(self._steps(example))
        if picture.stat().st_size > LARGEST:
            raise SystemExit(f"{example.name}: a picture of {picture.stat().st_size} bytes")
        printed = list(answer(ran["synth"].printed))
        if "why" in ran:
            printed += ["", *ran["why"].printed]
        run = Run(
            example.commands,
            code,
            file_digests(folder / "spec"),
            machine(),
            time.strftime("%Y-%m-%d"),
            printed,
            {name: each.step for name, each in ran.items()},
        )
        self.folder.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(picture, self.folder / picture.name)
        write(self.folder / "runs" / f"{example.name}.json", run.text())
        return run

    def _steps(self, example: Example) -> Iterator[tuple[str, Ran]]:
        for name, command in example.commands.items():
            ran = self.runner(command)
            due = STATUS[example.verdict] if name == "synth" else 0
            if ran.status != due:
                says = "\n".join([*ran.printed[-5:], ran.errors[-2000:]])
                raise SystemExit(f"srgc {command}: exit status {ran.status}, not {due}\n{says}")
            if name == "synth":
                self._check_verdict(example)
            yield name, ran

    def _check_verdict(self, example: Example) -> None:
        design = self.root / MADE / example.name / "design.json"
        verdict = json.loads(design.read_text(encoding="utf-8"))["verdict"]
        if verdict != example.verdict:
            raise SystemExit(f"{example.spec}: {verdict}, not {example.verdict}")

    def write_page(self) -> None:
        """The page of what has been measured until now."""
        examples = read_examples(self.folder)
        runs = {each.name: read_run(each, self.folder) for each in examples}
        known = {name: run for name, run in runs.items() if run is not None}
        write(self.folder / "index.md", page(examples, known))


def answer(printed: Sequence[str]) -> Iterator[str]:
    """Of what ``synth`` prints the verdict, the robot and its parameters."""
    for line in printed:
        if not line.startswith(ANSWER):
            return
        yield line


def write(file: Path, text: str) -> None:
    """A file whole or not at all; other shards may write the same one."""
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(f"{file.name}.{os.getpid()}")
    part.write_text(text, encoding="utf-8")
    part.replace(file)


def chosen(examples: Sequence[Example], names: Sequence[str], shard: str) -> list[Example]:
    """The examples with these names, or all; of these a shard such as ``2/4``.

    Raises:
        SystemExit: there is no such example or shard.
    """
    unknown = sorted(set(names) - {each.name for each in examples})
    if unknown:
        raise SystemExit(f"no example is called {', '.join(unknown)}")
    number, _, count = shard.partition("/")
    if not (number.isdecimal() and count.isdecimal() and 1 <= int(number) <= int(count)):
        raise SystemExit(f"--shard {shard}: expected K/N with 1 <= K <= N, as in 2/4")
    kept = [each for each in examples if not names or each.name in names]
    return kept[int(number) - 1 :: int(count)]


def main() -> None:
    """Make what is not finished, one example after the other, and the page after each."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", help="of examples, as of their specs; none: all")
    parser.add_argument("--shard", default="1/1", metavar="K/N", help="every Nth, the Kth on")
    parser.add_argument("--again", action="store_true", help="finished ones, too")
    parser.add_argument("--page", action="store_true", help="the page alone")
    options = parser.parse_args()
    gallery, code = Gallery(), code_digest()
    examples = chosen(read_examples(), options.names, options.shard)
    for example in [] if options.page else examples:
        if not options.again and gallery.is_finished(example, code):
            print(f"{example.name}: finished", flush=True)
            continue
        steps = gallery.make(example, code).steps
        took = ", ".join(f"{name} {step.shown}" for name, step in steps.items())
        print(f"{example.name}: {example.verdict}; {took}", flush=True)
        gallery.write_page()
    gallery.write_page()
    print(f"page: {(GALLERY / 'index.md').relative_to(ROOT)}")


if __name__ == "__main__":
    main()
