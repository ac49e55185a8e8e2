"""Modules: a method for each statement of the language."""

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
    """A module, as ``Module("Link", "link").param("length", between=(0.3, 0.9), unit="m")``.

    A quantity is a text with its unit, as "0.5 m", or a number in SI units; an expression is a
    text of the language.  Each method gives a new module with one statement more.

    Args:
        name: that of the module.
        role: what it is: "base", "joint", "link", "effector", or any other name.

    Raises:
        SrgcError: one of them is no name.
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
    def param(
        self,
        name: str,
        *,
        between: Range | None = None,
        choices: Any = None,
        unit: str | None = None,
    ) -> Self:
        """A parameter, for srgc to choose.

        Args:
            name: that of the parameter.
            between: its lowest and its highest value.
            choices: the values that it may have, in a list; instead of ``between``.
            unit: of numbers, as "m".

        Raises:
            SrgcError: an argument is not what it has to be.
        """
        if (between is None) == (choices is None):
            raise UsageFault("give `between` or `choices`")
        if between is not None:
            return self._with(s.Param(ident(name, "name"), interval(between, "between", unit)))
        return self._with(s.Param(ident(name, "name"), _choices(choices, unit)))

    @spoken
    def const(self, name: str, value: Quantity | Vector, unit: str | None = None) -> Self:
        """A constant, which other statements name.

        Args:
            name: that of the constant.
            value: a quantity or an expression, also of parameters and constants.
            unit: of a number, as "kg/m".

        Raises:
            SrgcError: an argument is not what it has to be.
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
    ) -> Self:
        """A degree of freedom.

        Args:
            name: that of the coordinate, as "q".
            kind: "revolute", it turns, or "prismatic", it slides.
            axis: about or along which: "x", "y" or "z", with a sign or without.
            between: its lowest and its highest value (rad, m).
            rate: the largest rate, or the lowest and the highest (rad/s, m/s).
            accel: the largest acceleration (rad/s^2, m/s^2).
            effort: the largest torque or force (N*m, N).

        Raises:
            SrgcError: an argument is not what it has to be.
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
        """The drive of a degree of freedom.

        Args:
            dof: the name of the coordinate.
            gear: rotor turns for one of the joint (1), or for a length (1/m).
            rotor: the inertia of the rotor (kg*m^2).
            viscous: viscous friction (N*m*s, N*s/m).
            coulomb: dry friction (N*m, N).

        Raises:
            SrgcError: an argument is not what it has to be.
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
        """A state of the module's own, whose derivative ``der`` says.

        Args:
            name: that of the state.
            unit: of the state; None for a plain number.
            initial: its value at the start, 0 where it is left out.

        Raises:
            SrgcError: an argument is not what it has to be.
        """
        start = None if initial is None else expression(initial, "initial", unit)
        return self._with(s.State(ident(name, "name"), unit_of(unit), start))

    @spoken
    def input(self, name: str, *, between: Range, unit: str | None = None) -> Self:
        """An input of the module's own.

        Args:
            name: that of the input.
            between: its lowest and its highest value.
            unit: of numbers, as "V".

        Raises:
            SrgcError: an argument is not what it has to be.
        """
        return self._with(s.Input(ident(name, "name"), interval(between, "between", unit)))

    @spoken
    def der(self, state: str, value: Quantity) -> Self:
        """The derivative of a state by time.

        Args:
            state: the name of the state.
            value: an expression.

        Raises:
            SrgcError: an argument is not what it has to be.
        """
        return self._with(s.Derivative(ident(state, "state"), expression(value, "value")))

    @spoken
    def torque(self, dof: str, value: Quantity) -> Self:
        """The torque or the force on a degree of freedom; it is no input then.

        Args:
            dof: the name of the coordinate.
            value: an expression (N*m, N).

        Raises:
            SrgcError: an argument is not what it has to be.
        """
        return self._with(s.Torque(ident(dof, "dof"), expression(value, "value")))

    @spoken
    def port(
        self,
        name: str,
        type: str,  # noqa: A002 - its word in the language
        gender: Literal["male", "female"] | None = None,
    ) -> Self:
        """A port, for a grammar from ports: "in", by which it is mounted, or an output.

        Args:
            name: "in", or that of an output, which also is a frame.
            type: what fits has the same.
            gender: "male" fits "female"; None fits None.

        Raises:
            SrgcError: an argument is not what it has to be.
        """
        if gender not in (None, "male", "female"):
            raise UsageFault(f'`gender` is "male", "female" or None, not {shown(gender)}')
        return self._with(s.Port(ident(name, "name"), ident(type, "type"), gender))

    @spoken
    def frame(self, name: str, value: str) -> Self:
        """A frame of a module with ports, counted from ``in``.

        Args:
            name: that of the frame; of an output, where the next module stands.
            value: an expression, as "in * move(z, length) * rot(z, q)".

        Raises:
            SrgcError: an argument is not what it has to be.
        """
        return self._with(s.Frame(ident(name, "name"), expression(value, "value")))

    @spoken
    def body(self, kind: str, **arguments: Quantity | Vector) -> Self:
        """A body, a shape or an effector of a module with ports.

        Args:
            kind: as "rod", "point", "solid", "sphere", "capsule", "cylinder", "box", "hull",
                "visual" or "effector".
            arguments: those that it has in the language, as ``frame="in"`` and ``mass="2 kg"``;
                numbers are in SI units, and ``file`` is a path.

        Raises:
            SrgcError: an argument is not what it has to be.
        """
        given = tuple(
            s.Argument(ident(name, "arguments"), _of_body(name, value))
            for name, value in arguments.items()
        )
        return self._with(s.Emission(ident(kind, "kind"), given))

    @spoken
    def statement(self, text: str) -> Self:
        """Statements as a text of the language, for what has no method.

        Args:
            text: as "port in: Flange; port out: Flange;".

        Raises:
            SrgcError: they are no statements of a module.
        """
        return self._with(*read_all("module M {", text, "}", "text", "statements of a module"))


def _choices(value: object, unit: str | None) -> s.Choices:
    return choices(value, "choices", unit)


def _of_body(name: str, value: object) -> s.Expr:
    if name == "file" and isinstance(value, str):
        return s.Text(s.Ident(value))
    return expression(value, name)
