"""All benchmarks, one after the other: `python -m tests.benchmarks [NAME ...]`."""

from __future__ import annotations

import importlib
import sys

NAMES = ("startup", "sine_cosine", "chain", "double_pendulum", "andrews", "accuracy")


def main(asked: list[str]) -> None:
    for name in asked or NAMES:
        print(f"\n=== {name} ===\n")
        module = importlib.import_module(f"tests.benchmarks.{name}")
        module.main()


if __name__ == "__main__":
    wanted = sys.argv[1:]
    del sys.argv[1:]  # the benchmarks read their own options
    main(wanted)
