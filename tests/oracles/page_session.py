"""What a page shows, done in its order: files written, changes made, commands and programs run.

A page is a session in a folder of its own. The folder has the specs of the project and the file of
the first page; blocks with a name are files; ``diff NAME`` changes one; ``console`` has commands
with what they print, ``python`` programs with, in a ``text`` block behind them, what they print.
"""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

from tests.oracles.pages import Block, blocks

NUMBER = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")
MEASURED = ("synth", "verify", "landscape", "why", "replay", "report")
"""Commands whose numbers depend on the last digits of a search, which differ between processors."""
MORE = "..."


@dataclass(frozen=True, slots=True)
class Command:
    """A ``$ srgc`` line: its arguments, its exit status and the output that is shown."""

    arguments: tuple[str, ...]
    status: int
    output: str

    @property
    def measured(self) -> bool:
        return self.arguments[0] in MEASURED


def commands(block: Block) -> Iterator[Command]:
    """The commands of a ``console`` block."""
    for part in re.split(r"^\$ ", block.body, flags=re.MULTILINE)[1:]:
        line, _, output = part.partition("\n")
        exits = re.search(r"# exits (\d+)$", line)
        program, *arguments = shlex.split(line, comments=True)
        assert program == "srgc", line
        yield Command(tuple(arguments), int(exits[1]) if exits else 0, output)


def changed(text: str, difference: str) -> str:
    """A text whose line ``-`` is replaced by the line ``+``, as often as the difference says."""
    lines = difference.splitlines()
    for before, after in zip_longest(lines[::2], lines[1::2], fillvalue=""):
        assert before[0] == "-", before
        assert after[0] == "+", after
        assert text.count(f"{before[1:]}\n") == 1, before
        text = text.replace(f"{before[1:]}\n", f"{after[1:]}\n")
    return text


def shape(output: str) -> list[str]:
    """The lines of an output without its measured numbers, whose order depends on them."""
    lines = (" ".join(NUMBER.sub("#", line).split()) for line in output.splitlines())
    return sorted(re.sub(r"margin \S+", "margin #", line) for line in lines)


def assert_shown(command: Command, printed: str) -> None:
    """What is printed is what is shown; ``...`` stands for lines that are left out at the end."""
    shown, left_out = command.output.removesuffix(f"{MORE}\n"), command.output.endswith(f"{MORE}\n")
    if not command.measured:
        assert printed.startswith(shown) if left_out else printed == shown
    elif left_out:
        lines = shape(printed)
        assert all(line in lines for line in shape(shown)), (shown, printed)
    else:
        assert shape(printed) == shape(shown)


class Session:
    """A page that is followed in a folder, which is the working directory.

    ``made`` gives the results of the specs that the suite makes once, by name, ``shared`` their
    texts; ``left_out`` are commands that are not run.
    """

    def __init__(
        self,
        text: str,
        folder: Path,
        run: Callable[[list[str]], int],
        printed: Callable[[], str],
        made: Callable[[str], Path],
        shared: Mapping[str, bytes],
        left_out: Collection[str] = (),
    ) -> None:
        self.blocks = blocks(text)
        self.folder = folder
        self.run = run
        self.printed = printed
        self.made = made
        self.shared = shared
        self.left_out = left_out
        self.names: dict[str, object] = {"__name__": "__main__"}

    def follow(self) -> None:
        """Do everything that the page shows."""
        for block in self.blocks:
            if block.name and block.kind != "diff":
                file = self.folder / block.name
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(block.body, encoding="utf-8")
        for place, block in enumerate(self.blocks):
            after = self.blocks[place + 1] if place + 1 < len(self.blocks) else None
            self._do(block, after)

    def _do(self, block: Block, after: Block | None) -> None:
        if block.kind == "diff":
            file = self.folder / block.name
            text = changed(file.read_text(encoding="utf-8"), block.body)
            file.write_text(text, encoding="utf-8")
        elif block.kind == "console":
            for command in commands(block):
                if " ".join(command.arguments) not in self.left_out:
                    assert_shown(command, self._output(command))
        elif block.kind == "python" and not block.name:
            self.printed()
            exec(compile(block.body, f"line {block.line}", "exec"), self.names)
            printed = self.printed()
            assert printed == (after.body if after and after.kind == "text" else "")

    def _output(self, command: Command) -> str:
        """What a command prints, once it has ended as it should."""
        ready = self._ready(command.arguments)
        if ready is not None:
            return ready
        self.printed()
        assert self.run([*command.arguments]) == command.status, command
        if "-o" in command.arguments:
            place = command.arguments.index("-o") + 1
            assert (self.folder / command.arguments[place]).exists(), command
        return self.printed()

    def _ready(self, arguments: tuple[str, ...]) -> str | None:
        """The result of a text that the suite synthesises once for all tests."""
        wanted = [one for one in arguments if one not in ("-q", "--quiet")]
        if wanted[0] != "synth" or len(wanted) not in (2, 4) or wanted[2:3] not in ([], ["-o"]):
            return None
        spec = Path(wanted[1])
        text = (self.folder / spec).read_bytes()
        if self.shared.get(spec.stem) != text:
            return None
        task = re.findall(r"^task (\w+)", text.decode(), re.MULTILINE)[0]
        target = wanted[3] if wanted[2:] else f"out/{task}"
        done = self.made(spec.stem)
        shutil.copytree(done / "out", self.folder / target)
        said = (done / "stdout").read_text(encoding="utf-8")
        return re.sub(r"\bout$", target, said, flags=re.MULTILINE)
