"""The equations of motion of a robot as a document for a roboticist."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from compiler.descriptions.document import Equation, Item, Remark, Section
from compiler.descriptions.expression_printer import ExpressionPrinter
from compiler.descriptions.latex_notation import LatexNotation
from compiler.descriptions.model_formulas import Formulas, ModelFormulas
from compiler.descriptions.model_symbols import ModelSymbols, model_symbols
from compiler.descriptions.text_notation import TextNotation
from compiler.expressions.trigonometric_polynomial import TrigonometricPolynomial
from grammar_lang.ir.expression_text import number_text

AXES = ("x", "y", "z")


@dataclass(slots=True)
class _Writer:
    """Writes formulas; intermediate results are numbered through all of them."""

    symbols: ModelSymbols
    shown: int = 0
    results: list[Item] = field(default_factory=list[Item])

    def equations(self, formulas: Formulas, lefts: Sequence[tuple[str, str]]) -> Iterator[Equation]:
        """One equation per output; the intermediate results they need are noted."""
        numbers = {item.number: self.shown + i + 1 for i, item in enumerate(formulas.named)}
        self.shown += len(numbers)
        text = ExpressionPrinter(formulas.ring, TextNotation(), self.symbols.text, numbers)
        latex = ExpressionPrinter(formulas.ring, LatexNotation(), self.symbols.latex, numbers)

        def equation(left: tuple[str, str], right: TrigonometricPolynomial) -> Equation:
            return Equation(left, (text.pieces(right), latex.pieces(right)))

        for item in formulas.named:
            number = numbers[item.number]
            named = text.notation.named(number), latex.notation.named(number)
            self.results.append(equation(named, item.value))
        for left, output in zip(lefts, formulas.outputs, strict=True):
            yield equation(left, output)


def motion_sections(reading: ModelFormulas) -> list[Section]:
    """M, c, g and the effectors' positions, then the intermediate results they are made of."""
    model, writer = reading.model, _Writer(model_symbols(reading.model))
    n = len(model.dofs)
    sections: list[Section] = []
    if n:
        mass = writer.equations(reading.mass, _mass_names(n))
        bias = writer.equations(reading.centrifugal, _vector_names("c", n))
        remark = Remark("symmetric: the entries on and above the diagonal")
        sections += [
            Section("Mass matrix M", (remark, *mass)),
            Section("Centrifugal and Coriolis forces c", tuple(bias)),
            Section("Gravitational forces g", tuple(_gravitational(reading, writer))),
        ]
    tips = writer.equations(reading.effectors, _tip_names(model.dimension, len(model.effectors)))
    positions = tuple(tips) or (Remark("none"),)
    sections.append(Section("Positions of the effectors, in m", positions))
    if writer.results:
        sections.append(Section("Intermediate results", tuple(writer.results)))
    return sections


def _gravitational(reading: ModelFormulas, writer: _Writer) -> Iterator[Item]:
    if not any(reading.gravity):
        yield Remark("none: g = 0")
        return
    pull = ", ".join(number_text(value) for value in reading.gravity)
    yield Remark(f"for gravity ({pull}) m/s^2")
    names = _vector_names("g", len(reading.model.dofs))
    yield from writer.equations(reading.gravitational, names)


def _mass_names(n: int) -> list[tuple[str, str]]:
    """The entries of M on and above the diagonal, row by row."""
    text, latex = ("M{}{}", "M_{{{}{}}}") if n < 10 else ("M{}_{}", "M_{{{},{}}}")
    places = [(i, j) for i in range(1, n + 1) for j in range(i, n + 1)]
    return [(text.format(*place), latex.format(*place)) for place in places]


def _vector_names(name: str, n: int) -> list[tuple[str, str]]:
    return [(f"{name}{i}", f"{name}_{{{i}}}") for i in range(1, n + 1)]


def _tip_names(dimension: int, effectors: int) -> list[tuple[str, str]]:
    return [
        (f"e{number}_{axis}", f"e_{{{number},{axis}}}")
        for number in range(1, effectors + 1)
        for axis in AXES[:dimension]
    ]
