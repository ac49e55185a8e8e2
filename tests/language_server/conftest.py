from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.language_server.client import Client


@pytest.fixture
def started() -> Iterator[Callable[..., Client]]:
    """Starts servers, and sees to their end."""
    clients: list[Client] = []

    def start(*arguments: str) -> Client:
        clients.append(Client(*arguments))
        return clients[-1]

    yield start
    for client in clients:
        client.kill()


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """One initialized server for the tests of a module; its folder has a blank in its name."""
    folder: Path = tmp_path_factory.mktemp("a folder")
    made = Client()
    made.folder = folder
    made.initialize(
        folder,
        textDocument={"completion": {"completionItem": {"snippetSupport": True}}},
        window={"workDoneProgress": True},
        workspace={"codeLens": {"refreshSupport": True}},
    )
    yield made
    made.kill()
