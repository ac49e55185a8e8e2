"""Formulas about samples that are sufficient for formulas in continuous time.

Compare Fainekos & Pappas, *Robustness of temporal logic specifications for continuous-time signals*
(2009), Section 4: a formula is strengthened because of what may happen between samples. Here,
between two samples, a motion is in the cell of the first and then in that of the second, and at the
instant of change in both (cells are closed; every effector changes at an instant of its own), with
the orientations that literals state. If a cell trace satisfies ``sampled(F)`` at sample 0, these
motions satisfy F at time 0. The converse is false: this is for the search, never for a refutation.

Every subformula has two translations, of which the second is used below operators that require all
instants of an interval:

* its *point* form at sample i is sufficient for the subformula at the instant of sample i;
* its *dense* form at sample i is sufficient for it on the closed interval from sample i to i + 1,
  and at the last sample for that instant.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil, floor
from typing import TypeAlias

from compiler.tasks.word_formula import (
    ONE_LATER,
    TRUE,
    Eventually,
    Every,
    Literal,
    SampledFormula,
    Some,
    SomewhereFrom,
    Throughout,
    ThroughoutFrom,
    Until,
    Word,
    both_cells,
    dense_state,
    eventually,
    every,
    holds,
    is_monotone,
    next_sample,
    nodes,
    parts_of,
    some,
    throughout,
    truth,
)
from grammar_lang import ir

__all__ = [
    "Eventually",
    "Every",
    "Literal",
    "SampledFormula",
    "Some",
    "SomewhereFrom",
    "Throughout",
    "ThroughoutFrom",
    "Until",
    "Word",
    "holds",
    "is_timed",
    "nodes",
    "parts_of",
    "sampled",
    "truth",
]

Signed: TypeAlias = tuple[ir.Formula, bool]
"""A formula (True), or its negation (False)."""


def is_timed(formula: ir.Formula) -> bool:
    """Whether it matters when things happen, and not only in which order."""
    match formula:
        case ir.Atom():
            return False
        case ir.Next():
            return True
        case ir.Always(operand=part, window=window) | ir.Eventually(operand=part, window=window):
            return window != ir.Window(Fraction(0), None) or is_timed(part)
        case ir.Last(duration=duration, operand=part):
            return duration > 0 or is_timed(part)
        case ir.Not(operand=part):
            return is_timed(part)
        case ir.And(operands=parts) | ir.Or(operands=parts):
            return any(map(is_timed, parts))
        case ir.Implies(left=left, right=right) | ir.Until(left=left, right=right):
            return is_timed(left) or is_timed(right)


def sampled(formula: ir.Formula, step: Fraction, steps: int) -> SampledFormula:
    """The formula on samples 0 .. ``steps``, which are ``step`` seconds apart.

    If an untimed formula is translated, with ``sample == steps`` read as the last position, the
    result is sufficient on words of positions too, whenever the cells of the positions are entered.
    """
    return _Translation(step, steps).point((formula, True))


class _Translation:
    """Point and dense forms; each formula is translated once per form and sign."""

    def __init__(self, step: Fraction, steps: int) -> None:
        self._step = step
        self._steps = steps
        self._points: dict[tuple[int, bool], SampledFormula] = {}
        self._denses: dict[tuple[int, bool], SampledFormula] = {}

    def point(self, signed: Signed) -> SampledFormula:
        key = id(signed[0]), signed[1]
        if key not in self._points:
            self._points[key] = self._point(signed)
        return self._points[key]

    def dense(self, signed: Signed) -> SampledFormula:
        key = id(signed[0]), signed[1]
        if key not in self._denses:
            self._denses[key] = self._dense(signed)
        return self._denses[key]

    def _point(self, signed: Signed) -> SampledFormula:
        formula, positive = signed
        match formula:
            case ir.Atom(region=region, effector=effector, poses=poses):
                if positive or not poses:
                    return Literal(region, effector, positive, poses)
                turned = (
                    Literal(region, effector, positive=True, poses=(pose,), away=True)
                    for pose in poses
                )
                return some((Literal(region, effector, positive), *turned))
            case ir.Not(operand=part):
                return self.point((part, not positive))
            case ir.And() | ir.Or() | ir.Implies():
                conjunction, parts = _boolean(formula, signed)
                forms = map(self.point, parts)
                return every(forms) if conjunction else some(forms)
            case _:
                return self._point_in_time(formula, signed)

    def _point_in_time(
        self, formula: ir.Always | ir.Eventually | ir.Next | ir.Last | ir.Until, signed: Signed
    ) -> SampledFormula:
        positive = signed[1]
        match formula:
            case ir.Always(operand=part, window=w) | ir.Eventually(operand=part, window=w):
                if isinstance(formula, ir.Always) is positive:
                    return self._always((part, positive), w, further=0)
                return self._eventually((part, positive), w)
            case ir.Next(operand=part):
                at = self.point((part, positive))
                return next_sample(at) if positive else throughout(at, 1, 1)
            case ir.Last(duration=duration, operand=part):
                return self._last(duration, (part, positive))
            case ir.Until(left=left, right=right):
                return self._until(left, right) if positive else self._release(left, right)

    def _dense(self, signed: Signed) -> SampledFormula:
        formula, positive = signed
        match formula:
            case ir.Atom():
                return throughout(self.point(signed), 0, 1)
            case ir.Not(operand=part):
                return self.dense((part, not positive))
            case ir.And() | ir.Or() | ir.Implies():
                conjunction, parts = _boolean(formula, signed)
                return every(map(self.dense, parts)) if conjunction else self._any(parts)
            case _:
                return self._dense_in_time(formula, signed)

    def _dense_in_time(
        self, formula: ir.Always | ir.Eventually | ir.Next | ir.Last | ir.Until, signed: Signed
    ) -> SampledFormula:
        positive = signed[1]
        match formula:
            case ir.Always(operand=part, window=w) | ir.Eventually(operand=part, window=w):
                if isinstance(formula, ir.Always) is positive:
                    return self._always((part, positive), w, further=1)
                return self._dense_eventually((part, positive), w)
            case ir.Next(operand=part):
                form = self.dense((part, positive))
                if not positive:
                    return throughout(form, 1, 1)
                return next_sample(every((form, ONE_LATER)))
            case ir.Last(duration=duration, operand=part):
                return self._last(duration, (part, positive))
            case ir.Until():
                return self._dense_until(formula) if positive else self._dense_release(formula)

    # --- windows ---------------------------------------------------------------------------------

    def _bounds(self, window: ir.Window) -> tuple[Fraction, Fraction | None]:
        """A window in samples; None if it extends to the end from anywhere."""
        upper = None if window.upper is None else window.upper / self._step
        if upper is not None and upper >= self._steps:
            upper = None
        return window.lower / self._step, upper

    def _always(self, part: Signed, window: ir.Window, *, further: int) -> SampledFormula:
        """From the lower end seen from a sample to the upper one seen ``further`` samples later."""
        lower, upper = self._bounds(window)
        if upper is None:
            return throughout(self.dense(part), floor(lower), None)
        first, last = floor(lower), ceil(upper) + further
        if first == last:
            return throughout(self.point(part), first, last)
        return throughout(self.dense(part), first, last - 1)

    def _eventually(self, part: Signed, window: ir.Window) -> SampledFormula:
        """At a sample of the window; if it has none, all along between two samples."""
        lower, upper = self._bounds(window)
        if upper is not None and ceil(lower) > floor(upper):
            return eventually(every((self.dense(part), ONE_LATER)), floor(lower), floor(lower))
        return eventually(self.point(part), ceil(lower), None if upper is None else floor(upper))

    def _dense_eventually(self, part: Signed, window: ir.Window) -> SampledFormula:
        """At a sample in the windows of all instants, or at the lower ends of all windows."""
        lower, upper = self._bounds(window)
        first, last = ceil(lower) + 1, None if upper is None else floor(upper)
        dense = self.dense(part)
        forms: list[SampledFormula] = []
        if last is None or first <= last:
            forms.append(eventually(self.point(part), first, last))
        if lower == 0:
            forms.append(dense)
        else:
            exists = eventually(TRUE, first, first)
            forms.append(every((throughout(dense, floor(lower), ceil(lower)), exists)))
        return some(forms)

    def _last(self, duration: Fraction, part: Signed) -> SampledFormula:
        since = max(Fraction(0), self._steps - duration / self._step)
        if not part[1]:
            return SomewhereFrom(self.point(part), ceil(since))
        if since == self._steps:
            return ThroughoutFrom(self.point(part), self._steps)
        return ThroughoutFrom(self.dense(part), floor(since))

    # --- until -----------------------------------------------------------------------------------

    def _until(self, left: ir.Formula, right: ir.Formula) -> SampledFormula:
        """An until whose ``right`` may begin to hold when its effector changes cells."""
        before, then = self.dense((left, True)), self.point((right, True))
        effector = _only_effector(right)
        if effector is None:
            return Until(before, then)
        changing = every((self._before_change((left, True), effector), both_cells(then)))
        return some((then, Until(before, changing)))

    def _dense_until(self, formula: ir.Until) -> SampledFormula:
        left, right = (formula.left, True), (formula.right, True)
        now, later = self.dense(right), next_sample(self.point((formula, True)))
        if _only_effector(formula.right) is None or not is_monotone(self.point(right)):
            return some((now, every((self.dense(left), later))))
        # If ``right`` is a closed set, there is a first instant at which it holds.
        return some((now, every((self._any([left, right]), later))))

    def _release(self, left: ir.Formula, right: ir.Formula) -> SampledFormula:
        """``right`` is false throughout, or until ``left`` is false as well."""
        failing = self.dense((right, False))
        freed = every((self.point((left, False)), self.point((right, False))))
        return some((Until(failing, freed), throughout(failing, 0, None)))

    def _dense_release(self, formula: ir.Until) -> SampledFormula:
        later = throughout(self.point((formula, False)), 1, 1)
        freed = some((self.dense((formula.left, False)), later))
        return every((self.dense((formula.right, False)), freed))

    def _before_change(self, signed: Signed, effector: int) -> SampledFormula:
        """A form that is sufficient from a sample until just before that effector changes cells."""
        formula, positive = signed
        match formula:
            case ir.Atom(effector=number) if number == effector:
                return self.point(signed)
            case ir.Not(operand=part):
                return self._before_change((part, not positive), effector)
            case ir.And() | ir.Or() | ir.Implies():
                conjunction, parts = _boolean(formula, signed)
                forms = [self._before_change(part, effector) for part in parts]
                return every(forms) if conjunction else some(forms)
            case _:
                return self.dense(signed)

    def _any(self, parts: Sequence[Signed]) -> SampledFormula:
        """One part throughout; for parts about one effector's cell any part at each instant."""
        forms: list[SampledFormula] = []
        of_one: dict[int, list[SampledFormula]] = {}
        for part in parts:
            effector = _only_effector(part[0])
            if effector is None:
                forms.append(self.dense(part))
            else:
                of_one.setdefault(effector, []).append(self.point(part))
        return some([*forms, *(dense_state(some(states)) for states in of_one.values())])


def _boolean(
    formula: ir.And | ir.Or | ir.Implies, signed: Signed
) -> tuple[bool, tuple[Signed, ...]]:
    """Whether it is a conjunction once the sign is pushed inwards, and its signed parts."""
    positive = signed[1]
    match formula:
        case ir.And(operands=parts):
            return positive, tuple((part, positive) for part in parts)
        case ir.Or(operands=parts):
            return not positive, tuple((part, positive) for part in parts)
        case ir.Implies(left=left, right=right):
            return not positive, ((left, not positive), (right, positive))


def _only_effector(formula: ir.Formula) -> int | None:
    """The effector whose cell alone the formula concerns; None if temporal, or for several."""
    found: set[int] = set()
    stack = [formula]
    while stack:
        match stack.pop():
            case ir.Atom(effector=effector):
                found.add(effector)
            case ir.Not(operand=part):
                stack.append(part)
            case ir.And(operands=parts) | ir.Or(operands=parts):
                stack.extend(parts)
            case ir.Implies(left=left, right=right):
                stack += [left, right]
            case _:
                return None
    return found.pop() if len(found) == 1 else None
