"""The process beside the server that does what takes long: whole checks, equations. The server may end it.

It reads a JSON object from each line of standard input, and writes one for it.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from typing import Any

from lagc.compiler import checking, pipeline
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Fault, Refused, as_json
from lagc.editor.document import Document
from lagc.editor.fixes import fix
from lagc.host.budgets import Limits

LIMIT = 20.0  # s for one answer
Job = dict[str, Any]


def _faults_of(document: Document) -> list[Fault]:
    return checking.check(document.source, Choice(), document.roots)


def _check(document: Document, job: Job) -> Job:
    return {"faults": as_json(_faults_of(document))}


def _fix(document: Document, job: Job) -> Job:
    """Return the title and the edits of the fix of the fault with a code and a message."""
    said = job["code"], job["message"]
    faults = [fault for fault in _faults_of(document) if (fault.code, fault.message) == said]
    found = fix(document, faults[0], _faults_of) if faults else None
    if found is None:
        return {}
    return {"title": found.title, "edits": [[edit.start, edit.end, edit.text] for edit in found.edits]}


def _equations(document: Document, job: Job) -> Job:
    from lagc.reports.equations.write import write

    choice = Choice(job["model"], job["scene"])
    equations = pipeline.Compilation(document.source, choice, document.roots).equations
    return {"equations": write(equations, job["format"], False)}


TASKS: dict[str, Callable[[Document, Job], Job]] = {"check": _check, "fix": _fix, "equations": _equations}


def answer(job: Job) -> Job:
    """Do the task `do` of a job on its `text`.  Faults that prevent it are the answer."""
    document = Document(job["name"], job["text"], tuple(job["roots"]))
    try:
        with Limits(time=LIMIT):
            return TASKS[job["do"]](document, job)
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
