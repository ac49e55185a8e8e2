"""The ``robust`` clauses, and ``control``, which some of them need."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import mpmath
import pytest

from grammar_lang import ir
from grammar_lang.load import load_text

Check = Callable[[str], list[tuple[str, str]]]
Build = Callable[..., str]

TASK = """
task P {{
  robot G; workspace W; start in S; reach T; effort <= 10 N*m; horizon 80 steps of 0.125 s;
  {}
}}
"""


SEMANTICS = """
semantics G {
  base  { this.frame = world; }
  joint { this.frame = N.frame * rot(z, JO.q); }
  link  { this.frame = N.frame * move(x, L.length); point(frame: N.frame, mass: 1 kg); }
  tool  { this.frame = N.frame; effector(frame: N.frame); }
}
"""


@pytest.fixture(scope="session")
def robust(build: Build) -> Callable[[str], ir.Robust | None]:
    def make(text: str) -> ir.Robust | None:
        loaded = load_text(build(semantics=SEMANTICS, task=TASK.format(text)), "t")
        assert loaded.program is not None, loaded.diagnostics
        return loaded.program.tasks["P"].robust

    return make


def test_each_kind(robust: Callable[[str], ir.Robust | None]) -> None:
    assert robust("") is None
    found = robust("robust start 1 mm 0.25 rad, 2 cm/s; robust start (0.5 * 3) rad/s;")
    radii = ir.Radii(
        length=Fraction(1, 1000),
        angle=Fraction(1, 4),
        speed=Fraction(1, 50),
        angular_rate=Fraction(3, 2),
    )
    assert found == ir.Robust(start=radii)
    found = robust("robust measure 1 mm 0.25 rad; robust measure 2 cm/s, 1.5 rad/s;")
    assert found == ir.Robust(measured=radii)
    assert robust("robust effort 2.5 %;") == ir.Robust(effort=Fraction(1, 40))
    assert robust("robust effort 2.5 % of bound;") == ir.Robust(effort_of_bound=Fraction(1, 40))
    assert robust("robust mass 3 %;") == ir.Robust(mass=Fraction(3, 100))


def test_masses_of_modules(robust: Callable[[str], ir.Robust | None]) -> None:
    part = Fraction(3, 100)
    one = ir.ModuleMass("L", part)
    assert robust("robust mass 3 % of L;") == ir.Robust(masses=(one,))
    assert robust("robust mass 3 % of L; robust mass 3 %;") == ir.Robust(mass=part, masses=(one,))


OWNERS = """
module B {{ role base; const mass = 1 kg; }}
module K {{ role link; const mass = 2 kg; }}
module L {{ role link; const mass = 3 kg; dof q: revolute z; }}
module E {{ role effector; }}
grammar G {{ start S; all: S -> N E; one: N -> B; two: N -> N K L; more: N -> N L L; }}
semantics G {{
  all {{ effector(frame: N.f); point(frame: N.f, mass: 9 kg + B); }}
  one {{ this.f = world; point(frame: world, mass: 1 kg); }}
  two {{ this.f = N.f * rot(z, L.q); point(frame: this.f, mass: TWO); }}
  more {{ this.f = N.f * rot(z, L1.q) * rot(z, L2.q); point(frame: this.f, mass: MORE); }}
}}
workspace W {{ plane xy; bounds box [-1, 1] x [-1, 1] m; region R box [0, 1] x [0, 1] m; }}
task P {{
  robot G; workspace W; start in R; reach R; effort <= 1 N*m; horizon 1 steps of 1 s;
  robust mass 5 % of {module};
}}
""".replace("9 kg + B", "9 kg")


@pytest.mark.parametrize(
    ("two", "more", "module", "mixed"),
    [
        ("K.mass", "L2.mass", "L", ""),
        ("2 * L.mass + 1 kg", "L1.mass", "L", ""),
        ("L.mass", "L2.mass", "B", ""),
        ("L.mass", "L2.mass", "E", ""),
        ("K.mass + L.mass", "L2.mass", "L", "K.mass + L.mass"),
        ("K.mass + L.mass", "L2.mass", "K", "K.mass + L.mass"),
        ("K.mass + L.mass", "L1.mass + L2.mass", "B", ""),
        ("3 kg", "L2.mass", "K", "3 kg"),
        ("K.mass", "L1.mass + L2.mass", "L", "L1.mass + L2.mass"),
        ("K.mass", "3 kg", "L", "3 kg"),
    ],
)
def test_whose_a_body_is(
    two: str, more: str, module: str, mixed: str, check_fragment: Check
) -> None:
    """The module of the production, or the one that the quantities name."""
    text = OWNERS.format(module=module).replace("TWO", two).replace("MORE", more)
    found = [item for item in check_fragment(text) if item[0] != "UNUSED_NAME"]
    bodies = {"K": "two", "L": "more"}
    if mixed:
        assert found == [("MIXED_OWNERS", f"point(frame: this.f, mass: {mixed});")]
    else:
        assert found == []
        assert module not in bodies or bodies[module] in text


def test_a_module_without_a_body_has_no_mass(check_fragment: Check) -> None:
    text = OWNERS.format(module="K").replace("TWO", "L.mass").replace("MORE", "L1.mass")
    assert ("BAD_VALUE", "robust mass 5 % of K;") in check_fragment(text)


def test_all_kinds_together(robust: Callable[[str], ir.Robust | None]) -> None:
    clauses = {
        "mass": "robust mass 0.5 %;",
        "effort of bound": "robust effort (1 + 1) % of bound;",
        "measure": "robust measure 1 mm;",
        "start": "robust start 2 mm;",
        "effort": "robust effort 99 %;",
    }
    text = " ".join([*clauses.values(), "robust start 1 m/s; robust measure 3 m/s;"])
    found = robust(text)
    assert found == ir.Robust(
        start=ir.Radii(length=Fraction(1, 500), speed=Fraction(1)),
        measured=ir.Radii(length=Fraction(1, 1000), speed=Fraction(3)),
        effort=Fraction(99, 100),
        effort_of_bound=Fraction(1, 50),
        mass=Fraction(1, 200),
    )
    assert found is not None
    first = min(span.start for span in found.clauses.values())
    places = {kind: span.start - first for kind, span in found.clauses.items()}
    radii = {"start length": "2 mm", "start speed": "1 m/s", "measure length": "1 mm",
             "measure speed": "3 m/s"}  # fmt: skip
    assert places == {kind: text.index(clause) for kind, clause in (clauses | radii).items()}


@pytest.mark.parametrize("text", ["180 deg", "0.1 deg", "(180 / pi) deg", "(1 / (7 * pi)) rad"])
def test_angles_are_rounded_up(text: str, robust: Callable[[str], ir.Robust | None]) -> None:
    """Against 60 digits of pi; a larger disturbance is borne, not a smaller one."""
    digits = 314159265358979323846264338327950288419716939937510582097494
    pi = (Fraction(digits, 10**59), Fraction(digits + 1, 10**59))
    exact = {
        "180 deg": pi[1],
        "0.1 deg": pi[1] / 1800,
        "(180 / pi) deg": Fraction(1),
        "(1 / (7 * pi)) rad": 1 / (7 * pi[0]),
    }[text]
    found = robust(f"robust start {text};")
    assert found is not None
    assert exact <= found.start.angle <= exact * (1 + Fraction(1, 10**30))
    assert math.isclose(float(found.start.angle), float(exact))
    measured = robust(f"robust measure {text};")
    assert measured is not None
    assert measured.measured == found.start


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("(sqrt(2) / 10) deg", "sqrt(2) * pi / 1800"),
        ("(1 + sqrt(2)) deg", "(1 + sqrt(2)) * pi / 180"),
        ("(sin(1)) rad", "sin(1)"),
        ("(cos(1) ^ 2 - tan(0.1)) rad", "cos(1) ** 2 - tan(1 / mpf(10))"),
        ("(abs(1 - pi)) deg", "(pi - 1) * pi / 180"),
        ("(0.1 deg + 0.05 deg)", "pi * 3 / 3600"),
        ("(2 * 0.1 deg - 30 deg / 300)", "pi / 1800"),
        ("(1e-60 * sqrt(2)) rad", "sqrt(2) / mpf(10) ** 60"),
    ],
)
def test_constant_expressions_are_rounded_up(
    text: str, value: str, robust: Callable[[str], ir.Robust | None]
) -> None:
    """Against 60 digits of another library."""
    found = robust(f"robust start {text};")
    assert found is not None
    radius = found.start.angle
    with mpmath.workdps(60):
        exact = eval(value, vars(mpmath).copy())
        near = mpmath.mpf(radius.numerator) / radius.denominator
        assert exact <= near <= exact * (1 + mpmath.mpf("1e-29"))


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("robust start 1;", [("UNIT_MISMATCH", "1")]),
        ("robust start 1 kg;", [("UNIT_MISMATCH", "1 kg")]),
        ("robust start (1 m / 1 m);", [("UNIT_MISMATCH", "1 m / 1 m")]),
        ("robust start 1 mm 2 mm;", [("REPEATED_CLAUSE", "2 mm")]),
        ("robust start 1 mm; robust start 2 deg, 2 cm;", [("REPEATED_CLAUSE", "2 cm")]),
        ("robust start 0 mm;", [("BAD_VALUE", "0 mm")]),
        ("robust start (-1) mm;", [("BAD_VALUE", "(-1) mm")]),
        # Above zero, or not: nobody sees that of surds that cancel.
        ("robust start (sqrt(2) - sqrt(2)) mm;",
         [("NOT_RATIONAL", "(sqrt(2) - sqrt(2)) mm")]),
        ("robust start (1 - sqrt(2)) mm;", [("BAD_VALUE", "(1 - sqrt(2)) mm")]),
        ("robust start -1 mm;", [("BAD_VALUE", "-1 mm")]),
        ("robust start 1 mm -(2) deg;", [("BAD_VALUE", "-(2) deg")]),
        ("robust measure 1 mm, -1 deg/s;", [("BAD_VALUE", "-1 deg/s")]),
        ("robust effort 0 %;", [("BAD_VALUE", "0")]),
        ("robust effort 100 %;", [("BAD_VALUE", "100")]),
        ("robust effort 1 N %;", [("UNIT_MISMATCH", "1 N")]),
        ("robust effort 1 %; robust effort 2 %;", [("REPEATED_CLAUSE", "robust effort 2 %;")]),
        ("robust effort 0 % of bound;", [("BAD_VALUE", "0")]),
        ("robust effort -1 % of bound;", [("BAD_VALUE", "-1")]),
        ("robust effort 100 % of bound;", [("BAD_VALUE", "100")]),
        (
            "robust effort 1 % of bound; robust effort 2 %; robust effort 3 % of bound;",
            [("REPEATED_CLAUSE", "robust effort 3 % of bound;")],
        ),
        ("robust mass 0 %;", [("BAD_VALUE", "0")]),
        ("robust mass 100 %;", [("BAD_VALUE", "100")]),
        ("robust mass 1 kg %;", [("UNIT_MISMATCH", "1 kg")]),
        ("robust mass (sqrt(2)) %;", [("NOT_RATIONAL", "sqrt(2)")]),
        ("robust mass 1 %; robust mass 1 %;", [("REPEATED_CLAUSE", "robust mass 1 %;")]),
        ("robust mass 1 % of L; robust mass 2 % of L;",
         [("REPEATED_CLAUSE", "robust mass 2 % of L;")]),
        ("robust mass 0 % of L;", [("BAD_VALUE", "0")]),
        ("robust mass 1 % of M;", [("UNKNOWN_NAME", "M")]),
        ("robust mass 1 % of eps;", [("WRONG_KIND", "eps")]),
        ("robust mass 1 % of G;", [("WRONG_KIND", "G")]),
        ("robust mass 1 % of JO;", [("BAD_VALUE", "robust mass 1 % of JO;")]),
        ("robust measure 1;", [("UNIT_MISMATCH", "1")]),
        ("robust measure 1 kg;", [("UNIT_MISMATCH", "1 kg")]),
        ("robust measure 0 deg;", [("BAD_VALUE", "0 deg")]),
        ("robust measure (-1) mm;", [("BAD_VALUE", "(-1) mm")]),
        ("robust measure 1 mm; robust start 1 mm; robust measure 2 mm;",
         [("REPEATED_CLAUSE", "2 mm")]),
        ("control open loop; robust measure 1 mm;",
         [("OPEN_LOOP_MEASUREMENT", "robust measure 1 mm;")]),
        ("robust measure 1 mm; robust measure 1 deg; control open loop;",
         [("OPEN_LOOP_MEASUREMENT", "robust measure 1 mm;")]),
        ("control open loop; robust start 1 mm; robust effort 1 % of bound; robust mass 1 %;", []),
        ("control feedback; robust measure 1 mm;", []),
        ("control open loop; control feedback; robust measure 1 mm;",
         [("REPEATED_CLAUSE", "control feedback;")]),
        ("control feedback; control open loop;", [("REPEATED_CLAUSE", "control open loop;")]),
        ("control feedback; control feedback;", [("REPEATED_CLAUSE", "control feedback;")]),
    ],
)  # fmt: skip
def test_findings(
    text: str, found: list[tuple[str, str]], check_fragment: Check, build: Build
) -> None:
    assert check_fragment(build(semantics=SEMANTICS, task=TASK.format(text))) == found


@pytest.mark.parametrize(
    ("text", "found"),
    [("", None), ("control open loop;", "open loop"), ("control\tfeedback ;", "feedback")],
)
def test_control(text: str, found: str | None, build: Build) -> None:
    program = load_text(build(semantics=SEMANTICS, task=TASK.format(text)), "t").program
    assert program is not None
    task = program.tasks["P"]
    assert task.control == found
    assert ("control" in task.clauses) == bool(found)


def test_the_words_are_names_elsewhere() -> None:
    words = ["control", "open", "loop", "feedback", "measure", "mass", "bound"]
    edges = f"edge {', '.join(words)};"
    assert load_text(edges, "t").program is not None
