"""What `avoid self with body` costs: arms in space with the clause and without it, in turn.

Times are processor times of whole processes.  Each round gives all arms both ways to `srgc synth`
and `srgc verify`; the ratios are medians over rounds.

    python benchmarks/apart.py --rounds 3 --arms ur5_shaped timor_pointing
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
from pathlib import Path
from statistics import median

from timing import ROOT, SRGC, machine, process

ARMS = {"ur5_shaped": "Move", "timor_desk": "Careful", "timor_pointing": "Point"}
"""Specifications in ``arms``, with the task of each."""
CLAUSE = "  avoid self with body, margin 2 mm;\n"
FOLDER = ROOT / "benchmarks" / "arms"


def measured(spec: Path, task: str, folder: Path) -> tuple[float, float]:
    """Seconds of processor time of a synthesis and of the verification of what it finds."""
    command = [*SRGC, "synth", str(spec), "--task", task, "--force", "-o", str(folder)]
    return process(command).cpu, process([*SRGC, "verify", str(folder)]).cpu


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--arms", nargs="+", choices=ARMS, default=list(ARMS))
    options = parser.parse_args()
    print(machine())
    print(f"{'arm':16}{'synth s':>10}{'without':>10}{'ratio':>8}{'verify s':>10}{'without':>10}"
          f"{'ratio':>8}")  # fmt: skip
    with tempfile.TemporaryDirectory() as scratch:
        place = Path(scratch)
        shutil.copytree(FOLDER, place / "free")
        for name in ARMS:
            file = place / "free" / f"{name}.srg"
            text = file.read_text(encoding="utf-8")
            if CLAUSE not in text:
                raise SystemExit(f"{name}.srg does not say: {CLAUSE.strip()}")
            file.write_text(text.replace(CLAUSE, ""), encoding="utf-8")
        for name in options.arms:
            pairs = [
                (
                    measured(FOLDER / f"{name}.srg", ARMS[name], place / "out"),
                    measured(place / "free" / f"{name}.srg", ARMS[name], place / "out"),
                )
                for _ in range(options.rounds)
            ]
            row = f"{name:16}"
            for command in (0, 1):
                with_it, without = ([pair[way][command] for pair in pairs] for way in (0, 1))
                ratio = median(a / b for a, b in zip(with_it, without, strict=True))
                row += f"{median(with_it):10.2f}{median(without):10.2f}{ratio:8.2f}"
            print(row, flush=True)


if __name__ == "__main__":
    main()
