"""`python -m lagc` is `lagc`."""

from lagc.cli.program import process

process()
