"""`python -m tests.fmi [MODEL ...]`: FMPy validates and simulates FMUs of library models, FMI 3.0 and 2.0."""

import sys
import tempfile
from pathlib import Path

from tests.fmi.measured import MODELS, errors

LIMIT = 100.0  # s of wall time a run


def main(models: list[str]) -> int:
    print("| model | FMI | FMPy | Co-Simulation | Model Exchange |\n| --- | --- | --- | --- | --- |")
    faults = 0
    for model in models or MODELS:
        with tempfile.TemporaryDirectory() as folder:
            for row in errors(model, Path(folder), limit=LIMIT):
                said = "; ".join(row.problems) or "valid"
                faults += bool(row.problems)
                print(
                    f"| {model} | {row.version}.0 | {said} | {row.co:.0e} | {row.exchange:.0e} |", flush=True
                )
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
