"""Tasks in child processes, under limits: one that dies or hangs is reported, and the others go on."""

import multiprocessing
import os
import resource
import signal
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from typing import Any, TypeAlias

from lagc.cli.program import ALONE
from lagc.host.budgets import reserved

for each in ALONE:  # before NumPy is loaded
    os.environ.setdefault(each, "1")

SECONDS = 10  # of processor time for one command
WALL = 600.0  # s for one command, whatever it waits for: others may have the processors
MEMORY = 2 << 30  # bytes of address space
BATCH = 5  # tasks of one child

Do: TypeAlias = Callable[[Any, Callable[[str], None]], Any]


@dataclass
class Died:
    """What a task comes to that did not end: the last command, and how it ended."""

    command: str
    how: str


@dataclass
class _Child:
    process: Any
    pipe: Connection
    tasks: list[Any]
    done: int = 0
    command: str = ""
    since: float = field(default_factory=time.monotonic)


def run(do: Do, tasks: Iterable[Any], jobs: int, memory: int | None = MEMORY) -> Iterator[tuple[Any, Any]]:
    """(task, do(task, tell)) in the order in which they end; `Died` for a task whose process did.

    `memory` bounds the address space of each process, bytes.  `do` calls `tell(command)` before each
    command: the limits are those of one command.
    """
    waiting, left, children = iter(tasks), list[Any](), dict[Connection, _Child]()
    while True:
        while len(children) < jobs:
            batch = left or [task for _, task in zip(range(BATCH), waiting)]
            left = []
            if not batch:
                break
            child = _start(do, batch, memory)
            children[child.pipe] = child
        if not children:
            return
        for pipe in wait(list(children), timeout=1.0):
            assert isinstance(pipe, Connection)
            child = children[pipe]
            try:
                kind, what = pipe.recv()
            except (EOFError, OSError):
                child.process.join()
                del children[pipe]
                if child.done < len(child.tasks):
                    yield child.tasks[child.done], Died(child.command, _ending(child.process.exitcode))
                    left += child.tasks[child.done + 1 :]
                continue
            child.since = time.monotonic()
            if kind == "at":
                child.command = what
            else:
                child.done += 1
                yield child.tasks[child.done - 1], what
        for child in children.values():
            if time.monotonic() - child.since > WALL:
                child.process.kill()


def _start(do: Do, batch: list[Any], memory: int | None) -> _Child:
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_serve, args=(do, batch, memory, theirs, ours))
    process.start()
    theirs.close()
    return _Child(process, ours, batch)


def _serve(do: Do, batch: list[Any], memory: int | None, pipe: Connection, theirs: Connection) -> None:
    theirs.close()
    if memory is not None:
        most = memory + int(reserved())  # the parent has loaded what the tests before needed
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.signal(signal.SIGXCPU, signal.SIG_DFL)

    def tell(command: str) -> None:
        used = int(time.process_time())
        hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
        resource.setrlimit(resource.RLIMIT_CPU, (used + SECONDS + 1, hard))
        pipe.send(("at", command))

    with suppress(BrokenPipeError):  # the parent has enough
        for task in batch:
            pipe.send(("end", do(task, tell)))


def _ending(code: int | None) -> str:
    if code == -signal.SIGXCPU:
        return f"more than {SECONDS} s"
    if code == -signal.SIGKILL:
        return f"killed, or more than {WALL:g} s of waiting"
    return f"died of {signal.Signals(-code).name}" if code and code < 0 else f"ended with exit code {code}"
