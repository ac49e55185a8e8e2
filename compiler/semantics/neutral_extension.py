"""Robots that extend a shorter one by a module that can be made to change nothing (Theorem 1).

Where a production ``A -> A z`` has neutral values for z (``neutral_parameters``), every derivation
that uses it has a shorter one without it, and at those values both make the same robot.  So each
motion of the shorter robot is one of the longer, and the best robustness of the longer is not less.
Where the hypothesis does not hold, nothing is said: there the theorem is false in general.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from compiler.grammars.derivation import Derivation
from compiler.robots.robot import RobotParameter
from compiler.semantics.family import RobotFamily
from compiler.semantics.neutral_parameters import NeutralParameters, Values, neutral_parameters
from compiler.semantics.parameter_domains import MultipleOfPi, Value
from grammar_lang import ir
from grammar_lang.ir.constants import to_float


@dataclass(frozen=True, slots=True)
class NeutralExtension:
    """How a structure extends a shorter one.

    ``shorter`` is the leftmost derivation of that, ``added`` are the indices of the symbols that
    it lacks in the word of the longer, ``values`` the neutral values of the module at ``symbol``.
    """

    shorter: tuple[str, ...]
    added: tuple[int, ...]
    symbol: int
    values: Values

    def parameters(
        self,
        longer: Sequence[RobotParameter],
        shorter: Sequence[RobotParameter],
        theta: Sequence[float],
    ) -> tuple[float, ...]:
        """Parameters of the longer robot at which it is the shorter one at ``theta``, SI.

        Those of the added module that may have any value have a least one.

        Args:
            longer: the parameters of the longer robot.
            shorter: those of the shorter one.
            theta: their values.

        Raises:
            KeyError: a parameter is of neither.
        """
        old = {(p.symbol, p.name): value for p, value in zip(shorter, theta, strict=True)}
        neutral = dict(self.values)
        found = []
        for parameter in longer:
            if parameter.symbol == self.symbol:
                found.append(_at_neutral(parameter, neutral))
            else:
                before = sum(1 for index in self.added if index < parameter.symbol)
                found.append(old[parameter.symbol - before, parameter.name])
        return tuple(found)


def neutral_modules(family: RobotFamily) -> dict[str, NeutralParameters]:
    """The modules that have neutral values, by the label of their production."""
    findings = neutral_parameters(family.program, family.grammar)
    return {item.production: item for item in findings if item.status == "neutral"}


def neutral_extensions(
    derivation: Derivation, modules: Mapping[str, NeutralParameters]
) -> list[NeutralExtension]:
    """The shorter structures that a structure extends by one module, in the order of its nodes."""
    labels = derivation.labels
    found = []
    for node, each in enumerate(derivation.nodes):
        module = modules.get(each.production.label)
        if module is None:
            continue
        right = each.production.right
        own = (
            child
            for child, symbol in zip(each.children, right, strict=True)
            if symbol.kind != "nonterminal"
        )
        symbol = each.children[module.occurrence]
        shorter = (*labels[:node], *labels[node + 1 :])
        found.append(NeutralExtension(shorter, tuple(own), symbol, module.values))
    return found


def _at_neutral(parameter: RobotParameter, neutral: Mapping[str, Value]) -> float:
    """The neutral value of a parameter, or the least of its domain where any will do."""
    value = neutral.get(parameter.name)
    if value is not None:
        return _float(value)
    domain = parameter.domain
    if isinstance(domain, ir.Interval):
        return to_float(domain.lower)
    return min(to_float(choice) for choice in domain.values)


def _float(value: Value) -> float:
    return float(value.factor) * math.pi if isinstance(value, MultipleOfPi) else float(value)
