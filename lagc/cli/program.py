"""The program `lagc`.  It handles signals before it loads anything else."""

import atexit
import gc
import os

from lagc.cli.signals import SIGNALS

YOUNG = 500_000  # new objects before garbage collection; with Python's 700 it takes a tenth of a short run
# One thread for linear algebra, because the matrices are small.
ALONE = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def process() -> None:
    """Run the command line and end the process with its exit code."""
    code = program()
    # Objects are not taken down one by one, which is a tenth of a short run; all output is flushed.
    atexit._run_exitfuncs()
    os._exit(code)


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
    return SIGNALS.code or code
