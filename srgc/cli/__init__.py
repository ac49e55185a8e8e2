"""The command line: arguments, output and exit statuses, nothing else.

Exit statuses: 0, 1, 3 and 4 as each command documents; 2 wrong usage, 5 errors in the spec, 70
internal error, 130 interrupted, 141 nobody reads the output.  Functions import only what they need,
because Python prints a traceback for an interrupt that arrives before ``main`` handles interrupts.
"""

from __future__ import annotations

import sys


def run(arguments: list[str] | None = None) -> int:
    """Run a command line and return its exit status; no exception leaves this function."""
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

        # Most objects live until the process ends.  By default Python looks for garbage after every
        # 700 new objects, which takes time and finds little.
        gc.set_threshold(50_000, 20, 20)
        status = run()
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        status = 130
    sys.exit(status)
