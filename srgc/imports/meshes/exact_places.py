"""Exact vertices of a mesh: the rationals in its file, scaled and transformed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from srgc.imports.source_fault import SourceFault


Point: TypeAlias = tuple[Fraction, Fraction, Fraction]
Axis: TypeAlias = tuple[int, Fraction, Fraction]
"""A coordinate: the column in the file, a factor, and a shift that is added."""
SHORT, LONGEST = 15, 400
"""Decimals of this length are determined by their doubles; longer than the second is rejected."""
SMALLEST = -400
"""Decimals of at most this order of magnitude are read as 0."""
NEAR = 2.0**-50
"""A bound on the error of scaling and shifting in doubles, as a share of the terms."""
_ONE, _NONE = Fraction(1), Fraction(0)
_PLAIN: tuple[Axis, Axis, Axis] = ((0, _ONE, _NONE), (1, _ONE, _NONE), (2, _ONE, _NONE))


@dataclass(frozen=True, slots=True)
class ExactPlaces:
    """The vertices of a mesh as rationals.

    Attributes:
        read: (n, 3), the numbers of the file as doubles.
        binary: whether the doubles are exact; otherwise they stand for the shortest decimals that
            read back as them, which are those of a text with up to fifteen digits.
        longer: maps rows and columns to longer decimals that differ from these.
        axes: for each coordinate, the column it is read from and its transformation.
    """

    read: NDArray[np.float64]
    binary: bool = False
    longer: Mapping[tuple[int, int], Fraction] = field(default_factory=dict)
    axes: tuple[Axis, Axis, Axis] = _PLAIN

    def of(self, number: int) -> Point:
        """The vertex with this index."""
        x, y, z = (
            factor * self._read(number, column) + shift for column, factor, shift in self.axes
        )
        return x, y, z

    def _read(self, row: int, column: int) -> Fraction:
        value = float(self.read[row, column])
        if self.binary:
            return Fraction(value)
        found = self.longer.get((row, column))
        return rational(value) if found is None else found

    def vertices(self) -> NDArray[np.float64]:
        """The vertices (n, 3) as doubles; their coordinates are exact to within :meth:`slack`."""
        columns: list[NDArray[np.float64]] = []
        for column, factor, shift in self.axes:
            values = self.read[:, column]
            columns.append(values if factor == 1 else values * float(factor))
            if shift:
                columns[-1] = columns[-1] + float(shift)
        return np.column_stack(columns)

    def slack(self) -> float:
        """A bound on the error of a coordinate of :meth:`vertices`."""
        if self.binary and all(factor == 1 and not shift for _, factor, shift in self.axes):
            return 0.0
        most = np.abs(self.read).max(axis=0, initial=0.0)
        sizes = [abs(float(k)) * float(most[column]) + abs(float(s)) for column, k, s in self.axes]
        return NEAR * max(sizes) + 1e-300

    def part(self, numbers: NDArray[np.int64]) -> ExactPlaces:
        """The vertices with these indices (n,)."""
        if not self.longer:
            return replace(self, read=self.read[numbers])
        longer = {
            (row, column): self.longer[number, column]
            for row, number in enumerate(numbers.tolist())
            for column in range(3)
            if (number, column) in self.longer
        }
        return replace(self, read=self.read[numbers], longer=longer)

    def scaled(self, factors: Sequence[Fraction]) -> ExactPlaces:
        """The vertices with each coordinate multiplied by its factor."""
        x, y, z = (
            (column, factor * by, shift * by)
            for (column, factor, shift), by in zip(self.axes, factors, strict=True)
        )
        return replace(self, axes=(x, y, z))

    def placed(self, turn: NDArray[np.float64], shift: Sequence[Fraction]) -> ExactPlaces:
        """The vertices after a rotation by right angles and a translation.

        The rotation (3, 3) has entries -1, 0 and 1.
        """
        axes = list[Axis]()
        for row, by in zip(turn.tolist(), shift, strict=True):
            (place,) = (i for i, entry in enumerate(row) if entry)
            column, factor, before = self.axes[place]
            sign = int(row[place])
            axes.append((column, sign * factor, sign * before + by))
        x, y, z = axes
        return replace(self, axes=(x, y, z))


def rational(value: float) -> Fraction:
    """The shortest decimal that reads back as a finite double."""
    return Fraction(repr(float(value)))


def exact_decimal(word: str) -> Fraction:
    """The decimal in a text of at most :data:`LONGEST` characters that ``float`` accepts.

    Raises:
        ValueError: the text is longer.
    """
    if len(word) > LONGEST:
        raise ValueError(f"a number of more than {LONGEST} characters")
    number = Decimal(word)
    return Fraction(number) if number.adjusted() > SMALLEST else _NONE


def longer_decimals(
    rows: Iterable[Sequence[str]], read: NDArray[np.float64], fault: Callable[[str], SourceFault]
) -> dict[tuple[int, int], Fraction]:
    """Maps rows and columns to the decimals that differ from those of their doubles (n, m).

    Raises:
        SourceFault: a number is too long.
    """
    found = dict[tuple[int, int], Fraction]()
    for row, words in enumerate(rows):
        for column, word in enumerate(words):
            if len(word) <= SHORT:
                continue
            try:
                exact = exact_decimal(word)
            except ValueError as error:
                raise fault(str(error)) from None
            if exact != rational(read[row, column]):
                found[row, column] = exact
    return found
