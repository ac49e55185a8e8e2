"""The command ``completion``."""

from __future__ import annotations

import click

from srgc.taught_command import TaughtCommand

BASH = """\
%(complete_func)s() {
    local kind value response typed="${COMP_WORDS[COMP_CWORD]}"
    response=$(IFS=$'\\n'; env COMP_WORDS="${COMP_WORDS[*]}" COMP_CWORD=$COMP_CWORD \\
        %(complete_var)s=bash_complete "$1")
    COMPREPLY=()
    while IFS=, read -r kind value; do
        case $kind in
            dir) compopt -o dirnames ;;
            file) compopt -o default ;;
            plain)
                # Between quotes as it is; elsewhere a blank needs a backslash.
                [[ $typed == [\\"\\']* ]] || printf -v value %%q "$value"
                COMPREPLY+=("$value") ;;
        esac
    done <<< "$response"
    return 0
}

complete -o nosort -F %(complete_func)s %(prog_name)s
"""
"""As click's own, which breaks names with blanks."""


@click.command(
    cls=TaughtCommand,
    examples=[
        "srgc completion bash",
        "srgc completion zsh",
        "srgc completion fish",
    ],
    reads_spec=False,
    read_on="docs/how-to/command-line.md, which says where each shell looks for it",
)
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> int:
    """Print the script that lets a shell complete commands, options, files and names.

    Beside the names of commands and options: specs, result folders, tasks, grammars, workspaces and
    words of the spec that is named before, and codes of findings.
    """
    from click.shell_completion import ShellComplete, get_completion_class

    from srgc.command_table import COMPLETE, cli

    kind = get_completion_class(shell)
    if kind is None:  # pragma: no cover (click has had all three since 8.0)
        raise click.UsageError(f"click completes nothing for {shell}")
    found = kind(cli, {}, "srgc", COMPLETE)
    # Not the class's own method, which starts bash for its version.
    text = BASH % found.source_vars() if shell == "bash" else ShellComplete.source(found)
    click.echo(text)
    return 0
