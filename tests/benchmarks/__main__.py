"""All benchmarks, one after the other: `python -m tests.benchmarks [NAME ...]`, or one with its options."""

from __future__ import annotations

import importlib
import sys
from itertools import takewhile

NAMES = ("startup", "sine_cosine", "chain", "double_pendulum", "andrews", "accuracy", "growth")


def main() -> None:
    asked = list(takewhile(lambda word: not word.startswith("-"), sys.argv[1:]))
    del sys.argv[1 : 1 + len(asked)]  # the benchmarks read their own options
    for name in asked or NAMES:
        print(f"\n=== {name} ===\n")
        importlib.import_module(f"tests.benchmarks.{name}").main()


if __name__ == "__main__":
    main()
