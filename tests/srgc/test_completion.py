"""The completion of shells: by their protocol, and in a real bash."""

from __future__ import annotations

import contextlib
import shutil
import subprocess
import sys

import pexpect
import pytest

from grammar_lang.diagnostics.diagnostic import Code
from srgc.cli import run
from srgc.cli.command_table import TABLE
from srgc.cli.completion import SCRIPTS
from tests.conftest import ROOT

SPEC = """\
include "more.srg";
// task Commented {
 task First { }
task Second{}
workspace Yard { }
grammar
  Late { }
"""
MORE = 'include "spec.srg";\ngrammar Family { }\n  grammar  Größe { }\nmodule task_like { }\n'


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder with specs and results, where the user is."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "specs").mkdir()
    (tmp_path / "spec.srg").write_text(SPEC, encoding="utf-8")
    (tmp_path / "more.srg").write_text(MORE, encoding="utf-8")
    shutil.copy(ROOT / "specs" / "planar_arm.srg", tmp_path / "specs")
    shutil.copy(ROOT / "specs" / "two_arm.srg", tmp_path / "specs")
    (tmp_path / "notes.txt").write_text("")
    for name, file in (("demo", "design.json"), ("cut", "journal.jsonl"), ("other", "a.txt")):
        (tmp_path / "out" / name).mkdir(parents=True)
        (tmp_path / "out" / name / file).write_text("{}")
    return tmp_path


@pytest.fixture
def complete(monkeypatch, capsys):
    """What a shell is offered after some words, the last of which is being typed."""

    def offered(*words, shell="bash"):
        quoted = " ".join(f"'{word}'" if " " in word or not word else word for word in words)
        monkeypatch.setenv("_SRGC_COMPLETE", f"{shell}_complete")
        monkeypatch.setenv("COMP_WORDS", f"srgc {quoted}")
        monkeypatch.setenv("COMP_CWORD", str(len(words)) if shell == "bash" else words[-1])
        capsys.readouterr()
        assert run([]) == 0
        out, err = capsys.readouterr()
        assert err == ""
        return [line.partition(",")[2] for line in out.splitlines() if line]

    return offered


def test_commands_and_options(complete):
    assert complete("") == [*TABLE]
    assert complete("l") == ["language", "landscape", "lsp"]
    assert {"--version", "--help"} <= set(complete("--"))
    assert {"--task", "--seed", "--quiet", "--json"} <= set(complete("synth", "--"))
    assert complete("verify", "--tr") == ["--trust"]
    assert complete("completion", "") == ["bash", "zsh", "fish"]


def test_specs(complete, place):
    assert complete("check", "") == [
        "more.srg", "spec.srg", "specs/planar_arm.srg", "specs/two_arm.srg",
    ]  # fmt: skip
    assert complete("check", "specs/pl") == ["specs/planar_arm.srg"]
    assert complete("check", "./sp") == ["spec.srg", "specs/planar_arm.srg", "specs/two_arm.srg"]
    whole = str(place / "specs" / "t")
    assert complete("synth", whole) == [f"{whole}wo_arm.srg"]
    # Where there is no spec, the shell completes files by itself.
    assert complete("check", "notes") == ["notes"]


def test_result_folders(complete, place):
    assert complete("verify", "") == ["out/cut", "out/demo"]
    assert complete("why", "out/d") == ["out/demo"]
    assert complete("compare", "out/demo", "") == ["out/cut", "out/demo"]
    assert complete("verify", "specs/") == ["specs/"]


def test_names_in_a_file_that_has_mistakes(complete, place):
    assert complete("synth", "spec.srg", "--task", "") == ["First", "Second"]
    assert complete("plan", "spec.srg", "--task", "S") == ["Second"]
    assert complete("words", "spec.srg", "--grammar", "") == ["Late", "Family", "Größe"]
    assert complete("graph", "spec.srg", "--workspace", "") == ["Yard"]
    assert complete("compare", "spec.srg", "F") == ["Family"]
    # No file yet, or none that can be read.
    assert complete("synth", "--task", "") == []
    assert complete("synth", "none.srg", "--task", "") == []
    assert complete("synth", "notes.txt", "--task", "") == []


def test_words_of_the_family(complete, place):
    arm = "specs/planar_arm.srg"
    assert complete("accepts", arm, "") == ["B"]
    assert complete("accepts", arm, "--", "B", "eps", "") == ["JO"]
    assert set(complete("accepts", arm, "--", "B", "eps", "JO", "eps", "")) == {"JO", "L", "EN"}
    assert complete("accepts", arm, "--", "EN", "") == []
    offered = complete("model", arm, "--word", "B eps JO eps L")
    assert 0 < len(offered) <= 20
    for word in offered:
        assert word.startswith("B eps JO eps L")
        assert run(["accepts", arm, "--", *word.split()]) == 0
    # None of a file with errors.
    assert complete("accepts", "spec.srg", "") == []


def test_codes(complete):
    assert complete("explain", "") == [code.value for code in Code]
    (code,) = complete("explain", [*Code][5].value.lower())
    assert code == [*Code][5].value
    assert code not in complete("explain", code, "")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_scripts(shell, capsys):
    assert run(["completion", shell]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert f"_SRGC_COMPLETE={shell}_complete" in out
    assert run(["completion", "tcsh"]) == 2


def test_an_unknown_shell_asks_for_nothing(monkeypatch, capsys):
    monkeypatch.setenv("_SRGC_COMPLETE", "tcsh_complete")
    assert run([]) == 1
    assert capsys.readouterr().out == ""


BASH = """\
eval "$(srgc completion bash)"
reply() {
    COMP_LINE="srgc $*" COMP_WORDS=(srgc "$@") COMP_CWORD=$# COMPREPLY=()
    _srgc_completion srgc
    echo "${COMPREPLY[@]}"
}
glued() {  # The line as it is typed, and the words that bash makes of it.
    COMP_LINE=$1; shift
    COMP_WORDS=(srgc "$@") COMP_CWORD=$# COMPREPLY=()
    _srgc_completion srgc
    echo "${COMPREPLY[@]}"
}
complete -p srgc
reply sy
reply synth specs/pl
reply synth specs/two_arm.srg --task ''
reply accepts specs/planar_arm.srg -- B eps ''
reply check my
reply check '"my'
reply synth 'my\\ arm,\\ 2.srg' --task ''
reply verify 'out/a\\ '
glued 'srgc synth specs/two_arm.srg --task=' synth specs/two_arm.srg --task =
glued 'srgc synth specs/planar_arm.srg --task=P' synth specs/planar_arm.srg --task = P
glued 'srgc check a:' check a :
glued 'true; srgc  check a:b.s' check a : b.s
glued 'srgc verify out/x --spec=a:' verify out/x --spec = a :
glued 'srgc verify out/x --spec="my' verify out/x --spec = '"my'
"""


def _awkward_names(place):
    """Files and folders whose names have blanks, commas, colons."""
    for name in ("my arm, 2.srg", "a:b.srg"):
        shutil.copy(place / "specs" / "planar_arm.srg", place / name)
    (place / "out" / "demo").rename(place / "out" / "a b")


def _binary(place):
    """A ``srgc`` of this checkout, as its console script is."""
    binary = place / "bin" / "srgc"
    binary.parent.mkdir()
    binary.write_text(
        f"#!{sys.executable}\nimport sys\nsys.path.insert(0, {str(ROOT)!r})\n"
        "from srgc.cli import main\nmain()\n"
    )
    binary.chmod(0o755)
    return binary


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
def test_in_a_real_bash(place):
    """With a ``srgc`` of this checkout, as its console script is."""
    _awkward_names(place)
    binary = _binary(place)
    finished = subprocess.run(
        ["bash", "--norc", "-c", BASH],
        cwd=place, capture_output=True, text=True, check=True, timeout=120,
        env={"PATH": f"{binary.parent}:/usr/bin:/bin", "HOME": str(place)},
    )  # fmt: skip
    registered, *replies = finished.stdout.splitlines()
    assert "-F _srgc_completion" in registered
    assert replies[:4] == ["synth", "specs/planar_arm.srg", "Tend", "JO"]
    # What is typed without quotes needs them for the blanks; between quotes it has them.
    assert replies[4:8] == [r"my\ arm\,\ 2.srg", "my arm, 2.srg", "PickAndPlace", r"out/a\ b"]
    # Bash breaks words at = and :, and replaces from there.
    assert replies[8:] == ["Tend", "PickAndPlace", "b.srg", "b.srg", "b.srg", "my arm, 2.srg"]


def _typed(shell, place, lines):
    """What a shell in a terminal makes of lines, with the script where a user has it."""
    home, said = place / "home", place / "said"
    script = home / {"zsh": "_srgc", "fish": ".config/fish/completions/srgc.fish"}[shell]
    script.parent.mkdir(parents=True, exist_ok=True)
    script.write_text(SCRIPTS[shell], encoding="utf-8")
    start = home / {"zsh": ".zshrc", "fish": ".config/fish/config.fish"}[shell]
    start.write_text({"zsh": ZSHRC, "fish": FISHRC}[shell])
    env = {
        "PATH": f"{_binary(place).parent}:/usr/bin:/bin", "HOME": str(home), "TERM": "dumb",
        "LC_ALL": "C.UTF-8", "SAID": str(said),
    }  # fmt: skip
    child = pexpect.spawn(shell, ["-i"], cwd=str(place), env=env, timeout=60, dimensions=(50, 200))
    answers = []
    try:
        child.expect_exact("READY")
        for line in lines:
            child.send(line + {"zsh": "\x07", "fish": "\t\x07"}[shell])
            for _ in range(60):
                with contextlib.suppress(pexpect.TIMEOUT):
                    child.read_nonblocking(4096, 1)
                if said.exists() and said.read_text(encoding="utf-8").endswith("\n"):
                    break
            answers.append(said.read_text(encoding="utf-8").strip())
            said.unlink()
    finally:
        child.close(force=True)
    return answers


ZSHRC = """\
PS1='READY '
fpath=(~ $fpath)
autoload -U compinit
compinit -u
say() { zle complete-word; print -r -- "$BUFFER" > $SAID; BUFFER= }
zle -N say
bindkey '^G' say
"""
FISHRC = """\
function fish_prompt; echo 'READY '; end
bind \\cg 'commandline > $SAID; commandline ""'
"""
TYPED = {
    "srgc sy": "srgc synth",
    "srgc check my": r"srgc check my\ arm,\ 2.srg",
    'srgc check "my': 'srgc check "my arm, 2.srg"',
    "srgc check a:": "srgc check a:b.srg",
    "srgc check ~/h": "srgc check ~/homely.srg",
    "srgc verify out/a": r"srgc verify out/a\ b",
    "srgc synth spec.srg --task F": "srgc synth spec.srg --task First",
    "srgc synth spec.srg --task=S": "srgc synth spec.srg --task=Second",
    "srgc verify out/x --spec=my": r"srgc verify out/x --spec=my\ arm,\ 2.srg",
}


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_in_a_real_terminal(shell, place):
    if shutil.which(shell) is None:
        pytest.skip(f"there is no {shell}")
    _awkward_names(place)
    (place / "home").mkdir()
    shutil.copy(place / "specs" / "two_arm.srg", place / "home" / "homely.srg")
    assert _typed(shell, place, TYPED) == [*TYPED.values()]
