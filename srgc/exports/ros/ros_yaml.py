"""Write settings as YAML, in their given order."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml


def yaml_text(content: Mapping[str, Any]) -> str:
    """A YAML 1.1 document, which ROS reads."""
    return str(yaml.safe_dump(dict(content), sort_keys=False, width=10**9, allow_unicode=True))
