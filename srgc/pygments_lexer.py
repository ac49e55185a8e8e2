"""Syntax highlighting of ``.srg`` for Pygments: Sphinx, ``pygmentize``, rich.

Keywords are contextual, so the lexer follows the grammar (``srg.lark``): a statement is a chain of
states.  Each state names the few words that have a meaning there, and ends at anything else.
Source: G. Brandl et al., Pygments, *Write your own lexer*,
https://pygments.org/docs/lexerdevelopment/.
"""

from __future__ import annotations

import re
from typing import ClassVar

from pygments.lexer import RegexLexer, bygroups, default, include
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, String, Text

from srgc.pygments_patterns import (
    COMPARISON,
    EMISSIONS,
    END,
    FUNCTIONS,
    GAP,
    ITEMS,
    NAME,
    NUMBER,
    ROLES,
    UNIT,
    heading,
    separated,
    word_of,
)
from srgc.pygments_tasks import TASK_STATES


class SrgLexer(RegexLexer):  # type: ignore[misc]  # Pygments has no types
    """The lexer for ``.srg``; it covers every character of any text and always ends."""

    name = "SRG"
    aliases: ClassVar = ["srg"]
    filenames: ClassVar = ["*.srg"]
    mimetypes: ClassVar = ["text/x-srg"]

    @staticmethod
    def analyse_text(text: str) -> float:
        """The likelihood that a text is ``.srg``: high if it contains ``module NAME { role``."""
        return 0.9 if re.search(r"\bmodule\s+\w+\s*\{\s*role\b", text) else 0.0

    tokens: ClassVar = {
        "root": [
            include("gap"),
            (word_of("include"), Keyword.Namespace, "path"),
            (word_of("edge"), Keyword.Declaration, "edges"),
            include("item"),
            include("stray"),
        ],
        # --- allowed anywhere ---------------------------------------------------------------
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
        # Outside of known statements: between statements, and after an error.
        "stray": [
            include("string"),
            (NUMBER, Number),
            (NAME, Name),
            (word_of("and", "or", "not"), Operator.Word),
            (word_of("empty", "world", "x", "y", "z"), Keyword.Constant),
            (word_of("this"), Name.Builtin.Pseudo),
            (word_of("start", "accept"), Keyword),
            (rf"->|{COMPARISON}|[-+*/^=|?%.]", Operator),
            (r"[][(){},;:]", Punctuation),
        ],
        # --- items --------------------------------------------------------------------------
        "item": [
            (word_of("module"), Keyword.Declaration, ("module", "heading", "class")),
            (
                word_of("grammar"),
                Keyword.Declaration,
                ("grammar", "heading", "from ports", "namespace"),
            ),
            (word_of("semantics"), Keyword.Declaration, ("semantics", "heading", "namespace")),
            (word_of("workspace"), Keyword.Declaration, ("workspace", "heading", "namespace")),
            (word_of("task"), Keyword.Declaration, ("task", "heading", "namespace")),
            (word_of("mission"), Keyword.Declaration, ("mission", "heading", "namespace")),
        ],
        "from ports": [
            include("gap"),
            (word_of("from", "ports"), Keyword),
            default("#pop"),
        ],
        "heading": [include("gap"), (r"\{", Punctuation, "#pop"), default("#pop")],
        "class": heading(Name.Class),
        "namespace": heading(Name.Namespace),
        "path": [
            include("gap"),
            (word_of("std"), Keyword),
            include("string"),
            default("#pop"),
        ],
        "edges": [
            include("gap"),
            include("string"),
            (NAME, Name.Class),
            (",", Punctuation),
            default("#pop"),
        ],
        # A closing brace may be missing; no statement of the language looks like the head of an
        # item.
        "next item": [
            (
                rf"(?=(?:{ITEMS}){END}{GAP}{NAME}(?:{GAP}from{GAP}ports)?{GAP}\{{)",
                bygroups(),
                "#pop",
            )
        ],
        "block": [include("gap"), include("next item"), (r"\}", Punctuation, "#pop")],
        # --- modules ------------------------------------------------------------------------
        "module": [
            include("block"),
            (word_of("role"), Keyword, "role"),
            (word_of("named"), Keyword, "name"),
            (word_of("param", "input"), Keyword.Declaration, ("domain", "declared")),
            (word_of("const"), Keyword.Declaration, ("definition", "declared")),
            (word_of("state"), Keyword.Declaration, ("definition", "unit", "declared")),
            (word_of("dof", "drive"), Keyword.Declaration, ("dof", "declared")),
            (word_of("der", "torque"), Keyword, ("definition", "in parentheses")),
            (word_of("frame"), Keyword.Declaration, ("definition", "declared")),
            (word_of("port"), Keyword.Declaration, ("port", "declared")),
            (rf"(?:{'|'.join(EMISSIONS)}){END}(?={GAP}\()", Name.Builtin),
            (r"\(", Punctuation, ("arguments", "argument")),
            include("stray"),
        ],
        "port": [
            include("gap"),
            (":", Punctuation, ("#pop", "gender", "reference")),
            default("#pop"),
        ],
        "gender": [include("gap"), (word_of("male", "female"), Keyword), default("#pop")],
        "role": [
            include("gap"),
            (word_of(*ROLES), Name.Constant, "#pop"),
            (NAME, Name, "#pop"),
            default("#pop"),
        ],
        "name": [include("gap"), include("string"), default("#pop")],
        "declared": [include("gap"), (NAME, Name.Variable, "#pop"), default("#pop")],
        "definition": [include("gap"), ("=", Operator, ("#pop", "operand")), default("#pop")],
        "in parentheses": [
            include("gap"),
            include("string"),
            (r"\(", Punctuation),
            (NAME, Name),
            (r"\)", Punctuation, "#pop"),
            default("#pop"),
        ],
        "domain": [
            include("gap"),
            (word_of("in"), Keyword),
            (r"\[", Punctuation, ("unit", "interval", "operand")),
            (r"\{", Punctuation, ("unit", "choices", "operand")),
            default("#pop"),
        ],
        "choices": separated("operand", r"\}"),
        "dof": [
            include("gap"),
            (word_of("revolute", "prismatic"), Keyword),
            include("string"),
            (word_of("in", "rate", "accel", "effort", "named"), Keyword),
            (word_of("gear", "rotor", "viscous", "coulomb"), Keyword, "operand"),
            (word_of("x", "y", "z"), Keyword.Constant),
            (rf"-|{COMPARISON}", Operator, "operand"),
            (":", Punctuation),
            (r"\[", Punctuation, ("unit", "interval", "operand")),
            default("#pop"),
        ],
        # --- grammars -----------------------------------------------------------------------
        "grammar": [
            include("block"),
            (word_of("start"), Keyword, "reference"),
            (rf"with{END}(?!{GAP}:)", Keyword, "names"),
            (word_of("accept"), Keyword, ("conditions", "condition")),
            (NAME, Name.Label, "production"),
            include("stray"),
        ],
        "production": [
            include("gap"),
            include("string"),
            (word_of("empty"), Keyword.Constant),
            (rf"{NAME}(?={GAP}:)", Name.Variable),
            (NAME, Name),
            ("->", Operator),
            (":", Punctuation),
            default("#pop"),
        ],
        "reference": [include("gap"), (NAME, Name, "#pop"), default("#pop")],
        "condition": [
            include("gap"),
            (word_of("not"), Operator.Word),
            (word_of("contains"), Keyword, ("#pop", "symbols")),
            (word_of("starts", "ends"), Keyword, ("#pop", "symbols", "with")),
            (word_of("count"), Keyword, ("#pop", "bound", "in parentheses")),
            (word_of("length"), Keyword, ("#pop", "bound")),
            (word_of("matches"), Keyword, ("#pop", "regex")),
            (r"\(", Punctuation, ("#pop", "close", "conditions", "condition")),
            default("#pop"),
        ],
        "conditions": [
            include("gap"),
            (word_of("and", "or"), Operator.Word, "condition"),
            default("#pop"),
        ],
        "close": [include("gap"), (r"\)", Punctuation, "#pop"), default("#pop")],
        "with": [include("gap"), (word_of("with"), Keyword, "#pop"), default("#pop")],
        "symbols": [include("gap"), include("string"), (NAME, Name), default("#pop")],
        "bound": [include("gap"), (COMPARISON, Operator, ("#pop", "operand")), default("#pop")],
        "regex": [
            include("gap"),
            include("string"),
            (word_of("empty"), Keyword.Constant),
            (NAME, Name),
            (r"[|*+?]", Operator),
            (r"\(", Punctuation, ("close", "regex")),
            default("#pop"),
        ],
        # --- semantics ----------------------------------------------------------------------
        "semantics": [
            include("block"),
            (NAME, Name.Label),
            (r"\{", Punctuation, "rules"),
            include("stray"),
        ],
        "rules": [
            include("block"),
            (rf"let{END}(?!{GAP}\.)", Keyword.Declaration, ("definition", "declared")),
            (rf"(?:{'|'.join(EMISSIONS)}){END}(?={GAP}\()", Name.Builtin),
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
            (NUMBER, Number, ("#pop", "operator", "unit")),
            (r"\(", Punctuation, ("#pop", "operator", "unit", "arguments", "argument")),
            (word_of("world", "x", "y", "z"), Keyword.Constant, ("#pop", "operator")),
            (word_of("this"), Name.Builtin.Pseudo, ("#pop", "operator")),
            (rf"(?:{'|'.join(FUNCTIONS)}){END}(?={GAP}\()", Name.Builtin, ("#pop", "operator")),
            (rf"pi{END}(?!{GAP}\.)", Name.Constant, ("#pop", "operator")),
            (NAME, Name, ("#pop", "operator")),
            default("#pop"),
        ],
        "operator": [
            include("gap"),
            (r"[-+*/^]", Operator, ("#pop", "operand")),
            (r"\.", Operator, "member"),
            (r"\(", Punctuation, ("unit", "arguments", "argument")),
            default("#pop"),
        ],
        "member": [include("gap"), (NAME, Name.Attribute, "#pop"), default("#pop")],
        "unit": [include("gap"), (UNIT, Keyword.Type, "#pop"), default("#pop")],
        "argument": [
            include("gap"),
            (rf"{NAME}(?={GAP}:)", Name.Property),
            (":", Punctuation, ("#pop", "operand")),
            default(("#pop", "operand")),
        ],
        "arguments": separated("argument", r"\)"),
        "interval": separated("operand", r"\]"),
        # --- workspaces ---------------------------------------------------------------------
        "workspace": [
            include("block"),
            (word_of("plane", "space"), Keyword, "dimension"),
            (word_of("bounds"), Keyword, "shape"),
            (word_of("region", "obstacle", "target"), Keyword.Declaration, ("shape", "region")),
            (word_of("obstacles"), Keyword, "map"),
            include("stray"),
        ],
        "dimension": [include("gap"), (word_of("xy", "xyz"), Keyword.Constant), default("#pop")],
        "region": [include("gap"), (NAME, Name.Entity, "#pop"), default("#pop")],
        "map": [
            include("gap"),
            (word_of("from"), Keyword),
            (word_of("in"), Keyword, "unit"),
            (word_of("at"), Keyword, "operand"),
            include("string"),
            default("#pop"),
        ],
        "shape": [
            include("gap"),
            (word_of("box", "polytope", "hull", "ball", "capsule", "cylinder"), Keyword),
            (word_of("radius"), Keyword, "operand"),
            (word_of("x"), Operator.Word),
            (",", Punctuation),
            (r"\[", Punctuation, ("unit", "interval", "operand")),
            (r"\(", Punctuation, ("unit", "arguments", "operand")),
            (r"\{", Punctuation, ("unit", "inequalities", "operand")),
            default("#pop"),
        ],
        "inequalities": [
            include("gap"),
            (rf"{COMPARISON}", Operator, "operand"),
            (";", Punctuation, "operand"),
            (r"\}", Punctuation, "#pop"),
            default("#pop"),
        ],
        **TASK_STATES,
    }
