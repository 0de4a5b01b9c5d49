"""The long trial: `python -m tests.fuzz [COUNT] [FIRST SEED]`, 10,000 mutated models where nothing is said.

Prints what became of them; every text that made lagc stumble is written to the current folder.
"""

from __future__ import annotations

import collections
import multiprocessing
import sys
import traceback
from pathlib import Path

from tests.fuzz.mutations import library, mutated
from tests.fuzz.trial import bound_memory, trial

TEXTS = library()


def attempt(seed: int) -> tuple[int, str, str]:
    try:
        return seed, trial(mutated(TEXTS, seed)), ""
    except BaseException:
        return seed, "STUMBLED", traceback.format_exc()


def main() -> int:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    outcomes: collections.Counter[str] = collections.Counter()
    with multiprocessing.Pool(initializer=bound_memory) as pool:
        for seed, outcome, trace in pool.imap_unordered(attempt, range(first, first + count), chunksize=20):
            outcomes[outcome] += 1
            if trace:
                name = f"stumbled_{seed}.lag"
                Path(name).write_text(mutated(TEXTS, seed), encoding="utf-8")
                print(f"seed {seed}, see {name}: {trace}", flush=True)
    print(", ".join(f"{n} {outcome}" for outcome, n in sorted(outcomes.items())))
    return 1 if outcomes["STUMBLED"] else 0


if __name__ == "__main__":
    sys.exit(main())
