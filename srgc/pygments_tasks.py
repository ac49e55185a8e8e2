"""The states of the Pygments lexer in tasks, missions and formulas."""

from __future__ import annotations

from types import MappingProxyType

from pygments.lexer import default, include
from pygments.token import Keyword, Name, Number, Operator, Punctuation

from srgc.pygments_patterns import END, GAP, NAME, NUMBER, word_of

TASK_STATES = MappingProxyType({
    # --- tasks --------------------------------------------------------------------------
    "task": [
        include("block"),
        (word_of("robot", "workspace"), Keyword, "reference"),
        (word_of("start"), Keyword, "start"),
        (word_of("reach"), Keyword, ("placement", "reference")),
        (word_of("avoid"), Keyword, ("avoided", "avoided region")),
        (word_of("bounds"), Keyword, "subject"),
        (word_of("effort"), Keyword, ("norm", "bound")),
        (word_of("horizon"), Keyword, ("steps", "operand", "at most")),
        (word_of("carry"), Keyword, ("placement", "carried", "operand")),
        (word_of("slack", "gravity", "payload"), Keyword, ("placement", "operand")),
        (word_of("modules"), Keyword, "bound"),
        (word_of("minimize"), Keyword, "objective"),
        (word_of("from"), Keyword, ("word", "reference")),
        (word_of("satisfy"), Keyword, "formula"),
        (word_of("robust"), Keyword, "robust"),
        (word_of("control", "repeat"), Keyword, "control"),
        include("stray"),
    ],
    "carried": [include("gap"), (word_of("from", "to"), Keyword, "reference"), default("#pop")],
    "start": [
        include("gap"),
        (word_of("in"), Keyword, ("#pop", "placement", "reference")),
        (word_of("at"), Keyword, ("#pop", "operand")),
        default("#pop"),
    ],
    "placement": [
        include("gap"),
        (word_of("by", "at", "rest", "held", "aligned", "x", "y", "z"), Keyword),
        (word_of("effector", "for", "oriented", "to", "within"), Keyword, "operand"),
        ("-", Operator),
        (word_of("rates"), Keyword, "bound"),
        default("#pop"),
    ],
    "avoided region": [
        include("gap"),
        (rf"self(?={GAP}with{END})", Name.Builtin.Pseudo, "#pop"),
        (NAME, Name, "#pop"),
        default("#pop"),
    ],
    "avoided": [
        include("gap"),
        (",", Punctuation, "reference"),
        (word_of("with"), Keyword, ("#pop", "subject")),
        default("#pop"),
    ],
    "subject": [
        include("gap"),
        (word_of("with", "effector", "body"), Keyword),
        (word_of("margin"), Keyword, "operand"),
        (word_of("except"), Keyword, ("#pop", "names")),
        (",", Punctuation),
        default("#pop"),
    ],
    "names": [include("gap"), (NAME, Name), (",", Punctuation), default("#pop")],
    "norm": [include("gap"), (word_of("norm"), Keyword, "operand"), default("#pop")],
    "at most": [include("gap"), (word_of("at", "most"), Keyword), default("#pop")],
    "steps": [
        include("gap"),
        (word_of("steps"), Keyword),
        (word_of("of"), Keyword, "operand"),
        default("#pop"),
    ],
    "word": [
        include("gap"),
        include("string"),
        (word_of("fixed"), Keyword, ("#pop", "fixed")),
        (NAME, Name),
        default("#pop"),
    ],
    "fixed": [
        include("gap"),
        (NAME, Name),
        (r"\.", Operator, "member"),
        ("=", Operator, "operand"),
        (",", Punctuation),
        default("#pop"),
    ],
    "robust": [
        include("gap"),
        (word_of("start", "measure"), Keyword, ("#pop", "quantities")),
        (word_of("effort", "mass", "payload"), Keyword, ("#pop", "percent", "operand")),
        default("#pop"),
    ],
    "quantities": [
        include("gap"),
        (NUMBER, Number, "unit"),
        (r"\(", Punctuation, ("unit", "arguments", "operand")),
        (",", Punctuation),
        default("#pop"),
    ],
    "percent": [
        include("gap"),
        ("%", Keyword.Type),
        (word_of("of"), Keyword, ("#pop", "part")),
        default("#pop"),
    ],
    "part": [include("gap"), (word_of("bound"), Keyword, "#pop"), default(("#pop", "reference"))],
    "objective": [
        include("gap"),
        (
            word_of("modules", "mass", "time", "energy", "effort", "sum", "changes"),
            Name.Builtin,
            ("#pop", "within", "summed"),
        ),
        (NAME, Name, ("#pop", "within", "summed")),
        default("#pop"),
    ],
    "summed": [
        include("gap"),
        (r"\(", Punctuation, ("#pop", "close", "reference")),
        default("#pop"),
    ],
    "within": [
        include("gap"),
        (word_of("within"), Keyword, "operand"),
        ("%", Keyword.Type),
        (word_of("then"), Keyword, ("#pop", "objective")),
        default("#pop"),
    ],
    "control": [include("gap"), (word_of("open", "loop", "feedback"), Keyword), default("#pop")],
    # --- missions -----------------------------------------------------------------------
    "mission": [
        include("block"),
        (word_of("tasks"), Keyword, "names"),
        (word_of("one"), Keyword, "one robot"),
        (word_of("reconfigure"), Keyword, "prices"),
        (word_of("free"), Keyword, "fixed"),
        (word_of("changes"), Keyword, "bound"),
        (word_of("minimize"), Keyword, "objective"),
        include("stray"),
    ],
    "one robot": [include("gap"), (word_of("robot"), Keyword, "#pop"), default("#pop")],
    "prices": [
        include("gap"),
        (word_of("add", "remove", "change"), Keyword, "operand"),
        (",", Punctuation),
        default("#pop"),
    ],
    # --- formulas -----------------------------------------------------------------------
    "formula": [
        include("gap"),
        (word_of("not", "always", "eventually", "next", "last"), Operator.Word),
        (r"\[", Punctuation, ("interval", "operand")),
        (r"\(", Punctuation, ("#pop", "connective", "close", "formula")),
        (NAME, Name, ("#pop", "connective")),
        default("#pop"),
    ],
    "connective": [
        include("gap"),
        (word_of("and", "or", "until", "implies"), Operator.Word, ("#pop", "formula")),
        include("placement"),
    ],
})  # fmt: skip
