"""What is known of a robot before it is searched: what was found of shorter ones that it extends.

Theorem 1, where its hypothesis holds (``compiler/semantics/neutral_extension.py``): at neutral
values the longer robot is the shorter one.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from compiler.grammars.derivation import Derivation
from compiler.robots.robot import RobotModel, RobotParameter
from compiler.semantics.family import RobotFamily
from compiler.semantics.neutral_extension import neutral_extensions, neutral_modules
from compiler.semantics.neutral_parameters import NeutralParameters
from solvers.design import Design


@dataclass(frozen=True, slots=True)
class Searched:
    """The best parameters found for a robot, SI, and its design if it has one."""

    number: int
    parameters: tuple[RobotParameter, ...]
    theta: tuple[float, ...]
    design: Design | None


@dataclass(frozen=True, slots=True)
class Inherited:
    """Parameters at which a robot is the shorter one with that number, at its best, as a design."""

    number: int
    theta: tuple[float, ...]
    design: Design | None

    @property
    def robustness(self) -> float:
        """That of the design, minus infinity without one."""
        return -np.inf if self.design is None else self.design.robustness


@dataclass
class Inheritance:
    """The robots of a family that were searched, by their derivations."""

    family: RobotFamily
    searched: dict[tuple[str, ...], Searched] = field(
        default_factory=dict[tuple[str, ...], Searched]
    )

    @cached_property
    def modules(self) -> dict[str, NeutralParameters]:
        """The modules that can be made to change nothing."""
        return neutral_modules(self.family)

    def remember(self, derivation: Derivation, searched: Searched) -> None:
        """A robot has been searched."""
        self.searched[derivation.labels] = searched

    def of(self, derivation: Derivation, model: RobotModel) -> tuple[Inherited, ...]:
        """What shorter robots hand on to a robot, each once."""
        if not self.searched:
            return ()
        found = dict[tuple[int, tuple[float, ...]], Inherited]()
        for extension in neutral_extensions(derivation, self.modules):
            known = self.searched.get(extension.shorter)
            if known is not None:
                theta = extension.parameters(model.parameters, known.parameters, known.theta)
                found[known.number, theta] = Inherited(known.number, theta, known.design)
        return tuple(found.values())
