"""Paths that no file can have, or that cannot even be looked at: told before anything is done.

What the system says of such a path is an exception of any call that takes it, also of those that
only ask whether a file is there.
"""

from __future__ import annotations

import errno
import os

from srgc.faults import UsageFault

ABSENT = (errno.ENOENT, errno.ENOTDIR, errno.ELOOP)
"""Nothing is there, which each command says in its own words, or there will be."""


def refuse_impossible(path: str | os.PathLike[str]) -> None:
    """Refuse a path that nothing can be read from or written to.

    Args:
        path: as a user gives it, of a file or folder that need not exist.

    Raises:
        UsageFault: it holds a NUL, cannot be encoded, is too long, ends like a folder but is a
            file, or is in a folder that must not be looked into.
    """
    from grammar_lang.files.file_tree import shown

    text = os.fspath(path)
    name = shown(text)
    if "\0" in text:
        raise UsageFault(f"{name}: no path has a NUL character")
    try:
        os.stat(text)  # noqa: PTH116 - a Path has lost a slash at the end
    except UnicodeEncodeError:
        raise UsageFault(f"{name}: no path has such a character") from None
    except OSError as error:
        if error.errno == errno.ENOTDIR and text.endswith("/"):
            raise UsageFault(f"{name}: {error.strerror}") from None
        if error.errno not in ABSENT:
            raise UsageFault(f"{name}: {error.strerror}") from None
