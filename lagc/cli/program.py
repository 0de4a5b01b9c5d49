"""The program `lagc`.  Nothing else is loaded before it knows how it may be ended."""

from __future__ import annotations

from lagc.cli.signals import SIGNALS


def program() -> int:
    """Run the command line; the exit code."""
    code = 0
    with SIGNALS:
        from lagc.cli.main import main

        code = main()
    return SIGNALS.code or code
