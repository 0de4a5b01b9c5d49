"""The program `lagc`.  It handles signals before it loads anything else."""

import gc
import os

from lagc.cli.signals import SIGNALS

YOUNG = 50_000  # new objects before garbage collection; with Python's 700 it takes 2 % of a short run
# One thread for linear algebra, because the matrices are small.
ALONE = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def program() -> int:
    """Run the command line and return the exit code."""
    code = 0
    gc.set_threshold(YOUNG)
    for name in ALONE:
        os.environ.setdefault(name, "1")
    try:
        with SIGNALS:
            from lagc.cli.main import main

            code = main()
    except KeyboardInterrupt:  # a second signal
        SIGNALS.over = True
    gc.freeze()  # no garbage collection at exit: 5 % of a short run
    return SIGNALS.code or code
