"""What a rebuilding may change, and at which prices, parsed from options or arguments."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from math import isfinite
from numbers import Rational, Real
from typing import TypeAlias

from compiler.expressions.exact_numbers import exact_text
from grammar_lang import ir
from solvers.verifier.claims.mission_claim import PosedClaim
from srgc.faults import UsageFault, argument

Price: TypeAlias = int | float | Fraction | Decimal | str
"""A number of at least 0; texts as on the command line; a double counts as its shortest decimal."""

_TEXT = re.compile(r"[0-9]{1,12}(\.[0-9]{1,12}|/[1-9][0-9]{0,11})?")
_MOST, _FINEST = 10**12, 10**30
_LONGEST = 60
"""The most characters of a value that are shown."""


@dataclass(frozen=True, slots=True)
class Rebuilding:
    """The prices of changes, the parameters of kept modules that may change, and the cost limit."""

    prices: ir.Prices
    free: Sequence[tuple[str, str]]
    most: Fraction | None

    @property
    def posed(self) -> PosedClaim:
        """The rebuilding as a claim states it."""
        prices = self.prices
        add, remove, change = map(exact_text, (prices.add, prices.remove, prices.change))
        most = None if self.most is None else exact_text(self.most)
        return PosedClaim(add, remove, change, tuple(sorted(self.free)), most)

    def mission(self, task: ir.Task) -> ir.Mission:
        """The mission of one task, with these prices."""
        return ir.Mission(task.name, (task.name,), self.prices, frozenset(self.free), self.most)


def asked_rebuilding(
    program: ir.Program,
    *,
    add: Price,
    remove: Price,
    change: Price,
    free: Sequence[str],
    changes: Price | None,
) -> Rebuilding:
    """The rebuilding that the values of options or arguments describe.

    Args:
        program: the spec, whose modules ``free`` names.
        add: the price of adding a module.
        remove: the price of removing a module.
        change: the price of changing a free parameter.
        free: parameters that kept modules may change, such as ``L.length``.
        changes: the limit on the total cost of all changes; None for no limit.

    Raises:
        UsageFault: a price is invalid, there is no such parameter, or ``change`` has a price and no
            parameter is free.
    """
    prices = ir.Prices(_price("add", add), _price("remove", remove), _price("change", change))
    most = None if changes is None else _price("changes", changes)
    freed = tuple(_parameter(program, text) for text in free)
    if prices.change and not freed:
        change_, free_ = argument("change"), argument("free")
        raise UsageFault(
            change_, " is the price of what ", free_, " lets change: name that by ", free_
        )
    return Rebuilding(prices, freed, most)


def _price(option: str, value: Price) -> Fraction:
    """Parse a number of at least 0.

    Raises:
        UsageFault: it is not such a number.
    """
    known = _exact(value)
    if known is None:
        raise UsageFault(
            argument(option),
            f" takes a number of at least 0, such as 2, 0.5 or 1/3, not `{_shown(value)}`",
        )
    return known


def _exact(value: object) -> Fraction | None:
    """The rational that a value stands for; None if it is not a number, or not a plain one."""
    known = None
    if isinstance(value, bool):
        return None
    if isinstance(value, str):
        known = Fraction(value) if _TEXT.fullmatch(value) else None
    elif isinstance(value, Rational):
        known = Fraction(int(value.numerator), int(value.denominator))
    elif isinstance(value, Decimal) and value.is_finite():
        known = _decimal(value)
    elif isinstance(value, Real) and isfinite(value):
        known = _decimal(Decimal(repr(float(value))))
    plain = known is not None and 0 <= known < _MOST and known.denominator <= _FINEST
    return known if plain else None


def _decimal(value: Decimal) -> Fraction | None:
    """A decimal as a fraction; None if the fraction would be very long."""
    return Fraction(value) if value == 0 or -30 <= value.adjusted() < 12 else None


def _shown(value: object) -> str:
    try:
        text = str(value)
    except ValueError:  # it has more digits than Python converts
        text = "a number of many digits"
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


def _parameter(program: ir.Program, text: str) -> tuple[str, str]:
    """The module and the parameter of ``M.p``.

    Raises:
        UsageFault: there is no such module or parameter.
    """
    module, _, name = str(text).partition(".")
    option = argument("free")
    if module not in program.modules:
        raise UsageFault(option, f" {text}: there is no module `{module}`; write it as L.length")
    known = [parameter.name for parameter in program.modules[module].parameters]
    if name not in known:
        listed = ", ".join(f"`{module}.{each}`" for each in known) or "none"
        raise UsageFault(option, f" {text}: the parameters of `{module}` are {listed}")
    return module, name
