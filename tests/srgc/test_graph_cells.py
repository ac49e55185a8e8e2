from __future__ import annotations


def nodes(text: str) -> list[str]:
    return [line for line in text.splitlines() if "pos=" in line]


def edges(text: str) -> list[str]:
    return [line for line in text.splitlines() if " -- " in line]


def test_a_workspace_is_split_into_so_many_cells(srgc, arm_file):
    coarse = srgc("graph", arm_file, "--of", "workspace").out
    finer = srgc("graph", arm_file, "--of", "workspace", "--cells", "40")
    assert (finer.status, finer.err) == (0, "")
    assert len(nodes(finer.out)) == 40
    assert len(edges(finer.out)) > len(edges(coarse))
    pairs = [tuple(sorted(line.strip(" ;").split(" -- "))) for line in edges(finer.out)]
    assert len(set(pairs)) == len(pairs)
    assert srgc("graph", arm_file, "--of", "workspace", "--cells", "2").out == coarse


def test_cells_go_with_a_workspace_only(srgc, arm_file):
    ran = srgc("graph", arm_file, "--of", "sra", "--cells", "40")
    assert (ran.status, ran.out) == (2, "")
    assert "--of workspace" in ran.err
    assert srgc("graph", arm_file, "--of", "workspace", "--cells", "0").status == 2
