"""What a lemma says of variants of a robot holds where parts of them hide what the robot hits with.

A mast carries a point mass 1 m above a slide.  It collides, but for robots whose link has a shape,
which then are no longer blocked: by hand, the sphere of 1 cm on the slide passes below everything.
"""

from __future__ import annotations

import random

import pytest

from compiler.lemmas.variants import neutral_in_task
from compiler.robots.normal_form import family_of
from grammar_lang.load import load_text
from solvers.run_context import RunContext
from solvers.search.synthesis import synthesise
from tests.oracles.some_cases import campaign

MASTS = """\
module B { role base; }
module Post { role link; const mass = 1 kg; }
module SX { role joint; dof q: prismatic x in [0, 4] m; }
module SY { role joint; dof q: prismatic y in [-0.01, 0.01] m; }
module JO { role joint; dof q: revolute z in [-30, 30] deg; }
module Mid { role link; const mass = 1 kg; }
module Mast { role link; const mass = 1 kg; }
module Pad { role link; }
module Cap { role link; const radius = 1 cm; const density = 0.1 kg/m; }
module Plate { role link; const radius = 1 cm; const mass = 1 kg; }
module EN { role effector; }
edge eps;

grammar Masts {
  start N;
  base: N -> B;
  post: N -> N eps Post;
  slide: N -> N eps SX;
  lift: N -> N eps SY;
  turn: N -> N eps JO;
  mid: N -> N eps Mid;
  mast: N -> N eps Mast;
  pad: N -> N eps Pad;
  cap: N -> N eps Cap;
  plate: N -> N eps Plate;
  tool: N -> N eps EN;
  accept matches WORDS;
}

semantics Masts {
  base { this.frame = world; }
  post { this.frame = N.frame; point(frame: N.frame * move((2, 1) m), mass: Post.mass); }
  slide { this.frame = N.frame * move(x, SX.q); }
  lift { this.frame = N.frame * move(y, SY.q); }
  turn { this.frame = N.frame * rot(z, JO.q); }
  mid { this.frame = N.frame; point(frame: N.frame, mass: Mid.mass); }
  mast { this.frame = N.frame; point(frame: N.frame * move(y, 1 m), mass: Mast.mass); }
  pad { this.frame = N.frame; }
  cap { this.frame = N.frame; HIDES }
  plate {
    this.frame = N.frame;
    sphere(frame: N.frame, radius: Plate.radius);
    point(frame: N.frame * move(x, 10 cm), mass: Plate.mass);
  }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}

workspace Hall {
  plane xy;
  bounds box [-1, 5] x [-1, HEIGHT] m;
  region S box [0, 0.5] x [-0.2, 0.2] m;
  obstacle O box [1.5, 2] x [0.8, 0.85] m;
  target T box [3, 3.5] x [-0.2, 0.2] m;
}

task Go {
  robot Masts;
  workspace Hall;
  start in S at rest;
  reach T;
  CLAUSE;
  effort <= 20 N;
  effort <= 20 N*m;
  modules <= 9;
  horizon 20 steps of 0.1 s;
}
"""
SPHERE = "sphere(frame: N.frame, radius: Cap.radius);"
ROD = "rod(frame: N.frame, axis: x, length: 1 cm, density: Cap.density);"
CAPPED = "B eps SX eps Mast (eps Cap)? eps EN"
TWO = "B eps Post eps SX eps Mid eps SY eps Mast (eps Cap)? eps EN"
TURNED = "B eps SX eps Mast eps (JO | Pad eps Pad) eps Plate eps EN"
CASES = {
    "an obstacle": ("avoid O with body", CAPPED, SPHERE, 2),
    "the bounds": ("bounds with body", CAPPED, SPHERE, 0.9),
    "itself, and a shape": ("avoid self with body margin 30 cm", TWO, SPHERE, 2),
    "itself, and a rod": ("avoid self with body margin 30 cm", TWO, ROD, 2),
    "an obstacle, and a joint less": ("avoid O with body", TURNED, SPHERE, 2),
}


def text(case: str) -> str:
    clause, words, hides, height = CASES[case]
    found = MASTS.replace("CLAUSE", clause).replace("WORDS", words).replace("HIDES", hides)
    # The mast is 1 m high; the obstacle is in its way only where it reaches up to that.
    top = "1.2" if "O with body" in clause else "0.85"
    return found.replace("HEIGHT", str(height)).replace("[0.8, 0.85]", f"[0.8, {top}]")


@pytest.mark.parametrize("case", CASES)
def test_what_hides_colliders_is_no_variant(case: str) -> None:
    program = load_text(text(case), "masts.srg").program
    assert program is not None
    task = program.tasks["Go"]
    verdicts = [
        synthesise(program, task, RunContext(paths=2, evaluations=4, lemmas=lemmas)).verdict
        for lemmas in (False, True)
    ]
    assert verdicts == ["found", "found"]


def test_what_binds_no_body_has_all_variants() -> None:
    free = text("an obstacle").replace("avoid O with body", "avoid O with effector")
    program = load_text(free, "masts.srg").program
    assert program is not None
    family = family_of(program, program.tasks["Go"])
    neutral = neutral_in_task(family, program.tasks["Go"])
    labels = [production.label for production in family.grammar.productions]
    assert {labels[number] for number in neutral.removable} == {"slide", "lift", "turn"}
    added = {"post", "mid", "mast", "pad", "cap", "plate"}
    assert {labels[number] for number in neutral.transparent} == added


PARTS = ("Post", "Mid", "Pad", "Cap", "Plate", "JO", "SY")
CLAUSES = (
    "avoid O with body",
    "bounds with body",
    "avoid self with body margin 30 cm",
    "avoid O with effector",
)


def random_text(seed: int) -> str:
    """A mast and other parts in some order, which may be there or not; one demand on bodies."""
    rng = random.Random(seed)
    chosen = ["eps Mast", *(f"(eps {part})?" for part in rng.sample(PARTS, 3))]
    rng.shuffle(chosen)
    found = MASTS.replace("WORDS", f"B eps Post eps SX {' '.join(chosen)} eps EN")
    found = found.replace("CLAUSE", rng.choice(CLAUSES))
    found = found.replace("HIDES", rng.choice((SPHERE, ROD)))
    height = "0.9" if "bounds with body" in found else "2"
    post = found.replace("move((2, 1) m)", "move((2, 0.7) m)") if height == "0.9" else found
    return post.replace("HEIGHT", height).replace("0.85]", "1.2]")


@pytest.mark.parametrize("seed", [*range(8), *campaign(range(8, 120), 32)])
def test_lemmas_contradict_no_search(seed: int) -> None:
    """What is *impossible* with lemmas is not *found* without, nor the other way round."""
    text = random_text(seed)
    program = load_text(text, "masts.srg").program
    if program is None:  # A demand on what is not there.
        pytest.skip("no task")
    task = program.tasks["Go"]
    one_by_one, learnt = (
        synthesise(program, task, RunContext(paths=1, evaluations=2, lemmas=lemmas)).verdict
        for lemmas in (False, True)
    )
    assert {one_by_one, learnt} != {"found", "impossible"}
