"""The program `lagc`.  Nothing else is loaded before it knows how it may be ended."""

from __future__ import annotations

import gc

from lagc.cli.signals import SIGNALS

YOUNG = 50_000  # objects before circles are looked for; with Python's 700 that is 2 % of a short run


def program() -> int:
    """Run the command line; the exit code."""
    code = 0
    gc.set_threshold(YOUNG)
    try:
        with SIGNALS:
            from lagc.cli.main import main

            code = main()
    except KeyboardInterrupt:  # one more, before the end began
        SIGNALS.over = True
    gc.freeze()  # what ends with the process is not looked through once more: 5 % of a short run
    return SIGNALS.code or code
