"""The texts of ``srgc check`` and ``srgc explain`` about diagnostics and their codes."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

from grammar_lang.diagnostics.code_pages import find_code, has_page, nearest_codes, page_text, title
from grammar_lang.diagnostics.diagnostic import Code, Severity
from grammar_lang.diagnostics.wording import counted
from srgc.faults import UsageFault
from srgc.session import Checked

# --- The last line of ``srgc check``: the number of diagnostics of each severity ------------------


def summary(results: Sequence[Checked]) -> str:
    """One line about all files of a call."""
    found = Counter(d.severity for result in results for d in result.diagnostics)
    files = counted(len(results), "file")
    counts = [counted(found[kind], kind.value) for kind in Severity if found[kind]]
    if not found[Severity.ERROR]:
        return ", ".join([f"{files} without errors", *counts])
    return f"{files}: {', '.join(counts)}; `srgc explain CODE` explains a code"


# --- The text of ``srgc explain``: pages of the catalogue, or the list of all codes ---------------


_BOLD, _RESET = "\033[1m", "\033[0m"
_HEADING = re.compile(r"^(?:# .*|Fails:|Repaired:)$", re.MULTILINE)


def list_of_codes() -> str:
    """All codes with their titles, one per line."""
    return "".join(f"{code.value}  {title(code)}\n" for code in Code)


def explanation(codes: Sequence[str], *, colour: bool) -> str:
    """The pages of the codes that the user named, as Markdown; headings in bold with ``colour``.

    Raises:
        UsageFault: a text is not a code.
    """
    pages = "\n".join(_page(_known(text)) for text in codes)
    return _HEADING.sub(rf"{_BOLD}\g<0>{_RESET}", pages) if colour else pages


def _known(text: str) -> Code:
    code = find_code(text)
    if code is None:
        near = ", ".join(near.value for near in nearest_codes(text))
        hint = f"the nearest are {near}" if near else "`srgc explain` lists all codes"
        raise UsageFault(f"there is no code {text!r}; {hint}")
    return code


def _page(code: Code) -> str:
    if has_page(code):
        return page_text(code)
    return f"# {code.value}: {title(code)}\n\nThis code has no page yet.\n"
