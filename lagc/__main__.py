"""`python -m lagc` is `lagc`, in a process that ends as Python does: profilers see its end."""

import sys

from lagc.cli.program import program

sys.exit(program())
