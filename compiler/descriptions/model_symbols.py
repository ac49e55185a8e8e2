"""Short names for the coordinates, rates, states, inputs and parameters of a robot.

Coordinates, rates, states and inputs are named like the columns of a stored trajectory: q1, qd1,
s1, u1. A parameter is named by the first letter of its name if no other begins with it, and
numbered in word order: l1 and l2 are the first and second ``length``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from compiler.expressions.trigonometric_polynomial import Variable
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.ir.constants import MagnitudeError, Monomial, monomial
from grammar_lang.ir.expression_text import expression_text, number_text

RESERVED = frozenset({"q", "qd", "qdd", "s", "u", "w", "c", "g", "e", "tau", "pi", "M"})
GREEK = frozenset(
    {
        "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa",
        "lambda", "mu", "nu", "xi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega",
    }
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class ModelSymbols:
    """The names of a robot's parameters: plain, and in LaTeX."""

    parameters: tuple[tuple[str, str], ...]

    def text(self, variable: Variable) -> str:
        """The plain name of a variable."""
        number = variable.index + 1
        match variable.kind:
            case "coordinate":
                return f"q{number}"
            case "rate":
                return f"qd{number}"
            case "parameter":
                return self.parameters[variable.index][0]

    def latex(self, variable: Variable) -> str:
        """The name of a variable in LaTeX."""
        number = variable.index + 1
        match variable.kind:
            case "coordinate":
                return f"q_{{{number}}}"
            case "rate":
                return rf"\dot{{q}}_{{{number}}}"
            case "parameter":
                return self.parameters[variable.index][1]


def model_symbols(model: RobotModel) -> ModelSymbols:
    """Distinct names for the symbols of a robot."""
    names = [parameter.name for parameter in model.parameters]
    initials = Counter(name[0] for name in dict.fromkeys(names))
    seen: Counter[str] = Counter()
    taken: set[str] = set()
    found: list[tuple[str, str]] = []
    for name in names:
        seen[name] += 1
        stem = name[0] if initials[name[0]] == 1 and name[0] not in RESERVED else name
        text = _plain(stem, seen[name])
        while text in taken:
            text += "_"
        taken.add(text)
        found.append((text, f"{_latex_stem(name, stem)}_{{{seen[name]}}}"))
    return ModelSymbols(tuple(found))


def _plain(stem: str, number: int) -> str:
    ambiguous = stem in RESERVED or stem[-1].isdigit()
    return f"{stem}_{number}" if ambiguous else f"{stem}{number}"


def _latex_stem(name: str, stem: str) -> str:
    if name in GREEK:
        return rf"\{name}"
    if stem == "l":
        return r"\ell"
    if len(stem) == 1:
        return stem
    escaped = stem.replace("_", r"\_")
    return rf"\mathrm{{{escaped}}}"


# --- Ranges and finite sets of values as text -----------------------------------------------------


DEGREES = 180


def domain_text(domain: ir.Interval | ir.Choices | None, unit: str) -> str:
    """``in [0.5, 5] m``, ``in {1, 2} m`` or ``unbounded``; multiples of pi in degrees.

    ``unit`` is the unit of the bare numbers, empty if there is none.
    """
    if domain is None:
        return "unbounded"
    ends = (domain.lower, domain.upper) if isinstance(domain, ir.Interval) else domain.values
    texts, unit = _values(ends, unit)
    inside = ", ".join(texts)
    bracketed = f"[{inside}]" if isinstance(domain, ir.Interval) else f"{{{inside}}}"
    return f"in {bracketed} {'' if unit == '1' else unit}".rstrip()


def _values(values: Sequence[ir.Expr], unit: str) -> tuple[list[str], str]:
    exact = [_exact(value) for value in values]
    if unit.startswith("rad") or not unit:
        known = [q for q, k in filter(None, exact) if k == 1 or not q]
        if len(known) == len(values) and any(known):
            degrees = unit.replace("rad", "deg", 1) or "deg"
            return [number_text(value * DEGREES) for value in known], degrees
    return [
        number_text(found[0]) if found is not None and found[1] == 0 else closed_text(value)
        for value, found in zip(values, exact, strict=True)
    ], unit


def _exact(value: ir.Expr) -> Monomial | None:
    try:
        return monomial(value)
    except MagnitudeError:
        return None


def closed_text(value: ir.Expr) -> str:
    """A closed expression as text."""
    return expression_text(value, str)
