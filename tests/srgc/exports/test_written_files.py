"""All files of an export are written, in folders that are made, or none."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from srgc.exports.written_files import write_files
from srgc.faults import UsageFault
from srgc.results.folder_writer import FolderOutput
from tests.oracles import geared_arm as arm
from tests.srgc.conftest import Ran


def output(path: Path) -> FolderOutput:
    return FolderOutput(path, path.parent / "out", None)


def everything(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*"))


def test_nothing_is_left_where_one_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "old.csv").write_bytes(b"old")
    (tmp_path / "there").mkdir()
    first, second = tmp_path / "old.csv", tmp_path / "new" / "er" / "a.csv"
    before = everything(tmp_path)
    for wrong in (tmp_path / "there", tmp_path / "old.csv" / "b.csv"):
        with pytest.raises(UsageFault):
            write_files([(output(path), b"1") for path in (first, second, wrong)])
        assert everything(tmp_path) == before
        assert first.read_bytes() == b"old"
    write_files([(output(path), b"1") for path in (first, second)])
    assert (first.read_bytes(), second.read_bytes()) == (b"1", b"1")
    assert everything(tmp_path) == ["new", "new/er", "new/er/a.csv", *before]


def test_links_and_devices_stay_what_they_are(tmp_path: Path) -> None:
    (tmp_path / "real.csv").write_bytes(b"old")
    (tmp_path / "link.csv").symlink_to("real.csv")
    write_files([(output(tmp_path / "link.csv"), b"1"), (output(Path("/dev/null")), b"2")])
    assert (tmp_path / "link.csv").is_symlink()
    assert (tmp_path / "real.csv").read_bytes() == b"1"
    assert Path("/dev/null").is_char_device()


@pytest.mark.parametrize(
    "form", ["urdf", "mjcf", "csv", "json", "ros2", "npz", "gltf", "svg", "ros2-package", "all"]
)
def test_every_form_makes_the_folders_on_the_way(
    form: str, srgc: Callable[..., Ran], tmp_path: Path
) -> None:
    folder = arm.flywheel(tmp_path / "out")
    place = tmp_path / "missing" / "folder" / "name"
    assert srgc("export", folder, "--to", form, "-o", place).status == 0
    assert place.is_dir() if form in ("ros2-package", "all") else place.stat().st_size > 0


def test_a_urdf_is_not_there_without_what_stands_beside_it(
    srgc: Callable[..., Ran], tmp_path: Path
) -> None:
    folder = arm.flywheel(tmp_path / "out")
    (tmp_path / "arm.joints.json").mkdir()
    assert srgc("export", folder, "--to", "urdf", "-o", tmp_path / "arm.urdf").status == 2
    assert not (tmp_path / "arm.urdf").exists()
