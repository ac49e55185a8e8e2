"""Files of an import replace others only where that is asked for and nothing else needs them."""

from __future__ import annotations

from pathlib import Path

import pytest

from srgc.faults import UsageFault
from srgc.imports.written_import import Imported, write_import

MESH = "arm_meshes/part.obj"


def spec_with(mesh: bytes) -> Imported:
    return Imported("arm", f'  hull(frame: in, file: "{MESH}", scale: 1 m);\n', {MESH: mesh})


@pytest.mark.parametrize("force", [False, True])
def test_meshes_of_another_spec_are_kept(tmp_path, force):
    write_import(spec_with(b"first"), tmp_path / "one.srg", force=False)
    with pytest.raises(UsageFault, match=r"part\.obj is there already, and .*one\.srg needs it"):
        write_import(spec_with(b"second"), tmp_path / "two.srg", force=force)
    assert (tmp_path / MESH).read_bytes() == b"first"
    assert not (tmp_path / "two.srg").exists()


def test_equal_meshes_serve_two_specs(tmp_path):
    for name in ("one.srg", "two.srg"):
        write_import(spec_with(b"same"), tmp_path / name, force=False)
    assert (tmp_path / "two.srg").exists()


def test_force_replaces_the_meshes_of_the_spec(tmp_path):
    write_import(spec_with(b"first"), tmp_path / "one.srg", force=False)
    with pytest.raises(UsageFault, match="--force replaces it"):
        write_import(spec_with(b"second"), tmp_path / "one.srg", force=False)
    write_import(spec_with(b"second"), tmp_path / "one.srg", force=True)
    assert (tmp_path / MESH).read_bytes() == b"second"


@pytest.mark.parametrize("force", [False, True])
def test_a_folder_in_the_way_costs_no_file(tmp_path, force):
    write_import(spec_with(b"first"), tmp_path / "one.srg", force=False)
    (tmp_path / "arm_meshes" / "way.obj").mkdir()
    files = {MESH: b"second", "arm_meshes/way.obj": b"second"}
    with pytest.raises(UsageFault, match=r"way\.obj is a folder"):
        write_import(Imported("arm", "", files), tmp_path / "one.srg", force=force)
    assert (tmp_path / MESH).read_bytes() == b"first"
    assert MESH in (tmp_path / "one.srg").read_text()


def test_files_that_are_there_outlive_a_disk_that_is_full(tmp_path, monkeypatch):
    write_import(spec_with(b"first"), tmp_path / "one.srg", force=False)
    write = Path.write_bytes

    def full(path, data):
        if data == b"third":
            raise OSError(28, "No space left on device")
        return write(path, data)

    monkeypatch.setattr(Path, "write_bytes", full)
    files = {MESH: b"second", "arm_meshes/other.obj": b"third"}
    with pytest.raises(UsageFault, match="No space left"):
        write_import(Imported("arm", "", files), tmp_path / "one.srg", force=True)
    assert (tmp_path / MESH).read_bytes() == b"first"
    assert [each.name for each in (tmp_path / "arm_meshes").iterdir()] == ["part.obj"]
