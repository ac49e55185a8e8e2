"""The command ``completion``."""

from __future__ import annotations

import click

from srgc.cli.arguments import DocumentedCommand


@click.command(
    cls=DocumentedCommand,
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
    """Print the script with which a shell completes commands, options, files and names.

    It also completes specs, result folders, the tasks, grammars, workspaces and words of the spec
    on the command line, and codes of diagnostics.
    """
    click.echo(SCRIPTS[shell], nl=False)
    return 0


BASH = """\
_srgc_completion() {
    local kind value response rest=$COMP_LINE whole= i
    local -a words=(srgc)
    # Bash breaks words at = and :, too; here they are broken at blanks alone.
    rest=${rest#*"${COMP_WORDS[0]}"}
    for ((i = 1; i <= COMP_CWORD; i++)); do
        if [[ $rest == [[:blank:]]* ]]; then
            words+=("${COMP_WORDS[i]}")
            rest=${rest#"${rest%%[![:blank:]]*}"}
        else
            words[${#words[@]} - 1]+=${COMP_WORDS[i]}
        fi
        rest=${rest#"${COMP_WORDS[i]}"}
    done
    local typed=${words[${#words[@]} - 1]} last=${COMP_WORDS[COMP_CWORD]}
    # What is before the place from which readline replaces.
    [[ $last == [=:]* ]] && last=
    whole=${typed%"$last"}
    [[ $typed == --*=* ]] && whole=${whole#*=}
    response=$(IFS=$'\\n'; env COMP_WORDS="${words[*]}" COMP_CWORD=$((${#words[@]} - 1)) \\
        _SRGC_COMPLETE=bash_complete "$1")
    COMPREPLY=()
    while IFS=, read -r kind value; do
        case $kind in
            dir) compopt -o dirnames ;;
            file) compopt -o default ;;
            plain)
                # Between quotes as it is; elsewhere a blank needs a backslash.
                [[ $last == [\\"\\']* ]] || printf -v value %q "$value"
                COMPREPLY+=("${value#"$whole"}") ;;
        esac
    done <<< "$response"
    return 0
}

complete -o nosort -F _srgc_completion srgc
"""

ZSH = """\
#compdef srgc

_srgc_completion() {
    (( $+commands[srgc] )) || return 1
    local kind value note
    local -a answer plain described
    answer=("${(@f)$(env COMP_WORDS="${(j: :)words}" COMP_CWORD=$((CURRENT - 1)) \\
        _SRGC_COMPLETE=zsh_complete srgc)}")
    # Of --option=value the value alone is replaced.
    [[ $PREFIX == --*=* ]] && compset -P 1 '*='
    for kind value note in "${(@)answer}"; do
        case $kind in
            dir) _path_files -/ ;;
            file) _path_files -f ;;
            plain)
                if [[ $note == _ ]]; then
                    plain+=("$value")
                else
                    described+=("$value:$note")
                fi ;;
        esac
    done
    (( $#described )) && _describe -V unsorted described -U
    (( $#plain )) && compadd -U -i "$IPREFIX" -V unsorted -a plain
    (( compstate[nmatches] ))
}

if [[ $funcstack[1] == _srgc ]]; then
    # Of a folder in $fpath: this file is the function, at every call.
    _srgc_completion "$@"
else
    compdef _srgc_completion srgc
fi
"""

FISH = """\
function _srgc_completion
    set -l typed (commandline -ct)
    set -l line (commandline -cp | string collect)
    # Fish wants whole words: of --option=value the option, too.
    set -l option (string match -r -- '^--[^=]+=' $typed)
    for each in (env _SRGC_COMPLETE=fish_complete "COMP_WORDS=$line" "COMP_CWORD=$typed" srgc)
        set -l found (string split -m 1 , -- $each)
        switch $found[1]
            case dir
                __fish_complete_directories $found[2] | string replace -r -- '^' "$option"
            case file
                __fish_complete_path $found[2] | string replace -r -- '^' "$option"
            case plain
                printf '%s\\n' "$option$found[2]"
        end
    end
end

complete --command srgc --no-files --arguments "(_srgc_completion)"
# What fish itself expands.
complete --command srgc --force-files --condition "string match -qr -- '^[~\\$]' (commandline -ct)"
"""

SCRIPTS = {"bash": BASH, "zsh": ZSH, "fish": FISH}
"""Maps each shell to its script."""
