"""Exported controllers compiled and run, and the law that they have to compute."""

from __future__ import annotations

import ctypes
import importlib.util
import shutil
import subprocess
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

WARNINGS = [
    "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wconversion", "-Wdouble-promotion",
    "-Wmissing-prototypes", "-Wshadow",
]  # fmt: skip
COMPILERS = ("gcc", "clang")
Run = Callable[[int, Sequence[float]], list[float] | None]


def compiled(compiler: str, source: Path, task: str, sizes: tuple[int, int], *options: str) -> Run:
    """The function of a file, of so many measured quantities and inputs; None: there is no sample.

    A test without the compiler is skipped.
    """
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    library = source.with_suffix(f".{compiler}{len(options)}.so")
    command = [compiler, *WARNINGS, "-ffp-contract=off", *options, "-shared", "-fPIC"]
    ran = subprocess.run(
        [*command, source, "-o", library], capture_output=True, text=True, check=False
    )
    assert (ran.returncode, ran.stderr) == (0, "")
    loaded = ctypes.CDLL(str(library))
    number = ctypes.c_float if "single" in source.name else ctypes.c_double
    function = loaded[f"{task}_controller"]
    n, m = sizes

    def run(sample: int, measured: Sequence[float]) -> list[float] | None:
        inputs = (number * m)(*[7.5] * m)
        status = function(ctypes.c_int(sample), (number * n)(*measured), inputs)
        if status != 0:
            assert status == -1
            assert list(inputs) == [7.5] * m
            return None
        return list(inputs)

    return run


def constants(compiler: str, source: Path, task: str) -> tuple[int, float]:
    """The number of samples and the period that a compiled file has."""
    loaded = ctypes.CDLL(str(source.with_suffix(f".{compiler}0.so")))
    number = ctypes.c_float if "single" in source.name else ctypes.c_double
    samples = ctypes.c_int.in_dll(loaded, f"{task}_samples").value
    return samples, number.in_dll(loaded, f"{task}_period").value


def module(path: Path) -> ModuleType:
    """An exported Python module."""
    spec = importlib.util.spec_from_file_location(f"exported_{path.parent.name}", path)
    assert spec is not None
    assert spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


def law(content: dict[str, Any], sample: int, measured: Sequence[Fraction]) -> list[Fraction]:
    """What a certificate says is held, in rationals; of an open loop, the inputs."""
    planned = [Fraction(text) for text in content["inputs"][sample]]
    for claim in content.get("claims", []):
        reference = [Fraction(text) for text in claim["reference"][sample]]
        off = [x - r for x, r in zip(measured, reference, strict=True)]
        gains = [[Fraction(text) for text in row] for row in claim["gains"][sample]]
        planned = [
            u - sum(k * d for k, d in zip(row, off, strict=True))
            for u, row in zip(planned, gains, strict=True)
        ]
    return planned


def single(content: dict[str, Any], sample: int, measured: Sequence[np.float32]) -> list[float]:
    """The law in NumPy's single precision, operation by operation, in the order of the file."""
    (claim,) = content["claims"]
    found = []
    for text, row in zip(content["inputs"][sample], claim["gains"][sample], strict=True):
        held = np.float32(text)
        for gain, x, reference in zip(row, measured, claim["reference"][sample], strict=True):
            held = np.float32(held - np.float32(gain) * (x - np.float32(reference)))
        found.append(float(held))
    return found
