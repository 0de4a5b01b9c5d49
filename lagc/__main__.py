"""`python -m lagc` is `lagc`."""

import sys

from lagc.cli.program import program

sys.exit(program())
