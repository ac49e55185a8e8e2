"""Syntax highlighting of ``.srg`` for Pygments: Sphinx, ``pygmentize``, rich.

Keywords are contextual, so the lexer follows the grammar (``srg.lark``): a statement is a chain of
states, each names the few words that mean something there, and what it does not know ends it.

Source: G. Brandl et al., Pygments, *Write your own lexer*, https://pygments.org/docs/lexerdevelopment/.
"""

from __future__ import annotations

import re
from typing import ClassVar

from pygments.lexer import RegexLexer, bygroups, default, include, words
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, String, Text

from grammar_lang.units import UNIT_NAMES

FUNCTIONS = ("rot", "move", "sin", "cos", "tan", "sqrt", "abs", "rate")
EMISSIONS = ("rod", "point", "solid", "effector", "sphere", "capsule", "cylinder", "box", "hull")
ROLES = ("base", "joint", "link", "effector")
_ITEMS = "module|grammar|semantics|workspace|task"
_END = r"(?![A-Za-z0-9_])"
_NAME = rf"(?!(?:and|or|not|empty|this|world|start|accept|x|y|z){_END})[A-Za-z_][A-Za-z0-9_]*"
_GAP = r"(?:[ \t\r\n\f\v]++|//[^\n]*+|/\*(?:[^*]++|\*(?!/))*+\*/)*+"
_NUMBER = r"[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?"
_ONE_UNIT = rf"(?:{'|'.join(sorted(UNIT_NAMES, key=len, reverse=True))})(?:\^-?[0-9]+)?"
_UNIT = rf"{_ONE_UNIT}(?:[*/]{_ONE_UNIT})*(?![A-Za-z0-9_.(])"
_COMPARISON = "<=|>=|==|<|>"


def _word(*choices: str) -> words:
    return words(choices, suffix=_END)


def _separated(state: str, closing: str) -> list[object]:
    """What follows the first of several things, each read in ``state``, up to a bracket."""
    return [
        include("gap"),
        (",", Punctuation, state),
        (closing, Punctuation, "#pop"),
        default("#pop"),
    ]


def _heading(kind: object) -> list[object]:
    """The name of an item."""
    return [include("gap"), include("next item"), (_NAME, kind, "#pop"), default("#pop")]


class SrgLexer(RegexLexer):  # type: ignore[misc]  # Pygments has no types
    """The lexer; loses no character and stops at none, whatever the text."""

    name = "SRG"
    aliases: ClassVar = ["srg"]
    filenames: ClassVar = ["*.srg"]
    mimetypes: ClassVar = ["text/x-srg"]

    @staticmethod
    def analyse_text(text: str) -> float:
        """How likely a text is ``.srg``: it is if ``module NAME { role`` stands in it."""
        return 0.9 if re.search(r"\bmodule\s+\w+\s*\{\s*role\b", text) else 0.0

    tokens: ClassVar = {
        "root": [
            include("gap"),
            (_word("include"), Keyword.Namespace, "path"),
            (_word("edge"), Keyword.Declaration, "edges"),
            include("item"),
            include("stray"),
        ],
        # --- what stands anywhere -----------------------------------------------------------
        "gap": [
            (r"[ \t\r\n\f\v]+", Text.Whitespace),
            (r"//[^\n]*", Comment.Single),
            (r"/\*", Comment.Multiline, "comment"),
        ],
        "comment": [
            (r"[^*]+", Comment.Multiline),
            (r"\*/", Comment.Multiline, "#pop"),
            (r"\*", Comment.Multiline),
        ],
        "string": [(r"'[^'\n]*'", String.Single), (r'"[^"\n]*"', String.Double)],
        # Where no statement is known: between statements, and what an error leaves over.
        "stray": [
            include("string"),
            (_NUMBER, Number),
            (_NAME, Name),
            (_word("and", "or", "not"), Operator.Word),
            (_word("empty", "world", "x", "y", "z"), Keyword.Constant),
            (_word("this"), Name.Builtin.Pseudo),
            (_word("start", "accept"), Keyword),
            (rf"->|{_COMPARISON}|[-+*/^=|?%.]", Operator),
            (r"[][(){},;:]", Punctuation),
        ],
        # --- items --------------------------------------------------------------------------
        "item": [
            (_word("module"), Keyword.Declaration, ("module", "heading", "class")),
            (_word("grammar"), Keyword.Declaration, ("grammar", "heading", "namespace")),
            (_word("semantics"), Keyword.Declaration, ("semantics", "heading", "namespace")),
            (_word("workspace"), Keyword.Declaration, ("workspace", "heading", "namespace")),
            (_word("task"), Keyword.Declaration, ("task", "heading", "namespace")),
        ],
        "heading": [include("gap"), (r"\{", Punctuation, "#pop"), default("#pop")],
        "class": _heading(Name.Class),
        "namespace": _heading(Name.Namespace),
        "path": [include("gap"), include("string"), default("#pop")],
        "edges": [
            include("gap"),
            include("string"),
            (_NAME, Name.Class),
            (",", Punctuation),
            default("#pop"),
        ],
        # A brace may be missing: no statement of the language looks like the head of an item.
        "next item": [(rf"(?=(?:{_ITEMS}){_END}{_GAP}{_NAME}{_GAP}\{{)", bygroups(), "#pop")],
        "block": [include("gap"), include("next item"), (r"\}", Punctuation, "#pop")],
        # --- modules ------------------------------------------------------------------------
        "module": [
            include("block"),
            (_word("role"), Keyword, "role"),
            (_word("param", "input"), Keyword.Declaration, ("domain", "declared")),
            (_word("const"), Keyword.Declaration, ("definition", "declared")),
            (_word("state"), Keyword.Declaration, ("definition", "unit", "declared")),
            (_word("dof", "drive"), Keyword.Declaration, ("dof", "declared")),
            (_word("der", "torque"), Keyword, ("definition", "in parentheses")),
            include("stray"),
        ],
        "role": [
            include("gap"),
            (_word(*ROLES), Name.Constant, "#pop"),
            (_NAME, Name, "#pop"),
            default("#pop"),
        ],
        "declared": [include("gap"), (_NAME, Name.Variable, "#pop"), default("#pop")],
        "definition": [include("gap"), ("=", Operator, ("#pop", "operand")), default("#pop")],
        "in parentheses": [
            include("gap"),
            include("string"),
            (r"\(", Punctuation),
            (_NAME, Name),
            (r"\)", Punctuation, "#pop"),
            default("#pop"),
        ],
        "domain": [
            include("gap"),
            (_word("in"), Keyword),
            (r"\[", Punctuation, ("unit", "interval", "operand")),
            (r"\{", Punctuation, ("unit", "choices", "operand")),
            default("#pop"),
        ],
        "choices": _separated("operand", r"\}"),
        "dof": [
            include("gap"),
            (_word("revolute", "prismatic"), Keyword),
            (_word("in", "rate", "accel", "effort"), Keyword),
            (_word("gear", "rotor", "viscous", "coulomb"), Keyword, "operand"),
            (_word("x", "y", "z"), Keyword.Constant),
            (rf"-|{_COMPARISON}", Operator, "operand"),
            (":", Punctuation),
            (r"\[", Punctuation, ("unit", "interval", "operand")),
            default("#pop"),
        ],
        # --- grammars -----------------------------------------------------------------------
        "grammar": [
            include("block"),
            (_word("start"), Keyword, "reference"),
            (_word("accept"), Keyword, ("conditions", "condition")),
            (_NAME, Name.Label, "production"),
            include("stray"),
        ],
        "production": [
            include("gap"),
            include("string"),
            (_word("empty"), Keyword.Constant),
            (rf"{_NAME}(?={_GAP}:)", Name.Variable),
            (_NAME, Name),
            ("->", Operator),
            (":", Punctuation),
            default("#pop"),
        ],
        "reference": [include("gap"), (_NAME, Name, "#pop"), default("#pop")],
        "condition": [
            include("gap"),
            (_word("not"), Operator.Word),
            (_word("contains"), Keyword, ("#pop", "symbols")),
            (_word("starts", "ends"), Keyword, ("#pop", "symbols", "with")),
            (_word("count"), Keyword, ("#pop", "bound", "in parentheses")),
            (_word("length"), Keyword, ("#pop", "bound")),
            (_word("matches"), Keyword, ("#pop", "regex")),
            (r"\(", Punctuation, ("#pop", "close", "conditions", "condition")),
            default("#pop"),
        ],
        "conditions": [
            include("gap"),
            (_word("and", "or"), Operator.Word, "condition"),
            default("#pop"),
        ],
        "close": [include("gap"), (r"\)", Punctuation, "#pop"), default("#pop")],
        "with": [include("gap"), (_word("with"), Keyword, "#pop"), default("#pop")],
        "symbols": [include("gap"), include("string"), (_NAME, Name), default("#pop")],
        "bound": [include("gap"), (_COMPARISON, Operator, ("#pop", "operand")), default("#pop")],
        "regex": [
            include("gap"),
            include("string"),
            (_word("empty"), Keyword.Constant),
            (_NAME, Name),
            (r"[|*+?]", Operator),
            (r"\(", Punctuation, ("close", "regex")),
            default("#pop"),
        ],
        # --- semantics ----------------------------------------------------------------------
        "semantics": [
            include("block"),
            (_NAME, Name.Label),
            (r"\{", Punctuation, "rules"),
            include("stray"),
        ],
        "rules": [
            include("block"),
            (rf"(?:{'|'.join(EMISSIONS)}){_END}(?={_GAP}\()", Name.Builtin),
            (r"\.", Operator, "member"),
            ("=", Operator, "operand"),
            (r"\(", Punctuation, ("arguments", "argument")),
            include("stray"),
        ],
        # --- expressions --------------------------------------------------------------------
        "operand": [
            include("gap"),
            include("string"),
            ("-", Operator),
            (_NUMBER, Number, ("#pop", "operator", "unit")),
            (r"\(", Punctuation, ("#pop", "operator", "unit", "arguments", "argument")),
            (_word("world", "x", "y", "z"), Keyword.Constant, ("#pop", "operator")),
            (_word("this"), Name.Builtin.Pseudo, ("#pop", "operator")),
            (rf"(?:{'|'.join(FUNCTIONS)}){_END}(?={_GAP}\()", Name.Builtin, ("#pop", "operator")),
            (rf"pi{_END}(?!{_GAP}\.)", Name.Constant, ("#pop", "operator")),
            (_NAME, Name, ("#pop", "operator")),
            default("#pop"),
        ],
        "operator": [
            include("gap"),
            (r"[-+*/^]", Operator, ("#pop", "operand")),
            (r"\.", Operator, "member"),
            (r"\(", Punctuation, ("unit", "arguments", "argument")),
            default("#pop"),
        ],
        "member": [include("gap"), (_NAME, Name.Attribute, "#pop"), default("#pop")],
        "unit": [include("gap"), (_UNIT, Keyword.Type, "#pop"), default("#pop")],
        "argument": [
            include("gap"),
            (rf"{_NAME}(?={_GAP}:)", Name.Property),
            (":", Punctuation, ("#pop", "operand")),
            default(("#pop", "operand")),
        ],
        "arguments": _separated("argument", r"\)"),
        "interval": _separated("operand", r"\]"),
        # --- workspaces ---------------------------------------------------------------------
        "workspace": [
            include("block"),
            (_word("plane", "space"), Keyword, "dimension"),
            (_word("bounds"), Keyword, "shape"),
            (_word("region", "obstacle", "target"), Keyword.Declaration, ("shape", "region")),
            (_word("obstacles"), Keyword, "map"),
            include("stray"),
        ],
        "dimension": [include("gap"), (_word("xy", "xyz"), Keyword.Constant), default("#pop")],
        "region": [include("gap"), (_NAME, Name.Entity, "#pop"), default("#pop")],
        "map": [include("gap"), (_word("from"), Keyword), include("string"), default("#pop")],
        "shape": [
            include("gap"),
            (_word("box", "polytope", "hull", "ball", "capsule", "cylinder"), Keyword),
            (_word("radius"), Keyword, "operand"),
            (_word("x"), Operator.Word),
            (",", Punctuation),
            (r"\[", Punctuation, ("unit", "interval", "operand")),
            (r"\(", Punctuation, ("unit", "arguments", "operand")),
            (r"\{", Punctuation, ("unit", "inequalities", "operand")),
            default("#pop"),
        ],
        "inequalities": [
            include("gap"),
            (rf"{_COMPARISON}", Operator, "operand"),
            (";", Punctuation, "operand"),
            (r"\}", Punctuation, "#pop"),
            default("#pop"),
        ],
        # --- tasks --------------------------------------------------------------------------
        "task": [
            include("block"),
            (_word("robot", "workspace"), Keyword, "reference"),
            (_word("start"), Keyword, "start"),
            (_word("reach"), Keyword, ("placement", "reference")),
            (_word("avoid"), Keyword, ("avoided", "avoided region")),
            (_word("bounds"), Keyword, "subject"),
            (_word("effort"), Keyword, ("norm", "bound")),
            (_word("horizon"), Keyword, ("steps", "operand")),
            (_word("carry"), Keyword, ("placement", "carried", "operand")),
            (_word("slack", "gravity", "payload"), Keyword, ("placement", "operand")),
            (_word("modules"), Keyword, "bound"),
            (_word("from"), Keyword, ("word", "reference")),
            (_word("satisfy"), Keyword, "formula"),
            (_word("robust"), Keyword, "robust"),
            (_word("control", "repeat"), Keyword, "control"),
            include("stray"),
        ],
        "carried": [include("gap"), (_word("from", "to"), Keyword, "reference"), default("#pop")],
        "start": [
            include("gap"),
            (_word("in"), Keyword, ("#pop", "placement", "reference")),
            (_word("at"), Keyword, ("#pop", "operand")),
            default("#pop"),
        ],
        "placement": [
            include("gap"),
            (_word("by", "at", "rest", "held", "aligned", "x", "y", "z"), Keyword),
            (_word("effector", "for", "oriented", "to", "within"), Keyword, "operand"),
            ("-", Operator),
            (_word("rates"), Keyword, "bound"),
            default("#pop"),
        ],
        "avoided region": [
            include("gap"),
            (rf"self(?={_GAP}with{_END})", Name.Builtin.Pseudo, "#pop"),
            (_NAME, Name, "#pop"),
            default("#pop"),
        ],
        "avoided": [
            include("gap"),
            (",", Punctuation, "reference"),
            (_word("with"), Keyword, ("#pop", "subject")),
            default("#pop"),
        ],
        "subject": [
            include("gap"),
            (_word("with", "effector", "body"), Keyword),
            (_word("margin"), Keyword, "operand"),
            (_word("except"), Keyword, ("#pop", "names")),
            (",", Punctuation),
            default("#pop"),
        ],
        "names": [include("gap"), (_NAME, Name), (",", Punctuation), default("#pop")],
        "norm": [include("gap"), (_word("norm"), Keyword, "operand"), default("#pop")],
        "steps": [
            include("gap"),
            (_word("steps"), Keyword),
            (_word("of"), Keyword, "operand"),
            default("#pop"),
        ],
        "word": [
            include("gap"),
            include("string"),
            (_word("fixed"), Keyword, ("#pop", "fixed")),
            (_NAME, Name),
            default("#pop"),
        ],
        "fixed": [
            include("gap"),
            (_NAME, Name),
            (r"\.", Operator, "member"),
            ("=", Operator, "operand"),
            (",", Punctuation),
            default("#pop"),
        ],
        "robust": [
            include("gap"),
            (_word("start", "measure"), Keyword, ("#pop", "quantities")),
            (_word("effort", "mass", "payload"), Keyword, ("#pop", "percent", "operand")),
            default("#pop"),
        ],
        "quantities": [
            include("gap"),
            (_NUMBER, Number, "unit"),
            (r"\(", Punctuation, ("unit", "arguments", "operand")),
            (",", Punctuation),
            default("#pop"),
        ],
        "percent": [
            include("gap"),
            ("%", Keyword.Type),
            (_word("of"), Keyword, ("#pop", "part")),
            default("#pop"),
        ],
        "part": [include("gap"), (_word("bound"), Keyword, "#pop"), default(("#pop", "reference"))],
        "control": [include("gap"), (_word("open", "loop", "feedback"), Keyword), default("#pop")],
        # --- formulas -----------------------------------------------------------------------
        "formula": [
            include("gap"),
            (_word("not", "always", "eventually", "next", "last"), Operator.Word),
            (r"\[", Punctuation, ("interval", "operand")),
            (r"\(", Punctuation, ("#pop", "connective", "close", "formula")),
            (_NAME, Name, ("#pop", "connective")),
            default("#pop"),
        ],
        "connective": [
            include("gap"),
            (_word("and", "or", "until", "implies"), Operator.Word, ("#pop", "formula")),
            include("placement"),
        ],
    }
