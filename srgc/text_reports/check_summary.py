"""The last line of ``srgc check``: how many findings of which kind."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from grammar_lang.diagnostics.diagnostic import Severity
from grammar_lang.diagnostics.wording import counted
from srgc.session import Checked


def summary(results: Sequence[Checked]) -> str:
    """One line about all files of a call."""
    found = Counter(d.severity for result in results for d in result.diagnostics)
    files = counted(len(results), "file")
    counts = [counted(found[kind], kind.value) for kind in Severity if found[kind]]
    if not found[Severity.ERROR]:
        return ", ".join([f"{files} without errors", *counts])
    return f"{files}: {', '.join(counts)}; `srgc explain CODE` says more of a code"
