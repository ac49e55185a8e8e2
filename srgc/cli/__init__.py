"""The command line: arguments, output and exit statuses, nothing else.

Exit statuses: 0, 1, 3 and 4 as each command says; 2 usage, 5 the spec has errors, 70 internal
error, 130 interrupted, 141 nobody reads the output.  Nothing is imported here but what a function
needs: until ``main`` has seen to it, an interrupt is a traceback of Python's.
"""

from __future__ import annotations

import sys


def run(arguments: list[str] | None = None) -> int:
    """Run a command line and give its exit status; no exception leaves this function."""
    from srgc.cli.command_table import run_command
    from srgc.cli.fault_report import guarded

    return guarded(lambda: run_command(arguments))


def main() -> None:
    """The entry point of the ``srgc`` command."""
    try:
        from srgc.interruption import watch

        watch()
        from srgc.terminal import escape_unencodable

        escape_unencodable()
        import gc

        # Most objects live to the end: to look for garbage among them after every 700 new ones,
        # which is Python's usual number, takes time and finds little.
        gc.set_threshold(50_000, 20, 20)
        status = run()
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        status = 130
    sys.exit(status)
