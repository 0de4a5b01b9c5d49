"""A process for each tool: a tool that hangs or crashes ends its own process, and its messages go nowhere."""

from __future__ import annotations

import multiprocessing
import os
from contextlib import suppress
from multiprocessing.connection import Connection
from time import process_time
from typing import Any

from lagc.study.probe import Array
from tools.benchmarks.tools import Task, Tool, Without

WAIT = 20.0  # s of wall time for an answer, without the runs that are asked for


class Unable(Exception):
    """No answer: `over` if the tool cannot be asked again for this problem."""

    def __init__(self, reason: str, over: bool = False):
        super().__init__(reason)
        self.over = over


def _serve(pipe: Connection, tool: Tool, task: Task) -> None:
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    began, run = process_time(), None
    while True:
        tolerance, repeats = pipe.recv()
        try:
            run = run or tool.make(task)
            values, seconds = run(tolerance, repeats)
            answer: tuple[Any, ...] = (values, seconds, process_time() - began)
        except ImportError as error:
            answer = (f"not installed: {error.name or error}", True)
        except Without as reason:
            answer = (str(reason), True)
        except Exception as error:
            words = str(error).strip().splitlines() or [type(error).__name__]
            answer = (words[-1][:100], False)
        pipe.send(answer)


class Worker:
    """The process of a tool for one problem; it is made again after it has hung or crashed."""

    def __init__(self, tool: Tool, task: Task):
        self.tool, self.task = tool, task
        self.start()

    def start(self) -> None:
        context = multiprocessing.get_context("fork")
        self.pipe, far = context.Pipe()
        self.process = context.Process(target=_serve, args=(far, self.tool, self.task), daemon=True)
        self.process.start()
        far.close()

    def ask(self, tolerance: float, repeats: int, expected: float = 0.0) -> tuple[Array, float, float]:
        """The states, the CPU time of a run in s, and that since the tool was begun.  Raises Unable."""
        try:
            self.pipe.send((tolerance, repeats))
            answer: Any = self.pipe.recv() if self.pipe.poll(WAIT + 10.0 * expected) else "no result"
        except (EOFError, OSError):
            answer = "it crashed"
        if isinstance(answer, str):
            self.end()
            self.start()
            raise Unable(answer)
        if len(answer) == 2:
            raise Unable(*answer)
        values, seconds, ready = answer
        return values, seconds, ready

    def end(self) -> None:
        with suppress(OSError):
            self.process.kill()
        self.process.join()
        self.pipe.close()
