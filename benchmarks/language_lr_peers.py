"""The adapters of lark and parglare, which take the grammar as text; see ``language_peers``."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from contextlib import redirect_stdout
from io import StringIO
from typing import Any

from language_peer import NotApplicableError, Peer, Word, names_of, rights_of, terminals_of

from grammar_lang import ir

# --- lark -----------------------------------------------------------------------------------------


class _Lark(Peer):
    """A parser of lark's behind a lexer that passes tokens on."""

    def __init__(self, grammar: ir.Grammar) -> None:
        from lark import Token, UnexpectedInput
        from lark.exceptions import GrammarError, ParseError

        names = names_of(grammar, "n", "T")
        self._tokens = {t: Token(names[t, False], t) for t in terminals_of(grammar)}
        alternatives: dict[str, list[str]] = {}
        for left, right in rights_of(grammar, names):
            alternatives.setdefault(left, []).append(" ".join(right))
        rules = [f"{left}: {' | '.join(rights)}" for left, rights in alternatives.items()]
        declared = " ".join(token.type for token in self._tokens.values())
        self._text = "\n".join([*rules, f"%declare {declared}", ""])
        self._start = names[grammar.start, True]
        self._rules = list(alternatives)
        self._refusals = (UnexpectedInput, ParseError)
        try:
            self._parse = self._lark().parse
        except GrammarError as error:
            raise NotApplicableError(str(error).splitlines()[0]) from error

    def _lark(self, **more: Any) -> Any:
        from lark import Lark
        from lark.lexer import Lexer

        class Tokens(Lexer):
            """The word is a list of tokens already."""

            def __init__(self, _conf: Any) -> None:
                pass

            def lex(self, data: Iterable[Any]) -> Iterator[Any]:  # type: ignore[override]
                return iter(data)

        return Lark(self._text, start=self._start, lexer=Tokens, **self._options(), **more)

    @abstractmethod
    def _options(self) -> dict[str, Any]: ...

    def encode(self, word: Word) -> Any:
        from lark import Token

        return [self._tokens.get(token) or Token("UNKNOWN", token) for token in word]

    def accepts(self, word: Any) -> bool:
        try:
            self._parse(word)
        except self._refusals:
            return False
        return True


class LarkLalr(_Lark):
    """LALR(1) without a tree; a shift/reduce conflict is resolved as a shift without a word."""

    name = "lark LALR"
    any_grammar = False

    def _options(self) -> dict[str, Any]:
        from lark import Transformer

        # Nothing is quicker than an action that gives nothing, and tokens that are not sorted out.
        nothing = dict.fromkeys(self._rules, lambda _self, _children: None)
        actions = type("Nothing", (Transformer,), nothing)()
        return {"parser": "lalr", "keep_all_tokens": True, "transformer": actions}

    def remark(self) -> str:
        from lark.exceptions import GrammarError

        try:
            self._lark(strict=True)
        except GrammarError:
            return "not the grammar as it is: shift/reduce conflicts silently resolved as shifts"
        return ""


class LarkEarley(_Lark):
    """Earley; the forest is not unfolded into a tree."""

    name = "lark Earley"

    def _options(self) -> dict[str, Any]:
        return {"parser": "earley", "ambiguity": "forest"}


# --- parglare -------------------------------------------------------------------------------------


class _Parglare(Peer):
    """A parser of parglare's over lists, each token recognised by looking it up."""

    def __init__(self, grammar: ir.Grammar) -> None:
        from parglare import Grammar, exceptions

        names = names_of(grammar, "n", "T")
        rules: dict[str, list[str]] = {}
        for left, right in rights_of(grammar, names):
            rules.setdefault(left, []).append(" ".join(right) or "EMPTY")
        text = [f"{left}: {' | '.join(rights)};" for left, rights in rules.items()]
        letters = {t: names[t, False] for t in terminals_of(grammar)}
        text += ["terminals", *(f"{letter}: ;" for letter in letters.values())]
        recognisers = {n: _recogniser(t) for t, n in letters.items()}
        try:
            read = Grammar.from_string("\n".join(text), recognizers=recognisers)
            self._symbols = {t: read.get_terminal(n) for t, n in letters.items()}
            with redirect_stdout(StringIO()):  # it prints its tables where it finds a conflict
                self._parser = self._parser_of(read)
        except exceptions.LRConflicts as error:
            raise NotApplicableError("the grammar has conflicts") from error
        except exceptions.GrammarError as error:
            raise NotApplicableError(str(error).splitlines()[0]) from error
        self._refusal = exceptions.SyntaxError

    @abstractmethod
    def _parser_of(self, read: Any) -> Any: ...

    def _next_token(self, head: Any, _usual: Any) -> list[Any] | None:
        from parglare.parser import Token

        token = head.input_str[head.position]
        symbol = self._symbols.get(token)
        if symbol is None or symbol not in head.state.actions:
            return None
        return [Token(symbol, [token], head.position)]

    def accepts(self, word: Any) -> bool:
        try:
            self._parser.parse(word)
        except self._refusal:
            return False
        return True


class ParglareGlr(_Parglare):
    """Generalised LR."""

    name = "parglare GLR"

    def _parser_of(self, read: Any) -> Any:
        from parglare import GLRParser

        return GLRParser(read, ws=None, custom_token_recognition=self._next_token)


class ParglareLr(_Parglare):
    """LALR(1) without preferences: a conflict is an error."""

    name = "parglare LR"
    any_grammar = False

    def _parser_of(self, read: Any) -> Any:
        from parglare import Parser

        return Parser(
            read,
            ws=None,
            build_tree=True,
            prefer_shifts=False,
            prefer_shifts_over_empty=False,
            custom_token_recognition=self._next_token,
        )


def _recogniser(terminal: str) -> Any:
    def recognise(word: Sequence[str], position: int) -> Sequence[str] | None:
        return [terminal] if word[position] == terminal else None

    return recognise
