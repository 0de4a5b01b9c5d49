"""The peers' figures, measured in the same run on the same machine.

The peer harness is a folder of scripts outside this project (`worker_a.py`, `case_c_workprec.py`).
Name it, and a Python that has the peers installed, with

    LAGC_PEERS=DIR LAGC_PEERS_PYTHON=PYTHON python -m tests.benchmarks.double_pendulum

Without them the tables hold lagc's own rows only; nothing is filled in from memory.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any


def available() -> bool:
    return "LAGC_PEERS" in os.environ


def _run(script: str, *arguments: str, limit: float) -> dict[str, Any]:
    """The last line of JSON that a script prints, or `note`: why there is none."""
    done = _finished(script, *arguments, limit=limit)
    if done is None:
        return {"note": f"gave up after {limit:g} s"}
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if not lines:
        why = done.stderr.strip().splitlines()[-1:] or ["no answer"]
        return {"note": why[0][:60]}
    result: dict[str, Any] = json.loads(lines[-1])
    return result


def _finished(script: str, *arguments: str, limit: float) -> subprocess.CompletedProcess[str] | None:
    folder = Path(os.environ["LAGC_PEERS"])
    root = Path(tempfile.gettempdir()) / "lagc-peers"
    (root / "build").mkdir(parents=True, exist_ok=True)
    environment = dict(
        os.environ,
        PEERS_ROOT=str(root),
        PEERS_T0=repr(time.monotonic()),
        OMP_NUM_THREADS="1",
        OPENBLAS_NUM_THREADS="1",
    )
    words = [os.environ.get("LAGC_PEERS_PYTHON", sys.executable), str(folder / script), *arguments]
    try:
        return subprocess.run(words, capture_output=True, text=True, env=environment, timeout=limit)
    except subprocess.TimeoutExpired:
        return None


def chain(peer: str, n: int, limit: float = 100.0) -> dict[str, Any] | None:
    """Planar chain of n links, cold process: {"t_cold": s, "t_rhs": s, "ops": int, ...}."""
    return _run("worker_a.py", peer, str(n), limit=limit) if available() else None


def balls(n: int, limit: float = 100.0) -> dict[str, tuple[float, int | None]]:
    """Chain of n boxes on ball joints: first word of a peer's name -> seconds a call, operations."""
    done = _finished("case_b_forward.py", "--n", str(n), limit=limit) if available() else None
    rows = [line.split("|") for line in done.stdout.splitlines()] if done else []
    found = {}
    for _, name, size, seconds, _, operations, *_ in (row for row in rows if len(row) > 6):
        if size.strip() == str(n) and "failed" not in seconds:
            count = operations.strip()
            found[name.split()[0]] = 1e-6 * float(seconds), int(count) if count.isdigit() else None
    return found


def work_precision(peer: str, limit: float = 150.0) -> dict[str, Any] | None:
    """Double pendulum over 10 s: {"runs": [{"tol", "err", "t", "nfev"}, ...]}."""
    return _run("case_c_workprec.py", "--worker", peer, limit=limit) if available() else None
