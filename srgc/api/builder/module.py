"""Modules, with a method for each statement of the language."""

from __future__ import annotations

from typing import Any, Literal, Self

from grammar_lang import syntax as s
from srgc.api.builder.arguments import (
    Quantity,
    Range,
    Vector,
    choices,
    expression,
    ident,
    interval,
    quotable,
    read_all,
    shown,
    symmetric,
    unit_of,
)
from srgc.api.builder.part import Part
from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault

Kind = Literal["revolute", "prismatic"]
AXES = ("x", "y", "z", "-x", "-y", "-z")
_TURNING = ("rad", "rad/s", "rad/s^2", "N*m")
_SLIDING = ("m", "m/s", "m/s^2", "N")


class Module(Part):
    """A module: ``Module("Link", "link").param("length", between=(0.3, 0.9), unit="m")``.

    A quantity is a text with its unit, such as "0.5 m", or a number in SI units.  An expression is
    a text of the language.  Each method returns a new module with one more statement.

    Args:
        name: the name of the module.
        role: its role: "base", "joint", "link", "effector", or any other name.

    Raises:
        SrgcError: one of the arguments is not a name.
    """

    __slots__ = ()

    @spoken
    def __init__(self, name: str, role: str) -> None:
        statements = (s.Role(ident(role, "role")),)
        super().__init__((s.Module(ident(name, "name"), statements),))

    @property
    def name(self) -> str:
        """The name of the module."""
        return self._module.name.text

    @property
    def _module(self) -> s.Module:
        (module,) = self._items
        assert isinstance(module, s.Module)  # noqa: S101 - of no other item it is made
        return module

    def _with(self, *statements: s.ModuleItem) -> Self:
        module = self._module
        return self._copied((s.Module(module.name, (*module.items, *statements)),))

    @spoken
    def named(self, text: str) -> Self:
        """Give the part a name in exports, such as "upper_arm_link".

        Raises:
            SrgcError: the argument is no text that can be quoted.
        """
        return self._with(s.Named(quotable(text, "text")))

    @spoken
    def param(
        self,
        name: str,
        *,
        between: Range | None = None,
        choices: Any = None,
        unit: str | None = None,
    ) -> Self:
        """Add a parameter, whose value srgc chooses.

        Args:
            name: the name of the parameter.
            between: its lowest and its highest value.
            choices: a list of its possible values, instead of ``between``.
            unit: the unit of numbers, such as "m".

        Raises:
            SrgcError: an argument is invalid.
        """
        if (between is None) == (choices is None):
            raise UsageFault("give `between` or `choices`")
        if between is not None:
            return self._with(s.Param(ident(name, "name"), interval(between, "between", unit)))
        return self._with(s.Param(ident(name, "name"), _choices(choices, unit)))

    @spoken
    def const(self, name: str, value: Quantity | Vector, unit: str | None = None) -> Self:
        """Add a constant that other statements can use.

        Args:
            name: the name of the constant.
            value: a quantity or an expression, which may use parameters and constants.
            unit: the unit of a number, such as "kg/m".

        Raises:
            SrgcError: an argument is invalid.
        """
        return self._with(s.Const(ident(name, "name"), expression(value, "value", unit)))

    @spoken
    def dof(
        self,
        name: str,
        kind: Kind,
        axis: str,
        *,
        between: Range | None = None,
        rate: Range | Quantity | None = None,
        accel: Quantity | None = None,
        effort: Quantity | None = None,
        named: str | None = None,
    ) -> Self:
        """Add a degree of freedom.

        Args:
            name: the name of the coordinate, such as "q".
            kind: "revolute" for a rotation, "prismatic" for a translation.
            axis: the axis of the motion: "x", "y" or "z", or one of them with a minus sign.
            between: the lowest and the highest value of the coordinate (rad, m).
            rate: the largest rate, or the lowest and the highest (rad/s, m/s).
            accel: the largest acceleration (rad/s^2, m/s^2).
            effort: the largest torque or force (N*m, N).
            named: the name of the joint in exports.

        Raises:
            SrgcError: an argument is invalid.
        """
        if kind not in ("revolute", "prismatic"):
            raise UsageFault(f'`kind` is "revolute" or "prismatic", not {shown(kind)}')
        if axis not in AXES:
            raise UsageFault(f"`axis` is one of {', '.join(AXES)}, not {shown(axis)}")
        units = _TURNING if kind == "revolute" else _SLIDING
        return self._with(
            s.Dof(
                ident(name, "name"),
                kind,
                axis,  # type: ignore[arg-type]  # it is one of AXES
                None if between is None else interval(between, "between", units[0]),
                None if rate is None else symmetric(rate, "rate", units[1]),
                None if accel is None else expression(accel, "accel", units[2]),
                None if effort is None else expression(effort, "effort", units[3]),
                None if named is None else quotable(named, "named"),
            )
        )

    @spoken
    def drive(
        self,
        dof: str,
        *,
        gear: Quantity | None = None,
        rotor: Quantity | None = None,
        viscous: Quantity | None = None,
        coulomb: Quantity | None = None,
    ) -> Self:
        """Describe the drive of a degree of freedom.

        Args:
            dof: the name of the coordinate.
            gear: the ratio of rotor motion to joint motion (1, or rad/m for a prismatic joint).
            rotor: the moment of inertia of the rotor (kg*m^2).
            viscous: the viscous friction of the joint (N*m*s, N*s/m).
            coulomb: the dry friction of the joint (N*m, N).

        Raises:
            SrgcError: an argument is invalid.
        """
        given: dict[Literal["gear", "rotor", "viscous", "coulomb"], Quantity | None] = {
            "gear": gear, "rotor": rotor, "viscous": viscous, "coulomb": coulomb,
        }  # fmt: skip
        parts = tuple(
            s.DrivePart(kind, expression(value, kind, "kg*m^2" if kind == "rotor" else None))
            for kind, value in given.items()
            if value is not None
        )
        if not parts:
            raise UsageFault(f"give one of {', '.join(f'`{kind}`' for kind in given)}")
        return self._with(s.Drive(ident(dof, "dof"), parts))

    @spoken
    def state(self, name: str, *, unit: str | None = None, initial: Quantity | None = None) -> Self:
        """Add a module state; ``der`` gives its derivative.

        Args:
            name: the name of the state.
            unit: its unit; None for a plain number.
            initial: its value at the start, by default 0.

        Raises:
            SrgcError: an argument is invalid.
        """
        start = None if initial is None else expression(initial, "initial", unit)
        return self._with(s.State(ident(name, "name"), unit_of(unit), start))

    @spoken
    def input(self, name: str, *, between: Range, unit: str | None = None) -> Self:
        """Add an input of the module.

        Args:
            name: the name of the input.
            between: its lowest and its highest value.
            unit: the unit of numbers, such as "V".

        Raises:
            SrgcError: an argument is invalid.
        """
        return self._with(s.Input(ident(name, "name"), interval(between, "between", unit)))

    @spoken
    def der(self, state: str, value: Quantity) -> Self:
        """Set the time derivative of a state.

        Args:
            state: the name of the state.
            value: an expression for its derivative.

        Raises:
            SrgcError: an argument is invalid.
        """
        return self._with(s.Derivative(ident(state, "state"), expression(value, "value")))

    @spoken
    def torque(self, dof: str, value: Quantity) -> Self:
        """Set the torque or force on a degree of freedom, instead of a free input.

        Args:
            dof: the name of the coordinate.
            value: an expression for the torque or force (N*m, N).

        Raises:
            SrgcError: an argument is invalid.
        """
        return self._with(s.Torque(ident(dof, "dof"), expression(value, "value")))

    @spoken
    def port(
        self,
        name: str,
        type: str,  # noqa: A002 - its word in the language
        gender: Literal["male", "female"] | None = None,
    ) -> Self:
        """Add a port, for a grammar from ports: "in", on which the module is mounted, or an output.

        Args:
            name: "in", or the name of an output, which is also a frame.
            type: the type; ports fit only if they have the same type.
            gender: "male" fits "female", and None fits None.

        Raises:
            SrgcError: an argument is invalid.
        """
        if gender not in (None, "male", "female"):
            raise UsageFault(f'`gender` is "male", "female" or None, not {shown(gender)}')
        return self._with(s.Port(ident(name, "name"), ident(type, "type"), gender))

    @spoken
    def frame(self, name: str, value: str) -> Self:
        """Add a frame to a module with ports, relative to ``in``.

        Args:
            name: the name of the frame; that of an output places the next module.
            value: an expression, such as "in * move(z, length) * rot(z, q)".

        Raises:
            SrgcError: an argument is invalid.
        """
        return self._with(s.Frame(ident(name, "name"), expression(value, "value")))

    @spoken
    def body(self, kind: str, **arguments: Quantity | Vector) -> Self:
        """Add a body, a shape or an effector to a module with ports.

        Args:
            kind: such as "rod", "point", "solid", "sphere", "capsule", "cylinder", "box", "hull",
                "visual" or "effector".
            arguments: its arguments in the language, such as ``frame="in"`` and ``mass="2 kg"``;
                numbers are in SI units, and ``file`` is a path.

        Raises:
            SrgcError: an argument is invalid.
        """
        given = tuple(
            s.Argument(ident(name, "arguments"), _of_body(name, value))
            for name, value in arguments.items()
        )
        return self._with(s.Emission(ident(kind, "kind"), given))

    @spoken
    def statement(self, text: str) -> Self:
        """Add statements given as a text of the language, for those without a method.

        Args:
            text: such as "port in: Flange; port out: Flange;".

        Raises:
            SrgcError: the text does not consist of statements of a module.
        """
        return self._with(*read_all("module M {", text, "}", "text", "statements of a module"))


def _choices(value: object, unit: str | None) -> s.Choices:
    return choices(value, "choices", unit)


def _of_body(name: str, value: object) -> s.Expr:
    if name == "file" and isinstance(value, str):
        return s.Text(s.Ident(value))
    return expression(value, name)
