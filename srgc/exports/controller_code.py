"""Write the controller of a design as C99, as a Python module, and as NumPy arrays (npz).

All compute each input in the same order of operations: the planned input, less gain times deviation
for one measured quantity after another.  So the doubles of C and Python are bitwise equal.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from json import dumps

import numpy as np

from compiler.expressions.exact_numbers import decimal
from srgc.exports.exported_controller import ExportedController, described
from srgc.exports.exported_motion import Quantity
from srgc.exports.law_rounding import Precision
from srgc.exports.motion_formats import array_file
from srgc.exports.xml_lines import plain_line

# --- C99, one file --------------------------------------------------------------------------------


def c_text(
    controller: ExportedController,
    precision: Precision,
    notes: Sequence[str] = (),
    turns: int = 0,
) -> str:
    """The C file in a precision; ``notes`` are lines that follow its description.

    Winding coordinates may be given up to ``turns`` whole turns away.
    """
    return "\n".join(_c_lines(controller, precision, notes, turns)) + "\n"


def _c_lines(
    controller: ExportedController, precision: Precision, notes: Sequence[str], turns: int
) -> Iterator[str]:
    kind, name, closed = precision.name, controller.name, controller.gains is not None
    yield "/*"
    for line in (*described(controller, turns), *notes, "", *_c_use(controller, precision)):
        yield f" * {_c_comment(line)}".rstrip()
    yield " */"
    yield from C_CHECKS.splitlines()
    yield ""
    if controller.winding:
        yield f"#define HALF 0.5{precision.suffix}"
        yield f"#define WHOLE_TURN {WHOLE_TURN}{precision.suffix}"
        yield ""
    yield f"extern const int {name}_samples;"
    yield f"extern const {kind} {name}_period;"
    yield f"int {_signature(controller, precision)};"
    yield ""
    yield f"const int {name}_samples = {controller.samples};"
    yield f"const {kind} {name}_period = {_period(controller)}{precision.suffix};"
    yield ""
    yield from _c_table("planned", controller.planned, precision)
    if controller.reference is not None and controller.gains is not None:
        yield from _c_table("reference", controller.reference, precision)
        flat = [row for gain in controller.gains for row in gain]
        yield from _c_table("gains", flat, precision, len(controller.inputs))
    yield f"int {_signature(controller, precision)}"
    n, m = len(controller.measured), len(controller.inputs)
    body, again = C_CLOSED if closed else C_OPEN, _c_again(controller)
    unwound = _c_unwound(controller, precision, turns)
    extra = f"    {kind} turns;\n" if unwound else ""
    text = body.format(kind=kind, name=name, n=n, m=m, again=again, unwound=unwound, extra=extra)
    yield from text.splitlines()


def _signature(controller: ExportedController, precision: Precision) -> str:
    kind, n = precision.name, len(controller.measured)
    measured = f"measured[{n}]" if n else "*measured"
    inputs = f"inputs[{len(controller.inputs)}]"
    return f"{controller.name}_controller(int sample, const {kind} {measured}, {kind} {inputs})"


def _period(controller: ExportedController) -> str:
    text = decimal(float(controller.period))
    return text if "." in text else f"{text}.0"


def _c_use(controller: ExportedController, precision: Precision) -> Iterator[str]:
    yield "A program that uses it declares"
    yield f"    extern const int {controller.name}_samples;"
    yield f"    extern const {precision.name} {controller.name}_period;"
    yield f"    int {_signature(controller, precision)};"
    farther = ", or a position that is too many turns away," if controller.winding else ""
    yield f"The function returns 0. For a sample that there is none of{farther} it returns -1,"
    yield "and leaves the inputs as they are. It allocates nothing and calls nothing."
    yield ""
    yield "Compile with -ffp-contract=off: sums have a fixed order, and no operation may be fused"
    yield "with another, reordered or done in another precision."


def _c_comment(text: str) -> str:
    """A line that cannot end a C comment: without comment delimiters and trigraphs."""
    shown = plain_line(text).encode("ascii", "backslashreplace").decode()
    for pair in ("*/", "/*", "??"):
        while pair in shown:
            shown = shown.replace(pair, f"{pair[0]} {pair[1]}")
    return shown


def _c_again(controller: ExportedController) -> str:
    """Statements that map samples after the last one to those of the loop."""
    first, name = controller.loop, controller.name
    if first is None:
        return ""
    turned = f"{first} + (sample - {first}) % ({name}_samples - {first})"
    return f"    if (sample >= {name}_samples) {{\n        sample = {turned};\n    }}\n"


def _c_unwound(controller: ExportedController, precision: Precision, turns: int) -> str:
    """Statements that reduce the deviations of winding joints to within half a turn."""
    lines, suffix = list[str](), precision.suffix
    most, zero = f"{turns + 1}.0{suffix}", f"0.0{suffix}"
    for joint in controller.winding:
        off = f"off[{joint}]"
        lines += [
            f"    turns = {off} / WHOLE_TURN;",
            f"    if (!(turns < {most} && turns > -{most})) {{",
            "        return -1;",
            "    }",
            f"    turns = turns + (turns < {zero} ? -HALF : HALF);",
            f"    {off} = {off} - ({precision.name})(long)turns * WHOLE_TURN;",
        ]
    return "".join(f"{line}\n" for line in lines)


def _python_unwound(controller: ExportedController, turns: int) -> str:
    """The same statements in Python."""
    lines = list[str]()
    for joint in controller.winding:
        off = f"off[{joint}]"
        lines += [
            f"    turns = {off} / {WHOLE_TURN}",
            f"    if not -{turns + 1}.0 < turns < {turns + 1}.0:",
            f'        raise ValueError("measured[{joint}] is more than {turns} turns away")',
            "    turns = turns + (-0.5 if turns < 0.0 else 0.5)",
            f"    {off} = {off} - float(int(turns)) * {WHOLE_TURN}",
        ]
    return "".join(f"{line}\n" for line in lines)


def _python_again(controller: ExportedController) -> str:
    """The same statements in Python."""
    first = controller.loop
    if first is None:
        return ""
    turned = f"{first} + (sample - {first}) % (SAMPLES - {first})"
    return f"    if sample >= SAMPLES:\n        sample = {turned}\n"


WHOLE_TURN = "6.283185307179586"
"""In rad; it is read as the number nearest to 2 pi in either precision."""

C_CHECKS = """\
#include <float.h>

#if defined(__FAST_MATH__)
#error "compile without -ffast-math"
#endif
#if FLT_EVAL_METHOD != 0
#error "operations are done in another precision; on x86, use -msse2 -mfpmath=sse"
#endif
#if defined(__clang__) || !defined(__GNUC__)
#pragma STDC FP_CONTRACT OFF
#endif"""
"""GCC does not know the pragma, so it needs the command-line option."""

C_CLOSED = """\
{{
    {kind} off[{n}];
{extra}    int i, j;

{again}    if (sample < 0 || sample >= {name}_samples) {{
        return -1;
    }}
    for (j = 0; j < {n}; j++) {{
        off[j] = measured[j] - reference[sample][j];
    }}
{unwound}    for (i = 0; i < {m}; i++) {{
        {kind} input = planned[sample][i];

        for (j = 0; j < {n}; j++) {{
            input = input - gains[sample][i][j] * off[j];
        }}
        inputs[i] = input;
    }}
    return 0;
}}"""

C_OPEN = """\
{{
    int i;

    (void)measured;
{again}    if (sample < 0 || sample >= {name}_samples) {{
        return -1;
    }}
    for (i = 0; i < {m}; i++) {{
        inputs[i] = planned[sample][i];
    }}
    return 0;
}}"""


def _c_table(
    name: str, rows: Sequence[Sequence[str]], precision: Precision, group: int | None = None
) -> Iterator[str]:
    """A table of constants; its rows are in groups of ``group`` if given."""
    width, shape = len(rows[0]), f"[{len(rows)}]"
    if group is not None:
        shape = f"[{len(rows) // group}][{group}]"
    yield f"static const {precision.name} {name}{shape}[{width}] = {{"
    for number, row in enumerate(rows):
        text = "{" + ", ".join(f"{item}{precision.suffix}" for item in row) + "}"
        if group is not None:
            text = ("{" if number % group == 0 else " ") + text
            text += "}" if number % group == group - 1 else ""
        yield f"    {text},"
    yield "};"
    yield ""


# --- A Python module ------------------------------------------------------------------------------


def python_text(controller: ExportedController, notes: Sequence[str] = (), turns: int = 0) -> str:
    """The Python module, which imports nothing; for the arguments see :func:`c_text`."""
    return "\n".join(_python_lines(controller, notes, turns)) + "\n"


def _python_lines(
    controller: ExportedController, notes: Sequence[str], turns: int
) -> Iterator[str]:
    for line in (*described(controller, turns), *notes):
        yield f"# {plain_line(line)}".rstrip()
    yield ""
    yield f"SAMPLES = {controller.samples}"
    yield f"PERIOD = {_period(controller)}"
    yield from _names("MEASURED", controller.measured)
    yield from _names("INPUTS", controller.inputs)
    yield ""
    yield from _python_table("PLANNED", controller.planned)
    if controller.reference is None or controller.gains is None:
        yield from PYTHON_OPEN.replace("@again@", _python_again(controller)).splitlines()
        return
    yield from _python_table("REFERENCE", controller.reference)
    yield "GAINS = ("
    for gain in controller.gains:
        yield f"    ({' '.join(_tuple(row) + ',' for row in gain)}),"
    yield ")"
    text = PYTHON_CLOSED.replace("@again@", _python_again(controller))
    yield from text.replace("@unwound@", _python_unwound(controller, turns)).splitlines()


def _names(name: str, items: Sequence[Quantity]) -> Iterator[str]:
    yield f"{name} = ("
    yield from (f"    {dumps(f'{item.name} ({item.unit})')}," for item in items)
    yield ")"


def _tuple(row: Sequence[str]) -> str:
    return f"({', '.join(row)}{',' if len(row) == 1 else ''})"


def _python_table(name: str, rows: Sequence[Sequence[str]]) -> Iterator[str]:
    yield f"{name} = ("
    yield from (f"    {_tuple(row)}," for row in rows)
    yield ")"
    yield ""


PYTHON_CLOSED = '''

def controller(sample, measured):
    """The inputs to hold from a sample on, by what is measured at it: a list of floats."""
@again@    if not 0 <= sample < SAMPLES:
        raise IndexError(f"there is no sample {sample}")
    if len(measured) != len(MEASURED):
        raise ValueError(f"there are {len(MEASURED)} measured quantities, not {len(measured)}")
    off = [float(x) - planned for x, planned in zip(measured, REFERENCE[sample])]
@unwound@    inputs = []
    for value, gains in zip(PLANNED[sample], GAINS[sample]):
        for gain, each in zip(gains, off):
            value = value - gain * each
        inputs.append(value)
    return inputs'''

PYTHON_OPEN = '''
def controller(sample, measured=()):
    """The inputs to hold from a sample on: a list of floats. Nothing that is measured is read."""
@again@    if not 0 <= sample < SAMPLES:
        raise IndexError(f"there is no sample {sample}")
    return list(PLANNED[sample])'''


# --- NumPy arrays ---------------------------------------------------------------------------------


def controller_arrays(controller: ExportedController) -> bytes:
    """The npz file: ``planned`` (k, m), and for feedback ``reference``, ``gains``, ``rounding``."""
    numbers = {
        "period": np.array([float(controller.period)]),
        "planned": np.array(controller.planned, dtype=np.float64),
    }
    if controller.reference is not None and controller.gains is not None:
        numbers["reference"] = np.array(controller.reference, dtype=np.float64)
        numbers["gains"] = np.array(controller.gains, dtype=np.float64)
        claim = controller.design.claim.controller
        allowed = () if claim is None or claim.rounding is None else claim.rounding
        numbers["rounding"] = np.array([float(Fraction(text)) for text in allowed])
    texts = {
        "measured_names": [item.name for item in controller.measured],
        "measured_units": [item.unit for item in controller.measured],
        "input_names": [item.name for item in controller.inputs],
        "input_units": [item.unit for item in controller.inputs],
        "word": list(controller.design.claim.word),
        "spec_sha256": [controller.design.claim.spec_sha256],
    }
    return array_file(numbers, texts)
