"""What learning from refutations saves: the paper's arm and a target that is too far, by its bound.

Each round gives every bound both ways to `srgc synth` and `srgc verify`: with lemmas, and with
`--no-lemmas`, which refutes structure by structure as versions before lemmas did.  Times are
processor times of whole processes; ratios are medians over rounds.

    python benchmarks/lemmas.py --rounds 3 --modules 6 7 8 9
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path
from statistics import median

from timing import SPEC, SRGC, machine, process

OUT_OF_REACH = {
    "bounds box [0, 5] x [0, 5] m;": "bounds box [0, 50] x [0, 50] m;",
    "target T box [3.5, 4.2] x [3.8, 4.5] m;": "target T box [40, 41] x [40, 41] m;",
}


def far_text(modules: int) -> str:
    """The case study with a target that eleven links of five metres do not reach."""
    text = SPEC.read_text(encoding="utf-8")
    changes = OUT_OF_REACH | {"  horizon": f"  modules <= {modules};\n  horizon"}
    for before, after in changes.items():
        if text.count(before) != 1:
            raise SystemExit(f"{SPEC.name} does not say once: {before}")
        text = text.replace(before, after)
    return text


def measured(spec: Path, folder: Path, *options: str) -> dict[str, float | int]:
    """Seconds of both commands, and how much evidence there is."""
    command = [*SRGC, "synth", str(spec), "--force", "-q", "-o", str(folder), *options]
    synth = process(command, 3).cpu
    verify = process([*SRGC, "verify", str(folder)]).cpu
    claim = json.loads((folder / "certificate.json").read_text(encoding="utf-8"))
    design = json.loads((folder / "design.json").read_text(encoding="utf-8"))
    alone = sum(s["same_robot_as"] is None for s in claim["structures"])
    return {
        "synth": synth,
        "verify": verify,
        "tried": len(design["structures_tried"]),
        "evidence": alone + len(claim.get("claims", [])),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--modules", type=int, nargs="+", default=[6, 7, 8, 9])
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    print(machine())
    print(f"{'modules':>7}{'tried':>7}{'without':>9}{'evidence':>10}{'without':>9}{'synth s':>9}"
          f"{'without':>9}{'ratio':>8}{'verify s':>10}{'without':>9}{'ratio':>8}")  # fmt: skip
    lines = []
    with tempfile.TemporaryDirectory() as scratch:
        place = Path(scratch)
        for modules in options.modules:
            spec = place / f"far{modules}.srg"
            spec.write_text(far_text(modules), encoding="utf-8")
            pairs = [
                (
                    measured(spec, place / "learnt"),
                    measured(spec, place / "alone", "--no-lemmas"),
                )
                for _ in range(options.rounds)
            ]
            line = {
                "modules": modules,
                **{f"{name} {how}": median(pair[i][name] for pair in pairs)
                   for name in ("tried", "evidence", "synth", "verify")
                   for i, how in enumerate(("learnt", "alone"))},
                **{f"{name} ratio": median(pair[0][name] / pair[1][name] for pair in pairs)
                   for name in ("synth", "verify")},
            }  # fmt: skip
            lines.append(line)
            print(f"{modules:7}{line['tried learnt']:7.0f}{line['tried alone']:9.0f}"
                  f"{line['evidence learnt']:10.0f}{line['evidence alone']:9.0f}"
                  f"{line['synth learnt']:9.2f}{line['synth alone']:9.2f}{line['synth ratio']:8.3f}"
                  f"{line['verify learnt']:10.2f}{line['verify alone']:9.2f}"
                  f"{line['verify ratio']:8.3f}", flush=True)  # fmt: skip
    if options.json is not None:
        content = {"machine": machine(), "rounds": options.rounds, "lines": lines}
        options.json.parent.mkdir(parents=True, exist_ok=True)
        options.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
