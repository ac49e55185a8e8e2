"""An arm of three tubes that folds onto its own foot: it is found only where it need not touch it.

The foot lies on the x axis, from the origin to (1, 0) m; how far the last tube is from it follows
from where its ends are.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from compiler.arrays import Array
from compiler.robots.normal_form import family_of
from compiler.words.structures import structures
from grammar_lang.load import load_text
from solvers.verifier.refutations.box_check import why_not
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.command_line import quiet
from tests.oracles.exported_motions import replay

SPEC = """\
module Foot { role base; const length = 1 m; }
module Elbow { role joint; dof q: revolute z in [90, 140] deg; }
module Tube { role link; const density = 1 kg/m; const first = 1 m; const last = 0.95 m; }
module Tip { role effector; }
grammar Arm { start N; arm: N -> Foot Elbow Tube Elbow Tube Tip; }
semantics Arm {
  arm {
    rod(frame: world, axis: x, length: Foot.length, density: 1 kg/m);
    this.one = move(x, Foot.length) * rot(z, Elbow1.q);
    this.two = this.one * move(x, Tube1.first) * rot(z, Elbow2.q);
    rod(frame: this.one, axis: x, length: Tube1.first, density: Tube1.density);
    rod(frame: this.two, axis: x, length: Tube2.last, density: Tube2.density, radius: 1 cm);
    effector(frame: this.two * move(x, Tube2.last));
  }
}
workspace Bench {
  plane xy;
  bounds box [-3, 3] x [-3, 3] m;
  region S box [-0.15, -0.05] x [0.25, 0.35] m;
  target T box TARGET m;
}
task Fold {
  robot Arm; workspace Bench;
  start in S at rest; reach T at rest;
  CLAUSE
  effort <= 20 N*m;
  horizon 20 steps of 0.1 s;
}
"""
BEYOND = "[0.15, 0.25] x [-0.25, -0.15]"
"""Behind the foot: the last tube has to pass through it."""
ABOVE = "[0.1, 0.4] x [0.118, 0.120]"
"""The tip comes to 118 mm at least, the tube's surface to 108 mm, and to 110 mm at best."""
FOUND, IMPOSSIBLE = 0, 3


def synthesised(scratch: Path, target: str, clause: str) -> tuple[int, Path]:
    spec, folder = scratch / "fold.srg", scratch / "out"
    spec.write_text(SPEC.replace("TARGET", target).replace("CLAUSE", clause), encoding="utf-8")
    return quiet("synth", spec, "-o", folder, "--force", "-q"), folder


def last_tube(q: Array) -> tuple[Array, Array]:
    """Its ends (K, 2) in poses (K, 2)."""
    direction = np.cumsum(q, axis=1)
    one, two = (np.stack([np.cos(a), np.sin(a)], axis=1) for a in direction.T)
    elbow = np.array([1.0, 0.0]) + one
    return elbow, elbow + 0.95 * two


def least_distance(q: Array) -> float:
    """Of the last tube's axis from the foot, over 200 places on it."""
    start, end = last_tube(q)
    share = np.linspace(0, 1, 200)[:, None, None]
    places = start + share * (end - start)
    foot = places.copy()
    foot[..., 0], foot[..., 1] = np.clip(places[..., 0], 0, 1), 0.0
    return float(np.linalg.norm(places - foot, axis=-1).min())


def replayed(folder: Path) -> Array:
    """The coordinates (K, 2) of the certified motion in MuJoCo."""
    exported = folder / "robot.xml"
    assert quiet("export", folder, "--to", "mjcf", "-o", exported) == 0
    seen = replay(exported.read_text(encoding="utf-8"), result_files.read(folder))
    return np.asarray(seen.states[:, :2])


def test_a_margin_that_the_tip_can_keep(tmp_path: Path) -> None:
    """The axis keeps 10 mm, the radius, and 95 mm: of 118 to 120 mm that is enough."""
    status, folder = synthesised(tmp_path, ABOVE, "avoid self with body, margin 95 mm;")
    assert status == FOUND
    report = verify_directory(folder)
    assert report.outcome is Outcome.VALID
    told = next(c for c in report.conditions if c.name.startswith("clearance of body 1"))
    least = least_distance(replayed(folder)) - 0.105
    assert told.margin <= least + 1e-6
    assert told.margin >= 0.95 * least


def test_a_margin_that_lacks_a_millimetre(tmp_path: Path) -> None:
    """No pose keeps it: that is proved, and is no proof for a millimetre less than there is."""
    status, folder = synthesised(tmp_path, ABOVE, "avoid self with body, margin 111 mm;")
    assert status == IMPOSSIBLE
    assert verify_directory(folder).outcome is Outcome.VALID
    (proof,) = folder.glob("proofs/*.boxes")
    for margin, due in ((112, True), (109, False)):
        text = SPEC.replace("TARGET", ABOVE)
        clause = f"avoid self with body, margin {margin} mm;"
        program = load_text(text.replace("CLAUSE", clause), "fold.srg").program
        assert program is not None
        task = program.tasks["Fold"]
        family = family_of(program, task)
        (derivation,) = structures(family.language, 6)
        asked = family.robot(derivation), program.workspaces[task.workspace], task
        assert (why_not(proof.read_text(encoding="utf-8"), *asked) is None) is due


@pytest.mark.slow
def test_through_itself(tmp_path: Path) -> None:
    """Found without the clause, and not with it; nor is that certificate valid with it."""
    status, folder = synthesised(tmp_path, BEYOND, "")
    assert status == FOUND
    assert last_tube(replayed(folder))[1][-1, 1] < 0
    result_files.alter_spec(folder, "effort", "avoid self with body; effort", sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert "clearance of body 1" in str(report.reason)
    assert synthesised(tmp_path, BEYOND, "avoid self with body;")[0] == IMPOSSIBLE
    assert verify_directory(folder).outcome is Outcome.VALID
    allowed = "avoid self with body, except Foot Tube;"
    assert synthesised(tmp_path, BEYOND, allowed)[0] == FOUND


def test_bodies_have_the_names_that_check_gives_them(tmp_path: Path) -> None:
    """Of a production with several modules each body is its own module's."""
    status, folder = synthesised(tmp_path, ABOVE, "avoid self with body, margin 95 mm;")
    assert status == FOUND
    (told,) = [c.name for c in verify_directory(folder).conditions if "to body" in c.name]
    assert told == "clearance of body 1 (Foot at symbol 0) to body 3 (Tube at symbol 4)"
