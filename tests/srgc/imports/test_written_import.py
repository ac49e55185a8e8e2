"""Files of an import replace others only where that is asked for and nothing else needs them."""

from __future__ import annotations

from pathlib import Path

import pytest

from srgc.faults import UsageFault
from srgc.imports.written_import import Imported, mesh_folder, write_import

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


def bent(size):
    """A sheet of two triangles across an edge, which two pieces hold."""
    corners = f"v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nv {size} {size} {size}\n"
    other = corners.replace("v ", "v 9")
    return f"{corners}f 1 2 3\nf 2 4 3\n{other}f 5 6 7\nf 6 8 7\n"


@pytest.mark.parametrize("kind", ["scene", "urdf"])
def test_imports_of_one_name_beside_each_other(kind, tmp_path, srgc):
    """Each has a folder of meshes that is called like its spec."""
    for name, size in (("one", 1), ("two", 2)):
        source = tmp_path / f"from_{name}"
        source.mkdir()
        (source / "part.obj").write_text(bent(size))
        collision = '<collision><geometry><mesh filename="part.obj"/></geometry></collision>'
        robot = f'<robot name="r"><link name="a">{collision}</link></robot>'
        (source / "r.urdf").write_text(robot)
        file = source / ("part.obj" if kind == "scene" else "r.urdf")
        ran = srgc("import", kind, file, "-o", tmp_path / f"{name}.srg")
        assert ran.status == 0, ran.err
        folder = tmp_path / f"{name}_meshes"
        assert f"{folder}: " in ran.out
        assert folder.is_dir()
        assert f'"{name}_meshes/' in (tmp_path / f"{name}.srg").read_text()
    assert not (tmp_path / "obstacles").exists()


@pytest.mark.parametrize(
    ("stem", "folder"),
    [("ur5", "ur5_meshes"), ("my cell", "my cell_meshes"), ('a"b\\c\nd', "a_b_c_d_meshes"),
     ("база", "база_meshes"), ("\udcff", "__meshes")],
)  # fmt: skip
def test_folders_are_called_like_specs(stem, folder):
    assert mesh_folder(stem) == folder


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


def test_a_spec_beside_that_cannot_be_read(tmp_path, monkeypatch):
    """It may need the mesh as it is, so the mesh stays."""
    write_import(spec_with(b"first"), tmp_path / "one.srg", force=False)
    read_bytes = Path.read_bytes

    def refused(path):
        if path.name == "one.srg":
            raise PermissionError(13, "Permission denied")
        return read_bytes(path)

    monkeypatch.setattr(Path, "read_bytes", refused)
    with pytest.raises(UsageFault, match=r"one\.srg: Permission denied; it may name"):
        write_import(spec_with(b"second"), tmp_path / "two.srg", force=True)
    monkeypatch.undo()
    assert (tmp_path / MESH).read_bytes() == b"first"
