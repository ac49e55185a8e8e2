"""The tube on which the verifier proves a result, as it goes along."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from flint import arb
from numpy.typing import NDArray

from compiler.dynamics.absolute_angles import absolute_angles
from compiler.semantics.family import family_of
from grammar_lang.load import load
from solvers.verifier.proofs import enclosure
from solvers.verifier.verification import Report, verify_directory
from tests.oracles import result_files

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ProvedTube:
    """Segments that cover the motion, and the matrix of the joints' coordinates q = D y."""

    report: Report
    segments: tuple[Any, ...]
    rows: Array

    def farthest(self, times: Array, states: Array) -> float:
        """By how much the states (q, v) at some times leave the tube at most; 0 if never."""
        n, worst, number = len(self.rows), 0.0, 0
        for time, state in zip(times, states, strict=True):
            while number + 1 < len(self.segments):
                if float(self.segments[number + 1].start.mid()) > time:
                    break
                number += 1
            segment = self.segments[number]
            held = segment.at(arb(float(time)) - segment.start)
            for entries, values in ((held[:n], state[:n]), (held[n : 2 * n], state[n:])):
                for row, value in zip(self.rows, values, strict=True):
                    entry = sum((int(w) * x for w, x in zip(row, entries, strict=True)), arb(0))
                    gap = float(abs(entry.mid() - arb(float(value)))) - float(entry.rad())
                    worst = max(worst, gap)
        return worst


def proved_tube(folder: Path) -> ProvedTube:
    """Verify a result and keep the last tube that was looked at."""
    tubes: list[list[Any]] = []
    plain = enclosure.tube

    def recorded(*arguments: Any, **options: Any) -> Iterator[Any]:
        kept: list[Any] = []
        tubes.append(kept)
        for segment in plain(*arguments, **options):
            kept.append(segment)
            yield segment

    users = [
        module
        for name, module in sys.modules.items()
        if name.startswith("solvers.verifier") and getattr(module, "tube", None) is plain
    ]
    with ExitStack() as patches:
        for module in users:
            patches.enter_context(mock.patch.object(module, "tube", recorded))
        report = verify_directory(folder)
    claim = result_files.read(folder)
    program = load(folder / "spec" / claim["spec"]).program
    assert program is not None
    family = family_of(program, program.tasks[claim["task"]])
    model = family.robot(family.replay(tuple(claim["derivation"])))
    return ProvedTube(report, tuple(tubes[-1]), np.array(absolute_angles(model).rows))
