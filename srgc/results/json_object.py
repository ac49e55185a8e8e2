"""The object that a JSON file of a result folder holds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from solvers.verifier.claims.spec_copy import bounded_bytes
from srgc.faults import UsageFault


def json_object(path: Path, *, needed: bool = True) -> dict[str, Any]:
    """The object in a file; an empty one where the file is missing and not ``needed``.

    Raises:
        UsageFault: it holds none, or cannot be read.
    """
    try:
        content = json.loads(bounded_bytes(path))
    except OSError as error:
        if not needed and not path.exists():
            return {}
        raise UsageFault(f"{path}: {error.strerror}") from None
    except (ValueError, RecursionError):
        raise UsageFault(f"{path} is not JSON") from None
    if not isinstance(content, dict):
        raise UsageFault(f"{path} is no JSON object")
    return content
