"""One robot of a family, with its equations of motion as functions of arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import isfinite
from typing import TYPE_CHECKING, Literal, TypeAlias

from srgc.api.program import Specification, program_of, symbols
from srgc.api.spoken_faults import spoken
from srgc.chosen_robot import ChosenRobot, RobotRequest, chosen_robot
from srgc.faults import UsageFault

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from compiler.arrays import Array
    from compiler.discretisation.numeric_robot import NumericRobot
    from compiler.robots.robot import RobotParameter


Values: TypeAlias = "Mapping[str, float] | Sequence[float]"
"""Parameters by name, such as ``{"4.length": 2.23}``, or all of them in order; in SI units."""


@dataclass(frozen=True)
class Robot:
    """A robot with values of its parameters; a notebook displays its drawing.

    Its equations of motion are M(q) q'' + c(q, q') + g(q) = tau.  With n degrees of freedom, ``q``
    and ``qd`` have the shape (n,), or (K, n) for K poses at once.  Angles are in rad, other values
    in SI units.  All results are floating-point numbers, for inspection and simulation; no proof
    uses them.

    Attributes:
        chosen: the robot as its family defines it; not a stable interface.
        theta: the exact values of its parameters, in SI units.
    """

    chosen: ChosenRobot
    theta: tuple[Fraction, ...]

    @property
    def word(self) -> str:
        """The symbols of its modules and edges, separated by blanks."""
        return " ".join(self.chosen.word)

    @property
    def derivation(self) -> tuple[str, ...]:
        """The labels of the productions in the leftmost derivation of the word."""
        return self.chosen.labels

    @property
    def parameters(self) -> dict[str, float]:
        """The values of its parameters in SI units, by symbol index and name: ``"4.length"``."""
        names = (each.label for each in self.chosen.model.parameters)
        return {name: float(value) for name, value in zip(names, self.theta, strict=True)}

    @property
    def dofs(self) -> tuple[Literal["revolute", "prismatic"], ...]:
        """The kind of each degree of freedom, in the order of ``q``."""
        return tuple(dof.kind for dof in self.chosen.model.dofs)

    @cached_property
    def _numeric(self) -> NumericRobot:
        from compiler.discretisation.numeric_robot import NumericRobot
        from compiler.dynamics.equations_of_motion import robot_graph

        return NumericRobot(robot_graph(self.chosen.model, self.chosen.gravity))

    @cached_property
    def _values(self) -> Array:
        import numpy as np

        return np.array([float(value) for value in self.theta], dtype=np.float64)

    @spoken
    def mass_matrix(self, q: ArrayLike) -> Array:
        """The mass matrix M at ``q``, shape (n, n) or (K, n, n).

        The rows of revolute joints are in kg*m^2, those of prismatic joints in kg.

        Raises:
            SrgcError: ``q`` has another shape.
        """
        poses, single = self._poses(q, "q")
        found = self._numeric.mass_matrix(poses, self._values)
        return found[0] if single else found

    @spoken
    def coriolis(self, q: ArrayLike, qd: ArrayLike) -> Array:
        """The centrifugal and Coriolis forces c, shape (n,) or (K, n).

        They are in N*m for revolute joints, in N for prismatic joints.

        Raises:
            SrgcError: ``q`` or ``qd`` has another shape, or they have different numbers of poses
                and neither is a single pose.
        """
        import numpy as np

        poses, single = self._poses(q, "q")
        rates, _ = self._poses(qd, "qd")
        if len(poses) != len(rates) and 1 not in (len(poses), len(rates)):
            raise UsageFault(f"`q` has {len(poses)} poses, and `qd` {len(rates)}")
        poses, rates = np.broadcast_arrays(poses, rates)
        function = self._numeric.graph.centrifugal
        rows = [
            function(pose, rate, self._values, self._numeric.constants).full()[:, 0]
            for pose, rate in zip(poses, rates, strict=True)
        ]
        found = np.array(rows, dtype=np.float64).reshape(len(rows), len(self.dofs))
        return found[0] if single and len(found) == 1 else found

    @spoken
    def gravity(self, q: ArrayLike) -> Array:
        """The gravitational forces g, shape (n,) or (K, n); zero without a task.

        They are in N*m for revolute joints, in N for prismatic joints.

        Raises:
            SrgcError: ``q`` has another shape.
        """
        import numpy as np

        poses, single = self._poses(q, "q")
        function = self._numeric.graph.gravitational
        rows = [
            function(pose, self._values, self._numeric.constants).full()[:, 0] for pose in poses
        ]
        found = np.array(rows, dtype=np.float64).reshape(len(rows), len(self.dofs))
        return found[0] if single else found

    @spoken
    def effectors(self, q: ArrayLike) -> Array:
        """The positions of its e effectors in m, shape (e, d) or (K, e, d); d is 2 or 3.

        Raises:
            SrgcError: ``q`` has another shape.
        """
        poses, single = self._poses(q, "q")
        found = self._numeric.places(poses, self._values)
        return found[0] if single else found

    @spoken
    def equations(self, form: Literal["text", "latex", "smt2"] = "text") -> str:
        """The equations of motion with symbolic parameters, as ``srgc model`` prints them.

        Args:
            form: plain text, LaTeX, or an SMT-LIB script.

        Raises:
            SrgcError: ``form`` is none of these.
        """
        from srgc.text_reports.model_report import model_text

        if form not in ("text", "latex", "smt2"):
            raise UsageFault("`form` is text, latex or smt2")
        return model_text(self.chosen, form)

    @spoken
    def svg(self, q: ArrayLike | None = None) -> str:
        """A drawing in the pose ``q`` (n,), by default with bent joints.

        Raises:
            SrgcError: ``q`` has another shape, or is not finite.
        """
        from srgc.render.pose_picture import pose_picture

        pose = None if q is None else self._pose(q)
        return pose_picture(self.chosen.model, self._values, pose)

    def _pose(self, q: ArrayLike) -> Array:
        """A single finite pose (n,)."""
        import numpy as np

        poses, single = self._poses(q, "q")
        if not single or not np.isfinite(poses).all():
            raise UsageFault(f"`q` is one pose to be drawn: {len(self.dofs)} finite numbers")
        pose: Array = poses[0]
        return pose

    def _poses(self, q: ArrayLike, name: str) -> tuple[Array, bool]:
        """Coordinates as (K, n), and whether a single pose was given."""
        import numpy as np

        try:
            found, n = np.asarray(q, dtype=np.float64), len(self.dofs)
        except (TypeError, ValueError, OverflowError):
            raise UsageFault(f"`{name}` is not an array of numbers") from None
        if found.ndim not in (1, 2) or found.shape[-1] != n:
            raise UsageFault(
                f"`{name}` has the shape {found.shape}: ({n},) or (K, {n}) is expected"
            )
        return np.atleast_2d(found), found.ndim == 1

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value:.6g}" for name, value in self.parameters.items())
        return f"<Robot {self.word}{': ' if values else ''}{values}>"

    def __str__(self) -> str:
        return self.equations()

    def _repr_html_(self) -> str:
        from srgc.api.displays import robot_html

        return robot_html(self.chosen, self._values)


@spoken
def robot(
    program: Specification,
    word: str | Sequence[str],
    parameters: Values | None = None,
    *,
    grammar: str | None = None,
    task: str | None = None,
    workspace: str | None = None,
    derivation: int | None = None,
) -> Robot:
    """Build the robot of a word of a family.

    Args:
        program: the specification, or the path of its file.
        word: the symbols of its modules and edges, as a sequence or a text with blanks.
        parameters: the values of its parameters.  A parameter without a value gets the middle of
            its range, or the first of its choices.
        grammar: the family; may be omitted if there is only one.
        task: the task whose gravity acts on the robot; by default there is no gravity.
        workspace: the workspace that says whether the robot moves in the plane or in space; may be
            omitted if all workspaces agree.
        derivation: the number of a derivation of the word, from 1.

    Raises:
        SrgcError: the word is not in the family or is not a robot, or a value is not in the range
            of its parameter.
    """
    if derivation is not None and derivation < 1:
        raise UsageFault("`derivation` counts from 1")
    request = RobotRequest(symbols(word), grammar, task, workspace, derivation)
    chosen = chosen_robot(program_of(program).ir, request)
    return Robot(chosen, _theta(chosen.model.parameters, parameters))


def _theta(known: Sequence[RobotParameter], given: Values | None) -> tuple[Fraction, ...]:
    """The exact value of every parameter."""
    names = [each.label for each in known]
    if given is None:
        given = {}
    if not isinstance(given, Mapping):
        if len(given) != len(names):
            raise UsageFault(f"{len(given)} parameters: the robot has {', '.join(names) or 'none'}")
        given = dict(zip(names, given, strict=True))
    for name in given:
        if name not in names:
            has = ", ".join(names) or "none"
            raise UsageFault(f"the robot has no parameter `{name}`: it has {has}")
    return tuple(
        _value(each, given[name]) if name in given else _usual(each)
        for name, each in zip(names, known, strict=True)
    )


def _value(parameter: RobotParameter, value: float) -> Fraction:
    from compiler.descriptions.model_symbols import domain_text
    from compiler.expressions.exact_numbers import shortest_decimal
    from compiler.robots.parameter_values import stated_value

    name = parameter.label
    try:
        finite = isfinite(value)
    except (TypeError, OverflowError):
        finite = False
    if not finite:
        raise UsageFault(f"{name} is {value!r}: a finite number is expected")
    found = stated_value(parameter, shortest_decimal(value))
    if found is None:
        domain = domain_text(parameter.domain, parameter.unit)
        raise UsageFault(f"{name} = {value:g} is not {domain}")
    return found.stated


def _usual(parameter: RobotParameter) -> Fraction:
    """The middle of a range, or the first of several choices."""
    from compiler.expressions.exact_numbers import shortest_decimal
    from grammar_lang import ir
    from grammar_lang.ir.constants import to_float

    if isinstance(parameter.domain, ir.Choices):
        return shortest_decimal(to_float(parameter.domain.values[0]))
    low, high = to_float(parameter.domain.lower), to_float(parameter.domain.upper)
    return shortest_decimal((low + high) / 2)
