"""Lenses on missions, and their commands: a synthesis with its verdict, which is verified."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

from srgc.language_server.documents.uris import uri_of
from tests.language_server.client import Client
from tests.oracles.small_missions import SHOP


def lenses(client: Client, uri: str, name: str) -> list[tuple[str, list[str]]]:
    """Titles and arguments of the lenses that are about a name."""
    found = client.ask("textDocument/codeLens", {"textDocument": {"uri": uri}})
    commands = [lens["command"] for lens in found]
    return [(c["title"], c["arguments"]) for c in commands if c["arguments"][1] == name]


def test_a_mission_is_synthesised_and_verified(client: Client) -> None:
    path = client.folder / "shop.srg"
    path.write_text(SHOP, encoding="utf-8", newline="")
    uri = uri_of(path)
    client.open(uri, SHOP)
    asked = [uri, "Nobody", "mission"]
    assert lenses(client, uri, "Nobody") == [("check", asked), ("synth", asked)]
    assert lenses(client, uri, "Long")[0] == ("check", [uri, "Long"])
    answer = client.ask("workspace/executeCommand", {"command": "srgc.synth", "arguments": asked})
    assert answer == {"verdict": "impossible", "status": 3}
    (*_, (title, _)) = lenses(client, uri, "Nobody")
    assert title.startswith("impossible: no robot of at most 4 modules does all tasks")
    assert title.endswith("… (verified)")


def test_verdicts_of_found_missions(client: Client, made: Callable[[str], Path]) -> None:
    folder = client.folder / "found"
    folder.mkdir()
    path = folder / "mission_retune.srg"
    path.write_text(SHOP, encoding="utf-8", newline="")
    for name in ("Retune", "Both"):
        shutil.copytree(made(f"mission_{name.lower()}") / "out", folder / "out" / name)
    uri = uri_of(path)
    client.open(uri, SHOP)
    asked = {"command": "srgc.verify", "arguments": [uri, "Retune", "mission"]}
    assert lenses(client, uri, "Retune")[-1][0] == "found: changes 0.5"
    assert client.ask("workspace/executeCommand", asked) == {"outcome": "verified", "status": 0}
    assert lenses(client, uri, "Retune")[-1][0] == "found: changes 0.5 (verified)"
    assert lenses(client, uri, "Both")[-1][0] == "stale: found: B eps JO eps L eps EN"
    # A design that is no longer the one that was verified takes the word back.
    certificate = folder / "out" / "Retune" / "tasks" / "Short" / "certificate.json"
    certificate.write_text(certificate.read_text("utf-8") + " ", encoding="utf-8")
    assert lenses(client, uri, "Retune")[-1][0] == "found: changes 0.5"


def test_a_step_of_evolve_is_verified_from_the_lens_of_its_task(
    client: Client, made: Callable[[str], Path]
) -> None:
    """``srgc evolve`` writes to ``out/TASK`` by default."""
    folder = client.folder / "evolved"
    folder.mkdir()
    path = folder / "shop.srg"
    path.write_text(SHOP, encoding="utf-8", newline="")
    shutil.copytree(made("mission_retune") / "out", folder / "before")
    from srgc.cli import run

    step = folder / "out" / "Long"
    assert (
        run(["evolve", str(folder / "before"), str(path), "--task", "Long", "-o", str(step)]) == 0
    )
    uri = uri_of(path)
    client.open(uri, SHOP)
    assert lenses(client, uri, "Long")[-1][0] == "found: changes 2"
    asked = {"command": "srgc.verify", "arguments": [uri, "Long"]}
    assert client.ask("workspace/executeCommand", asked) == {"outcome": "verified", "status": 0}


def test_other_kinds_are_refused(client: Client) -> None:
    uri = uri_of(client.folder / "none.srg")
    client.open(uri, SHOP)
    for arguments, said in (
        ([uri, "Nobody", "kit"], "a `task` or a `mission`"),
        ([uri, "Nobody"], "there is no task `Nobody`"),
        ([uri, "Long", "mission"], "there is no mission `Long`"),
    ):
        error = client.error(
            "workspace/executeCommand", {"command": "srgc.check", "arguments": arguments}
        )
        assert said in error["message"]
