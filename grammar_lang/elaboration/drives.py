"""Drives of joints: bounds on effort and acceleration, and ``drive q: gear … rotor …;``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.closed import Constants
from grammar_lang.elaboration.sorts import LARGEST, SMALLEST
from grammar_lang.ir import constants
from grammar_lang.units import FORCE, INERTIA, LENGTH, ONE, TIME, TORQUE, Dimension

EFFORT_DIMENSIONS: Mapping[ir.DofKind, Dimension] = {"revolute": TORQUE, "prismatic": FORCE}
_COORDINATES: Mapping[ir.DofKind, Dimension] = {"revolute": ONE, "prismatic": LENGTH}

Kind: TypeAlias = Literal["gear", "rotor", "viscous", "coulomb"]


def lower_effort(item: s.Dof, reader: Constants, sink: Sink) -> ir.Expr | None:
    """The effort bound of a degree of freedom, closed and in SI units; None if it has none."""
    return _lower_bound(item.effort, "effort", EFFORT_DIMENSIONS[item.kind], reader, sink)


def lower_acceleration(item: s.Dof, reader: Constants, sink: Sink) -> ir.Expr | None:
    """The acceleration bound of a degree of freedom, closed and in SI units; None without one."""
    due = _COORDINATES[item.kind] / TIME / TIME
    return _lower_bound(item.accel, "acceleration", due, reader, sink)


def _lower_bound(
    bound: s.Expr | None, what: str, due: Dimension, reader: Constants, sink: Sink
) -> ir.Expr | None:
    if bound is None:
        return None
    found = reader.scalar(bound, due)
    if found is not None and not constants.to_float(found) > 0:
        message = f"the {what} bound is not positive"
        sink.error(Code.BAD_VALUE, message, bound.span, "write more than zero")
        return None
    return found


@dataclass(slots=True)
class DriveReader:
    """Reads the drives of a module with degrees of freedom ``dofs``, using its constants."""

    reader: Constants
    dofs: dict[str, ir.Dof]
    sink: Sink
    seen: dict[str, s.Drive] = field(default_factory=dict[str, s.Drive])
    viscous: dict[str, ir.Expr] = field(default_factory=dict[str, ir.Expr])

    def read(self, item: s.Drive) -> None:
        """Read one drive and report its errors."""
        name = item.name.text
        dof = self.dofs.get(name)
        if dof is None:
            message = f"no degree of freedom is called `{name}`"
            hint = did_you_mean(name, self.dofs, "degree of freedom", self.sink)
            self.sink.error(Code.UNKNOWN_NAME, message, item.name.span, hint)
            return
        if name in self.seen:
            notes = [(self.seen[name].span, "first here")]
            message = f"a second `drive {name}`"
            self.sink.error(Code.REPEATED_CLAUSE, message, item.span, "remove one", notes)
            return
        self.seen[name] = item
        parts = dict[Kind, ir.Expr]()
        for part in item.parts:
            if part.kind in parts:
                message, hint = f"a second `{part.kind}` of one drive", "remove one"
                self.sink.error(Code.REPEATED_CLAUSE, message, part.span, hint)
                continue
            value = self._value(part, dof.kind)
            if value is not None:
                parts[part.kind] = value
        self._keep(item, dof, parts)

    def _keep(self, item: s.Drive, dof: ir.Dof, parts: Mapping[Kind, ir.Expr]) -> None:
        """Store the parts of a drive in its degree of freedom."""
        name, rotor = item.name.text, parts.get("rotor")
        coulomb = parts.get("coulomb")
        if coulomb is not None and constants.to_float(coulomb) > 0:
            dof = replace(dof, coulomb=coulomb)
        dof = replace(dof, gear=parts.get("gear"))
        if "viscous" in parts:
            self.viscous[name] = parts["viscous"]
        if rotor is not None:
            if dof.kind == "prismatic" and "gear" not in parts:
                message = "the rotor of a prismatic joint needs a `gear`, its turns (rad) per metre"
                self.sink.error(Code.BAD_VALUE, message, item.span, "add `gear 100 m^-1`")
                return
            gear = parts.get("gear", ir.Num(Fraction(1)))
            inertia = ir.Binary("*", ir.Binary("*", gear, gear), rotor)
            if _computable(inertia):
                dof = replace(dof, inertia=inertia)
            else:
                message = "the inertia of the rotor at the joint is out of range"
                hint = f"gear^2 * rotor is zero, or from {SMALLEST:g} to {LARGEST:g} in SI units"
                self.sink.error(Code.BAD_NUMBER, message, item.span, hint)
        self.dofs[name] = dof

    def _value(self, part: s.DrivePart, kind: ir.DofKind) -> ir.Expr | None:
        """A number that is not negative, closed and in SI units."""
        rate = _COORDINATES[kind] / TIME
        due = {
            "gear": ONE / _COORDINATES[kind],
            "rotor": INERTIA,
            "viscous": EFFORT_DIMENSIONS[kind] / rate,
            "coulomb": EFFORT_DIMENSIONS[kind],
        }[part.kind]
        found = self.reader.scalar(part.value, due)
        if found is not None and constants.to_float(found) < 0:
            message = f"a negative `{part.kind}`"
            self.sink.error(Code.BAD_VALUE, message, part.value.span, "write zero or more")
            return None
        return found

    def torques(self, given: Sequence[ir.Torque]) -> tuple[ir.Torque, ...]:
        """The torques of the module with viscous friction subtracted, in the order of the dofs."""
        own = {torque.dof: torque for torque in given}
        for name, factor in self.viscous.items():
            before = own.get(name)
            drag = ir.Binary("*", factor, ir.RateOf(ir.THIS, name))
            driven = ir.EffortOf(ir.THIS, name) if before is None else before.value
            span = self.seen[name].span
            own[name] = ir.Torque(name, ir.Binary("-", driven, drag), span)
        return tuple(own[name] for name in self.dofs if name in own)


def _computable(inertia: ir.Expr) -> bool:
    """Whether floating point can hold an amount and its square, or the amount is zero."""
    try:
        size = constants.to_float(inertia)
    except (OverflowError, ValueError):
        return False
    return size == 0 or SMALLEST <= size <= LARGEST


def check_driven(module: ir.Module, items: Sequence[s.Dof], sink: Sink) -> None:
    """Report effort bounds of degrees of freedom that have no free input."""
    driven = {dof.name for dof in module.dofs} - {dof.name for dof in module.free_dofs}
    for item in items:
        name = item.name.text
        if item.effort is not None and name in driven:
            message = f"`{name}` has no free input `u` that an effort could bound"
            hint = f"bound the input that `torque({name})` reads"
            sink.error(Code.BAD_DYNAMICS, message, item.effort.span, hint)
