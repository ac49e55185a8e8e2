"""A separate process that expands a xacro file, and can read only the files it is given.

Macros are programs: they open files, compute without end, and read the environment.  So the process
has limits on time and memory and an empty environment, and an audit hook stops attempts to open
files elsewhere or to start programs.  Standard input is a JSON object.  Standard output is one too:
the XML, and the arguments that the file has.
"""

from __future__ import annotations

import json
import os
import re
import resource
import sys
from collections.abc import Mapping, Sequence
from errno import EACCES
from pathlib import Path
from typing import Any

SECONDS, BYTES = 20, 2 * 2**30
REFUSED = ("subprocess.", "os.", "shutil.", "socket.", "ctypes.")
LISTS = ("os.listdir", "os.scandir", "os.walk")
"""The events of ``os`` that change nothing and start nothing."""
WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND


def fence(roots: Sequence[str]) -> None:
    """From now on only files below the roots can be opened, and only for reading."""

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        if event == "open":
            path, _, flags = arguments
            real = os.path.realpath(os.fsdecode(path)) if not isinstance(path, int) else ""
            inside = any(real == root or real.startswith(f"{root}{os.sep}") for root in roots)
            if not inside or flags & WRITES:
                raise PermissionError(EACCES, "it is outside the folder of the file", real)
            if Path(real).exists() and not Path(real).is_file():
                raise PermissionError(EACCES, "it is not a plain file", real)
        elif event.startswith(REFUSED) and event not in LISTS:
            raise PermissionError(f"{event} is not for a description of a robot")

    sys.addaudithook(hook)


class Arguments(dict[str, str]):
    """The arguments of a file by their names; ``known`` are those that it declares or reads.

    The xacro library looks up an argument in either case, whether it is given or not.
    """

    def __init__(self, given: Mapping[str, str]) -> None:
        super().__init__(given)
        self.known: dict[str, None] = {}

    def __contains__(self, name: object) -> bool:
        self.known[str(name)] = None
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.known[name] = None
        return super().__getitem__(name)


def expanded(file: str, packages: Mapping[str, str], arguments: Arguments) -> str:
    """The text of a xacro file after expansion of its macros."""
    from xml.dom import minidom

    import xacro
    import yaml
    from xacro import substitution_args

    # Modules that they import on first use have to be loaded before the fence is raised.
    minidom.parseString("<a>1</a>").toprettyxml()  # noqa: S318 — our own text
    yaml.safe_load("a: 1.5")

    def find(package: str) -> str:
        if package not in packages:
            raise substitution_args.SubstitutionException(
                f"$(find {package}): say where it is, as in --package {package}=DIR"
            )
        return packages[package]

    # The library offers no other way to set where packages are without an index of ROS.
    substitution_args._eval_find = find  # noqa: SLF001
    fence([str(Path(file).parent), *packages.values()])
    document = xacro.process_file(file, mappings=arguments)
    text: str = document.toprettyxml(indent="  ")
    return text


def _in_words(cause: BaseException) -> str:
    """The message of an error in one line, without error numbers of the system."""
    if isinstance(cause, RecursionError):
        return "a recursion of macros or expressions has no end"
    said = re.sub(r"\[Errno \d+\] ", "", " ".join(str(cause).split()))
    return said or type(cause).__name__


def main() -> int:
    """Expand the file that standard input names; on failure return 1, with one line on stderr."""
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    asked = json.load(sys.stdin)
    arguments = Arguments(asked["arguments"])
    try:
        text = expanded(asked["file"], asked["packages"], arguments)
    except BaseException as error:
        sys.stderr.write(f"\n{_in_words(getattr(error, 'exc', None) or error)[:500]}\n")
        return 1
    json.dump({"text": text, "arguments": list(arguments.known)}, sys.stdout)
    return 0


if __name__ == "__main__":
    sys.exit(main())
