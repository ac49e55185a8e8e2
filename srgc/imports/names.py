"""Names of the language for what other formats call as they like."""

from __future__ import annotations

import re
from collections.abc import Iterable

from grammar_lang.parsing.tables import RESERVED


class Names:
    """Gives each thing a name of its own; one that is wanted again gets a number."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self.given = set(taken)

    def name(self, wanted: str) -> str:
        """The name, changed as little as the language demands."""
        plain = re.sub(r"[^A-Za-z0-9_]+", "_", wanted).strip("_")
        if not plain or plain[0].isdigit() or plain in RESERVED:
            plain = f"_{plain}"
        found, number = plain, 2
        while found in self.given:
            found, number = f"{plain}_{number}", number + 1
        self.given.add(found)
        return found

    def camel(self, wanted: str) -> str:
        """The name with a capital for each word, as modules have it: ``UpperArm``."""
        words = re.split(r"[^A-Za-z0-9]+", wanted)
        return self.name("".join(word[:1].upper() + word[1:] for word in words))
