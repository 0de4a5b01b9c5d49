"""The program `lagc`.  Nothing else is loaded before it knows how it may be ended."""

from __future__ import annotations

import gc
import os

from lagc.cli.signals import SIGNALS

YOUNG = 50_000  # objects before circles are looked for; with Python's 700 that is 2 % of a short run
ALONE = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")  # matrices are small: threads only wait for each other


def program() -> int:
    """Run the command line; the exit code."""
    code = 0
    gc.set_threshold(YOUNG)
    for name in ALONE:
        os.environ.setdefault(name, "1")
    try:
        with SIGNALS:
            from lagc.cli.main import main

            code = main()
    except KeyboardInterrupt:  # one more, before the end began
        SIGNALS.over = True
    gc.freeze()  # what ends with the process is not looked through once more: 5 % of a short run
    return SIGNALS.code or code
