"""Expand xacro files with the ROS library, in a process that can read nothing else."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from difflib import SequenceMatcher

from grammar_lang.files.file_tree import visible
from srgc.faults import UsageFault
from srgc.imports.source_fault import file_fault
from srgc.imports.source_files import SourceFiles
from srgc.imports.urdf.xacro_process import SECONDS

WAIT = 6 * SECONDS
"""Seconds until the process is ended; its own limit is one of processor time."""


def expanded_xacro(files: SourceFiles, arguments: Iterable[str]) -> bytes:
    """Expand a xacro file to URDF.

    Args:
        files: the file, and the other files that may be read.
        arguments: each ``NAME:=VALUE``, as on the command line of xacro.

    Raises:
        UsageFault: the file cannot be expanded within the limits of time and memory, or does not
            have one of the arguments.
    """
    values = dict[str, str]()
    for text in arguments:
        name, separator, value = text.partition(":=")
        if not separator or not name:
            raise UsageFault(f"--arg {text}: write NAME:=VALUE")
        if name in values:
            raise UsageFault(f"--arg {text}: `{visible(name)}` is given twice")
        values[name] = value
    packages = {files.folder.name: files.folder} | dict(files.packages)
    asked = {
        "file": os.path.realpath(files.main),
        "packages": {name: str(place) for name, place in packages.items()},
        "arguments": values,
    }
    command = [sys.executable, "-P", "-m", "srgc.imports.urdf.xacro_process"]
    environment = {"PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "PYTHONHASHSEED": "0"}
    late = f"xacro cannot expand it: it takes more than {SECONDS} s"
    try:
        done = subprocess.run(  # noqa: S603 — our own module, with input on stdin alone
            command,
            input=json.dumps(asked).encode(),
            capture_output=True,
            env=environment,
            check=False,
            timeout=WAIT,
        )
    except subprocess.TimeoutExpired:
        raise file_fault(files.main, late) from None
    if done.returncode == 0:
        answer = json.loads(done.stdout)
        _refuse_unknown(files, values, answer["arguments"])
        return str(answer["text"]).encode()
    lines = done.stderr.decode(errors="replace").strip().splitlines()
    if lines and done.returncode == 1:
        raise file_fault(files.main, f"xacro cannot expand it: {lines[-1]}")
    raise file_fault(files.main, late)


def _refuse_unknown(files: SourceFiles, values: Mapping[str, str], known: Sequence[str]) -> None:
    """Reject an argument that the file neither declares nor reads."""
    for name, value in values.items():
        if name not in known:
            near = sorted(known, key=lambda each: -SequenceMatcher(None, name, each).ratio())
            listed = ", ".join(f"`{visible(each)}`" for each in near)
            has = f"it has {listed}" if near else "it has none"
            said = f"{files.main} has no argument `{visible(name)}`; {has}"
            raise UsageFault(f"--arg {name}:={value}: {said}")
