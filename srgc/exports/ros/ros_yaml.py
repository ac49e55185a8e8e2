"""Settings as YAML, in the order in which they are given."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml


def yaml_text(content: Mapping[str, Any]) -> str:
    """A document of YAML 1.1, as ROS reads it."""
    return str(yaml.safe_dump(dict(content), sort_keys=False, width=10**9, allow_unicode=True))
