"""Specs of several files: checked, synthesised, copied, resumed and verified elsewhere."""

from __future__ import annotations

import json
import os
import re
import shutil
from pathlib import Path

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.small_specs import SLIDER

pytestmark = pytest.mark.usefixtures("without_pictures")


MAP = '{"type": "FeatureCollection", "features": []}'
ITEMS = re.split(r"\n\n", SLIDER)
FILES = {
    "slide.srg": 'include "lib/family.srg";\ninclude "lib/rail.srg";\n\n' + ITEMS[-1],
    "lib/family.srg": '// the robots\r\ninclude "parts/modules.srg";\r\n' + "\n\n".join(ITEMS[1:3]),
    "lib/parts/modules.srg": "\ufeff" + ITEMS[0] + '\ninclude "../../lib/family2.srg";\n',
    "lib/family2.srg": "// größer\n",
    "lib/rail.srg": ITEMS[3] + "\n",
}


@pytest.fixture
def tree(tmp_path):
    """The slider in five files, one of them at the end of ``lib/parts/../..``."""
    assert len(ITEMS) == 5
    return write(tmp_path / "tree", FILES) / "slide.srg"


def write(top, files):
    for name, content in files.items():
        (top / name).parent.mkdir(parents=True, exist_ok=True)
        (top / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return top


def content_of(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def reason(folder, spec=None):
    report = verify_directory(folder, spec)
    assert report.outcome is Outcome.REFUTED
    return report.reason


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A result, made once."""
    from srgc.cli import run

    top = tmp_path_factory.mktemp("finished")
    path = write(top / "tree", FILES) / "slide.srg"
    assert run(["synth", str(path), "-o", str(top / "out"), "--json"]) == 0
    return top / "out"


@pytest.fixture
def out(finished, tmp_path):
    """A copy of the result in another place; the tree it was made of is not there."""
    return Path(shutil.copytree(finished, tmp_path / "elsewhere"))


def test_the_copy_holds_every_file_in_its_place(srgc, out, tree):
    files = {name: content.encode() for name, content in FILES.items()}
    assert content_of(out / "spec") == files
    certificate, design = result_files.read(out), result_files.read(out, "design.json")
    assert certificate["spec"] == design["spec"] == "slide.srg"
    digest = result_files.spec_digest(files)
    assert certificate["spec_sha256"] == design["spec_sha256"] == digest
    shutil.rmtree(tree.parent)
    assert srgc("verify", out).status == 0


def test_the_motion_is_that_of_the_spec_in_one_file(out, made):
    ours, theirs = result_files.read(out), result_files.read(made("slider") / "out")
    for key in ("word", "derivation", "parameters", "start", "inputs", "path"):
        assert ours[key] == theirs[key]


def test_the_spec_it_is_about_is_all_its_files(srgc, out, tree):
    assert srgc("verify", out, "--spec", tree).status == 0
    renamed = tree.rename(tree.with_name("other.srg"))
    assert srgc("verify", out, "--spec", renamed).status == 0
    for name in ("lib/family2.srg", "lib/parts/modules.srg", "lib/rail.srg"):
        path = tree.parent / name
        before = path.read_bytes()
        path.write_bytes(before + b" ")
        ran = srgc("verify", out, "--spec", renamed)
        assert ran.status == 1
        said = f"refuted: the certificate is not about {renamed}: the files differ in `{name}`"
        assert ran.out.splitlines()[0] == said
        path.unlink()
        assert srgc("verify", out, "--spec", renamed).status == 1
        path.write_bytes(before)
    assert srgc("verify", out, "--spec", renamed).status == 0
    renamed.write_text(FILES["slide.srg"] + "include 'more.srg';")
    (tree.parent / "more.srg").write_text("")
    assert srgc("verify", out, "--spec", renamed).status == 1


@pytest.mark.parametrize("name", list(FILES))
def test_an_altered_file_is_refused(out, name):
    path = out / "spec" / name
    path.write_bytes(path.read_bytes() + b"\n")
    assert "the spec has been altered" in reason(out)


@pytest.mark.parametrize("name", list(FILES))
def test_a_missing_file_is_refused(out, name):
    (out / "spec" / name).unlink()
    assert re.search("missing|altered", reason(out))
    sign(out)
    assert re.search("missing|has errors", reason(out))


@pytest.mark.parametrize("name", ["more.srg", "lib/more.srg", "lib/parts/.hidden", "x/y/z"])
def test_a_file_more_is_refused(out, name):
    write(out / "spec", {name: ""})
    assert "the spec has been altered" in reason(out)
    sign(out)
    assert f"the spec does not include `{name}`" in reason(out)


def sign(out):
    """Make the certificate about whatever the folder holds."""
    digest = result_files.spec_digest(content_of(out / "spec"))
    result_files.alter(out, lambda c: c.update(spec_sha256=digest), sign=True)
    design = result_files.read(out, "design.json")
    result_files.write(out, {**design, "spec_sha256": digest}, "design.json")


def test_a_signed_change_is_judged_as_a_claim(out):
    path = out / "spec" / "lib" / "rail.srg"
    path.write_text(path.read_text().replace("target T box [2, 2.5]", "target T box [3, 3.5]"))
    sign(out)
    assert verify_directory(out).outcome is Outcome.REFUTED
    path.write_text(FILES["lib/rail.srg"] + "// a comment")
    sign(out)
    assert verify_directory(out).outcome is Outcome.VALID


@pytest.mark.parametrize(
    "spec", ["lib/family.srg", "../spec/slide.srg", "./slide.srg", "/etc/hosts"]
)
def test_a_certificate_names_a_file_at_the_top_of_the_copy(out, spec):
    result_files.alter(out, lambda c: c.update(spec=spec), sign=True)
    assert f"the spec `{spec}` is missing" in reason(out)


@pytest.mark.parametrize("name", ["slide.srg", "lib/rail.srg", "lib", "."])
def test_links_are_no_copies(out, tmp_path, name):
    """Nothing outside the folder is ever read as part of a spec, the right bytes or not."""
    path = out / "spec" / name
    path.rename(tmp_path / "moved")
    path.symlink_to(tmp_path / "moved")
    assert "is not a plain file" in reason(out)


def test_a_copy_cannot_include_what_lies_outside(out, tmp_path):
    (out / "rail.srg").write_text(FILES["lib/rail.srg"])
    main = out / "spec" / "slide.srg"
    main.write_text(main.read_text().replace("lib/rail.srg", "../rail.srg"))
    (out / "spec" / "lib" / "rail.srg").unlink()
    sign(out)
    assert reason(out) == "the spec has errors"


def test_another_include_is_another_spec(srgc, out, tree):
    assert srgc("synth", tree, "-o", out, "--json").status == 0
    before = content_of(out)
    path = tree.parent / "lib" / "family2.srg"
    path.write_text("// greater\n")
    assert srgc("synth", tree, "-o", out).status == 0
    assert content_of(out.with_name(f"{out.name}.1")) == before
    assert content_of(out / "spec")["lib/family2.srg"] == b"// greater\n"
    # With --force nothing of the old copy is left, and an include that is gone is gone.
    modules = tree.parent / "lib" / "parts" / "modules.srg"
    modules.write_text(ITEMS[0])
    assert srgc("synth", tree, "-o", out, "--force", "--json").status == 0
    assert sorted(content_of(out / "spec")) == sorted(set(FILES) - {"lib/family2.srg"})
    assert srgc("verify", out, "--spec", tree).status == 0


def test_an_interrupted_run_goes_on(srgc, tree, tmp_path):
    out = tmp_path / "out"
    assert srgc("synth", tree, "-o", out, "--time-limit", "1e-6").status == 4
    # What a kill left of a write, and what somebody put there, is not taken for a part of the spec.
    write(out / "spec", {"lib/.rail.srg.part": b"works", "lib/notes.txt": b"mine"})
    assert srgc("synth", tree, "-o", out, "--json").status == 0
    assert sorted(content_of(out / "spec")) == sorted(FILES)
    assert srgc("verify", out).status == 0


def test_maps_and_images_are_copied(srgc, tree, tmp_path):
    rail = tree.parent / "lib" / "rail.srg"
    text = FILES["lib/rail.srg"]
    rail.write_text(text.replace("plane xy;", 'plane xy; obstacles from "maps/hall.geojson";'))
    write(tree.parent, {"lib/maps/hall.geojson": MAP})
    ran = srgc("check", tree)
    assert (ran.status, ran.out.count("error[")) == (0, 0)
    from grammar_lang.load import load
    from solvers.verifier.claims.spec_copy import files_of

    program = load(tree).program
    assert sorted(files_of(program.sources)) == sorted([*FILES, "lib/maps/hall.geojson"])


def test_one_file_under_two_names_cannot_be_copied(srgc, tree, tmp_path):
    (tree.parent / "link.srg").symlink_to("lib/rail.srg")
    tree.write_text(FILES["slide.srg"].replace('rail.srg";', 'rail.srg"; include "link.srg";'))
    assert srgc("check", tree).status == 0
    ran = srgc("synth", tree, "-o", tmp_path / "out")
    assert (ran.status, ran.out) == (2, "")
    assert "`link.srg` and `lib/rail.srg` are one file" in ran.err
    assert not (tmp_path / "out").exists()


def test_a_link_under_one_name_is_copied_as_a_file(srgc, tree, tmp_path):
    (tree.parent / "link.srg").symlink_to("lib/rail.srg")
    tree.write_text(FILES["slide.srg"].replace("lib/rail.srg", "link.srg"))
    assert srgc("synth", tree, "-o", tmp_path / "out", "--json").status == 0
    assert not (tmp_path / "out" / "spec" / "link.srg").is_symlink()
    assert srgc("verify", tmp_path / "out", "--spec", tree).status == 0


# --- check ---------------------------------------------------------------------------------------


def test_check_names_the_files(srgc, tree, monkeypatch):
    write(tree.parent, {"lib/rail.srg": FILES["lib/rail.srg"].replace("0.2] m", "0.2] kg")})
    monkeypatch.chdir(tree.parent.parent)
    ran = srgc("check", "tree/slide.srg")
    assert ran.status == 1
    places = re.findall(r"^(\S+):\d+:\d+: error", ran.out, re.MULTILINE)
    assert places
    assert set(places) == {"tree/lib/rail.srg"}
    found = json.loads(srgc("check", "--json", "tree/slide.srg").out)
    assert {record["file"] for record in found} == {"tree/lib/rail.srg"}
    monkeypatch.chdir(tree.parent / "lib")
    found = json.loads(srgc("check", "--json", "../slide.srg").out)
    assert {record["file"] for record in found} == {"../lib/rail.srg"}


def test_check_of_a_file_and_of_one_it_includes(srgc, tree):
    ran = srgc("check", tree, tree.parent / "lib" / "rail.srg")
    assert ran.status == 0
    assert "2 files without errors" in ran.out
    # What lies above the folder of the file on the command line is outside its tree.
    ran = srgc("check", tree, tree.parent / "lib" / "parts" / "modules.srg")
    assert ran.status == 1
    assert ran.out.count("error[SRG0108]") == ran.out.count("error[") == 1


def test_other_commands_read_includes(srgc, tree):
    assert srgc("words", tree).out == "B eps P eps M eps EN\n"
    assert srgc("accepts", tree, "--", "B").status == 1
    (tree.parent / "lib" / "rail.srg").unlink()
    ran = srgc("words", tree)
    assert (ran.status, ran.out) == (5, "")
    assert "error[SRG0109]: cannot read `lib/rail.srg`" in ran.err


def test_a_name_that_is_no_text(srgc, tmp_path):
    path = Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff.srg"))
    path.write_text(SLIDER)
    assert srgc("check", path).status == 0
    ran = srgc("synth", path, "-o", tmp_path / "out")
    assert (ran.status, ran.out) == (2, "")
    assert "UTF-8" in ran.err
    path.write_text("module")
    assert srgc("check", path).status == 1
    assert srgc("check", path, "--json").status == 1


def test_a_library_need_not_be_used_up(srgc, tmp_path):
    (tmp_path / "parts.srg").write_text(
        "module B { role base; }\nmodule L { role link; }\nedge e;\n"
    )
    main = tmp_path / "main.srg"
    main.write_text(
        'include "parts.srg";\nmodule M { role link; }\ngrammar G { start N; b: N -> B; }\n'
    )
    found = json.loads(srgc("check", main, "--json").out)
    assert [e["message"] for e in found if e["code"] == "SRG0403"] == [
        "module `M` is used in no production"
    ]
