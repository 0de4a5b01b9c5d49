"""The process beside the server that does what takes long: whole checks, equations. The server may end it.

It reads a JSON object from each line of standard input, and writes one for it.
"""

import json
import os
import sys
from typing import Any

from lagc.compiler import checking, pipeline
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Refused, Source, as_json
from lagc.host.budgets import Limits

LIMIT = 20.0  # s for one answer


def answer(job: dict[str, Any]) -> dict[str, Any]:
    """Return the `faults` of a text, or the `equations` of a scene that a job asks for."""
    source, roots = Source(job["name"], job["text"]), tuple(job["roots"])
    try:
        with Limits(time=LIMIT):
            if job["do"] == "check":
                return {"faults": as_json(checking.check(source, Choice(), roots))}
            from lagc.reports.equations.write import write  # not needed to check

            compilation = pipeline.Compilation(source, Choice(job["model"], job["scene"]), roots)
            return {"equations": write(compilation.equations, job["format"], False)}
    except Refused as refused:
        return {"faults": as_json(refused.faults)}


def main() -> None:
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # nothing else reaches the server
    for line in sys.stdin.buffer:
        results.write(json.dumps(answer(json.loads(line))).encode() + b"\n")
        results.flush()


if __name__ == "__main__":
    main()
