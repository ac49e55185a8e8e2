"""Name the types of ports, each for a type and the sizes of connectors, which must be equal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Literal

from srgc.imports.names import Names
from srgc.imports.timor.set_data import Connector, ConnectorGender

GENDER_WORDS: Mapping[ConnectorGender, Literal["male", "female"] | None] = {
    "f": "female",
    "m": "male",
    "h": None,
}
COMPLEMENT: Mapping[ConnectorGender, ConnectorGender] = {"f": "m", "m": "f", "h": "h"}


class PortTypes:
    """Names for each type with each size, in the order of the connectors."""

    def __init__(self, connectors: Iterable[Connector]) -> None:
        names = Names()
        self._names = dict[tuple[str, tuple[str, ...]], str]()
        for connector in connectors:
            key = (connector.type, connector.size)
            if key not in self._names:
                self._names[key] = names.name(_wanted(connector))

    def name(self, connector: Connector) -> str:
        """The name of the type of a connector."""
        return self._names[connector.type, connector.size]


def _wanted(connector: Connector) -> str:
    """The wanted name, such as ``Schunk_1`` or ``Default_0_08``."""
    kind = Names().camel(connector.type or "Flange")
    return "_".join((kind, *connector.size))
