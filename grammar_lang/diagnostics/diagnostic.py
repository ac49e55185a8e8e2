"""Diagnostics and their codes; diagnostics are values that are collected during compilation."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import Enum

from grammar_lang.source import Span

# --- Every diagnostic code, in one place ----------------------------------------------------------
#
# Ranges: 01xx files and syntax, 02xx names, 03xx sorts, units and numbers, 04xx grammars, 05xx
# semantics, 06xx geometry, 07xx tasks, missions and their results, 08xx files of other tools.


class Code(Enum):
    """A stable code; its value never changes its meaning."""

    UNREADABLE_FILE = "SRG0101"
    NOT_UTF8 = "SRG0102"
    UNEXPECTED_CHARACTER = "SRG0103"
    SYNTAX = "SRG0104"
    EMPTY_FILE = "SRG0105"
    TOO_DEEP = "SRG0106"
    INCLUDE_CYCLE = "SRG0107"
    OUTSIDE_TREE = "SRG0108"
    UNREADABLE_REFERENCE = "SRG0109"
    TOO_LARGE = "SRG0110"
    NOT_SUPPORTED = "SRG0190"

    UNKNOWN_NAME = "SRG0201"
    DUPLICATE_NAME = "SRG0202"
    WRONG_KIND = "SRG0203"
    AMBIGUOUS_OCCURRENCE = "SRG0204"
    MISSING_START = "SRG0205"
    UNUSED_NAME = "SRG0206"

    UNIT_MISMATCH = "SRG0301"
    UNKNOWN_UNIT = "SRG0302"
    EMPTY_INTERVAL = "SRG0303"
    SORT_MISMATCH = "SRG0304"
    NOT_CONSTANT = "SRG0305"
    NOT_RATIONAL = "SRG0306"
    BAD_NUMBER = "SRG0307"
    ANGLE_ABOVE_TURN = "SRG0308"
    STRICT_INEQUALITY = "SRG0309"
    NOT_LINEAR = "SRG0310"
    IMPLAUSIBLE_VALUE = "SRG0311"

    UNPRODUCTIVE = "SRG0401"
    UNREACHABLE = "SRG0402"
    UNUSED_SYMBOL = "SRG0403"
    EMPTY_LANGUAGE = "SRG0404"
    CYCLIC_GRAMMAR = "SRG0405"
    NO_EFFECTOR = "SRG0406"
    AMBIGUOUS_GRAMMAR = "SRG0407"
    FINITE_LANGUAGE = "SRG0408"
    OPEN_OUTPUT = "SRG0409"
    ENDLESS_PORTS = "SRG0410"
    NO_INPUT = "SRG0411"
    OTHER_GRAMMAR = "SRG0412"

    UNDEFINED_ATTRIBUTE = "SRG0501"
    DOUBLE_ATTRIBUTE = "SRG0502"
    MISSING_BLOCK = "SRG0503"
    CIRCULAR_ATTRIBUTES = "SRG0504"
    BAD_DOF_USE = "SRG0505"
    BAD_EMISSION = "SRG0506"
    OUT_OF_PLANE = "SRG0507"
    DIFFERENT_ROBOTS = "SRG0508"
    BAD_DYNAMICS = "SRG0509"
    MISSING_FRAME = "SRG0510"
    NOT_MOUNTED = "SRG0511"
    LOOSE_FRAME = "SRG0512"

    EMPTY_POLYTOPE = "SRG0601"
    UNBOUNDED_POLYTOPE = "SRG0602"
    START_IN_OBSTACLE = "SRG0603"
    TARGET_IN_OBSTACLE = "SRG0604"
    REGION_OUTSIDE_BOUNDS = "SRG0605"
    REGION_PARTLY_OUTSIDE = "SRG0606"
    REGION_PARTLY_BLOCKED = "SRG0607"
    FLAT_POLYTOPE = "SRG0608"
    UNUSED_OBSTACLE = "SRG0609"
    OVERLAPPING_REGIONS = "SRG0610"
    MAP_PIECES = "SRG0611"
    FILLED_HOLLOWS = "SRG0612"

    MISSING_CLAUSE = "SRG0701"
    REPEATED_CLAUSE = "SRG0702"
    BAD_VALUE = "SRG0703"
    CONTRADICTORY_TASK = "SRG0704"
    VACUOUS_FORMULA = "SRG0705"
    TOO_FEW_MODULES = "SRG0706"
    START_OF_NO_ROBOT = "SRG0707"
    OPEN_LOOP_MEASUREMENT = "SRG0708"
    REST_WITHOUT_END = "SRG0709"
    LAST_WITHOUT_END = "SRG0710"
    START_OUTSIDE_LOOP = "SRG0711"
    MIXED_OWNERS = "SRG0715"
    WIDE_RADIUS = "SRG0716"
    UNDRIVEN_JOINT = "SRG0717"
    EXEMPT_BODIES = "SRG0718"
    SOLID_WITHOUT_SHAPE = "SRG0719"
    NO_OBJECTIVE = "SRG0720"
    NO_AMOUNT = "SRG0721"
    AMOUNT_OF_ZERO = "SRG0722"
    NEGATIVE_AMOUNT = "SRG0723"
    ENDLESS_OBJECTIVE = "SRG0724"
    BAD_WITHIN = "SRG0725"
    FIXED_TIME = "SRG0726"
    TIME_WITHOUT_END = "SRG0727"
    REPEATED_TASK = "SRG0730"
    OTHER_ROBOTS = "SRG0731"
    OTHER_EFFORTS = "SRG0732"
    EMPTY_MISSION = "SRG0733"
    CONTRADICTORY_MISSION = "SRG0734"
    NO_ROBOT = "SRG0735"

    FOREIGN_FILE = "SRG0801"
    FOREIGN_PATH = "SRG0802"
    FOREIGN_CONTENT = "SRG0803"
    FOREIGN_LEFT_OUT = "SRG0804"


# --- Diagnostics are values: collected while compiling, rendered elsewhere ------------------------


class Severity(Enum):
    """An error stops the compilation; a warning does not, and a note points out no fault."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """A diagnostic: a one-line message, its place, and a hint on what to do about it."""

    code: Code
    severity: Severity
    message: str
    span: Span
    hint: str | None = None
    notes: tuple[tuple[Span, str], ...] = ()


@dataclass(slots=True)
class Sink:
    """Collects the diagnostics of all passes.

    ``comparisons`` is how many more names may be compared to find hints: without a limit, a file
    full of unknown names would keep the search busy for minutes.
    """

    found: list[Diagnostic] = field(default_factory=list[Diagnostic])
    comparisons: int = 50_000

    def error(
        self,
        code: Code,
        message: str,
        span: Span,
        hint: str | None = None,
        notes: Iterable[tuple[Span, str]] = (),
    ) -> None:
        """Record an error."""
        self.found.append(Diagnostic(code, Severity.ERROR, message, span, hint, tuple(notes)))

    def warning(
        self,
        code: Code,
        message: str,
        span: Span,
        hint: str | None = None,
        notes: Iterable[tuple[Span, str]] = (),
    ) -> None:
        """Record a warning."""
        self.found.append(Diagnostic(code, Severity.WARNING, message, span, hint, tuple(notes)))

    def note(
        self,
        code: Code,
        message: str,
        span: Span,
        hint: str | None = None,
        notes: Iterable[tuple[Span, str]] = (),
    ) -> None:
        """Record something worth knowing that is not a fault."""
        self.found.append(Diagnostic(code, Severity.NOTE, message, span, hint, tuple(notes)))

    @property
    def has_errors(self) -> bool:
        """Whether at least one error was recorded."""
        return any(d.severity is Severity.ERROR for d in self.found)

    def sorted(self) -> tuple[Diagnostic, ...]:
        """All diagnostics in the order of their positions."""
        return tuple(sorted(self.found, key=lambda d: (d.span.file, d.span, d.code.value)))
