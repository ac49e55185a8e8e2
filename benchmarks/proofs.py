"""Measure proofs about arms in space: balls of doubles in machine code against Arb's alone.

Arms of two to seven joints, about z and y in turn, with solid links of which nothing is aligned,
swing for one second.  Either proof is made in this process, in turn; only their arithmetic differs.
Then arms that one can buy (``arms``), with the motions that ``srgc synth`` finds for them.

    python benchmarks/proofs.py --joints 2 4 6 --arms ur5
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from statistics import median

from control_curves import exponent
from timing import ROOT, SRGC, machine, process, seconds

from compiler.expressions.exact_numbers import exact_decimal
from solvers.verifier.claims.certificate import FoundClaim, spec_digest, to_text
from solvers.verifier.proofs import tube_proof
from solvers.verifier.verification import Outcome, verify_directory

ARMS: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "timor": ("timor", {}),
    "ur5": ("ur5", {}),
    "timor_six": (
        "timor",
        {"count(Turn) == 4": "count(Turn) == 6", "modules <= 7": "modules <= 9"},
    ),
}
"""Arms of four, six and six joints: a file in ``arms``, and what is changed in it."""
STEPS, DT, BOUND = 20, Fraction(1, 20), 40
SPEC = """\
module B {{ role base; }}
module JZ {{ role joint; dof q: revolute z; }}
module JY {{ role joint; dof q: revolute y; }}
module L {{ role link; const length = 0.3 m; }}
module EN {{ role effector; }}
grammar Arm {{
  start N; base: N -> B; jz: N -> N JZ; jy: N -> N JY; link: N -> N L; tool: N -> N EN;
  accept matches B ((JZ | JY) L)+ EN;
}}
semantics Arm {{
  base {{ this.frame = world; }}
  jz {{ this.frame = N.frame * rot(z, JZ.q); }}
  jy {{ this.frame = N.frame * rot(y, JY.q); }}
  link {{
    this.frame = N.frame * move(x, L.length) * move((0, 0.05, 0.1));
    solid(frame: N.frame, mass: 1.5 kg, com: (0.15, 0.02, 0.04),
        inertia: (0.02, 0.025, 0.033, 0.002, 0, 0.001));
  }}
  tool {{ this.frame = N.frame; effector(frame: N.frame); }}
}}
workspace Hall {{
  space xyz;
  bounds box [-9, 9] x [-9, 9] x [-9, 9] m; region R box [-9, 9] x [-9, 9] x [-9, 9] m;
}}
task Swing {{
  robot Arm; workspace Hall; start in R at rest; reach R;
  effort <= {bound} N*m; horizon {steps} steps of {dt} s;
}}
"""


def claimed_arm(scratch: Path, joints: int) -> Path:
    """A result folder that claims that an arm swings in a hall."""
    folder = scratch / f"space-{joints}"
    (folder / "spec").mkdir(parents=True, exist_ok=True)
    text = SPEC.format(steps=STEPS, dt=exact_decimal(DT), bound=BOUND)
    (folder / "spec" / "arm.srg").write_text(text, encoding="utf-8")
    kinds = ["JZ" if i % 2 == 0 else "JY" for i in range(joints)]
    inputs = [[_torque(joints, i, k) for i in range(joints)] for k in range(STEPS)]
    peak = max(abs(u) for row in inputs for u in row)
    claim = FoundClaim(
        task="Swing",
        spec="arm.srg",
        spec_sha256=spec_digest({"arm.srg": text.encode()}),
        word=("B", *(symbol for kind in kinds for symbol in (kind, "L")), "EN"),
        derivation=(
            "tool",
            *(x for kind in reversed(kinds) for x in ("link", kind.lower())),
            "base",
        ),
        parameters=(),
        effector=0,
        steps=STEPS,
        step=exact_decimal(DT),
        start=(
            *(exact_decimal(Fraction((-1) ** i * (8 - i), 20)) for i in range(joints)),
            *["0"] * joints,
        ),
        inputs=tuple(tuple(exact_decimal(u) for u in row) for row in inputs),
        path=(("R",) * (STEPS + 1),),
        effort_peak=exact_decimal(peak),
        robustness=exact_decimal(BOUND - peak),
    )
    (folder / "certificate.json").write_text(to_text(claim), encoding="utf-8")
    return folder


def _torque(joints: int, joint: int, step: int) -> Fraction:
    """Less towards the tool, and there and back again within four steps."""
    return Fraction((1, -1, -1, 1)[step % 4] * (joints - joint) ** 2, 4)


@contextmanager
def arb_alone() -> Iterator[None]:
    """No robot is large enough for machine code."""
    before = tube_proof.LEAST_IN_MACHINE
    tube_proof.LEAST_IN_MACHINE = 10**9
    try:
        yield
    finally:
        tube_proof.LEAST_IN_MACHINE = before


def check(folder: Path) -> None:
    """The proof, which has to go through."""
    report = verify_directory(folder)
    if report.outcome is not Outcome.VALID:
        raise SystemExit(f"{folder.name}: {report.outcome.value} ({report.reason})")


def measured(folder: Path, rounds: int) -> tuple[float, float, float]:
    """Medians of seconds in Arb and in doubles, and of the ratios of the pairs."""
    pairs = []
    for _ in range(rounds):
        with arb_alone():
            slow = seconds(lambda: check(folder))
        pairs.append((slow, seconds(lambda: check(folder))))
    arb, doubles = (median(times) for times in zip(*pairs, strict=True))
    return arb, doubles, median(a / b for a, b in pairs)


def print_arms(names: Sequence[str], rounds: int, scratch: Path) -> None:
    """A line for each of the arms in ``arms``: its proof, and whole cold processes."""
    print(f"\n{'arm':<11}{'arb s':>10}{'doubles s':>11}{'ratio':>8}{'synth s':>9}{'verify s':>10}")
    for name in names:
        folder, spec = scratch / name, _arm(name, scratch)
        synth = process([*SRGC, "synth", str(spec), "-o", str(folder)]).cpu
        check(folder)
        arb, doubles, ratio = measured(folder, rounds)
        verify = median(process([*SRGC, "verify", str(folder)]).cpu for _ in range(rounds))
        times = f"{arb:>10.3f}{doubles:>11.3f}{ratio:>8.2f}{synth:>9.2f}{verify:>10.2f}"
        print(f"{name:<11}{times}", flush=True)


def _arm(name: str, scratch: Path) -> Path:
    """The file of an arm."""
    file, changes = ARMS[name]
    text = (ROOT / "benchmarks" / "arms" / f"{file}.srg").read_text(encoding="utf-8")
    for before, after in changes.items():
        text = text.replace(before, after)
    found = scratch / f"{name}.srg"
    found.write_text(text, encoding="utf-8")
    return found


def main() -> None:
    """Measure and print tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--joints", type=int, nargs="+", default=[2, 3, 4, 5, 6, 7])
    parser.add_argument("--arms", nargs="*", choices=tuple(ARMS), default=tuple(ARMS))
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    print(machine())
    print(f"\n{'joints':>6}{'arb s':>10}{'doubles s':>11}{'ratio':>8}{'ms a step':>11}", flush=True)
    times = []
    with tempfile.TemporaryDirectory() as made:
        for joints in options.joints:
            folder = claimed_arm(Path(made), joints)
            check(folder)
            arb, doubles, ratio = measured(folder, options.rounds)
            times.append(doubles)
            step = 1000 * doubles / STEPS
            print(f"{joints:>6}{arb:>10.3f}{doubles:>11.3f}{ratio:>8.2f}{step:>11.1f}", flush=True)
        if len(times) > 1:
            print(f"exponent of the time in doubles {exponent(options.joints, times)[0]:.2f}")
        if options.arms:
            print_arms(options.arms, options.rounds, Path(made))


if __name__ == "__main__":
    main()
