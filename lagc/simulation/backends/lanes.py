"""Runs of a model side by side in the lanes of vectors (`lagc.codegen.c.lanes`)."""

from __future__ import annotations

import ctypes
import sys
from array import array
from ctypes import byref, c_double, c_int, c_long, c_size_t
from platform import machine
from typing import TYPE_CHECKING, Any

from lagc.codegen.c.lanes import WIDTHS, lanes
from lagc.simulation.backends.compile import CannotCompile, library
from lagc.simulation.system import OK

if TYPE_CHECKING:
    from collections.abc import Mapping

    from lagc.simulation.backends.c import CModel


class Lanes:
    """The code of a model with lanes; `count` is their number, 0 without such a processor.  Raises
    CannotCompile."""

    def __init__(self, model: CModel, widths: Mapping[int, str] = WIDTHS):
        # Compilers for Windows do not align vectors of this length on the stack.
        has_vectors = machine() == "x86_64" and sys.platform != "win32"
        sources = lanes(model.interface, model.sources, widths) if has_vectors else None
        if sources is None:
            raise CannotCompile("there are no lanes for this model or this machine")
        self.library, self.prefix = library(sources), model.header[0]
        self.count: int = self._function("lanes")()
        self.room = ctypes.create_string_buffer(self._function("runs_size")())

    def _function(self, name: str) -> Any:
        return getattr(self.library, f"{self.prefix}_{name}")

    def record(
        self, p: array[float], x: array[float], count: int, options: Any, grid: Any, most: int
    ) -> dict[bytes, bytes]:
        """Make `count` runs from the arrays p and x, which have a row for each.  Return the states on the
        grid of those that went as asked in at most `most` attempts, by the bytes of both rows."""
        size = len(x) // count * len(grid)
        states, statuses = (c_double * (count * size))(), (c_int * count)()
        given = [(c_double * len(a)).from_buffer(a) for a in (p, x)]
        self._function("record_runs")(
            *given, c_long(count), byref(options), grid, c_size_t(len(grid)), states, statuses, c_long(most),
            self.room,
        )  # fmt: skip
        rows = [_rows(bytes(part), count) for part in (*given, states)]
        return {a + b: found for a, b, found, status in zip(*rows, statuses) if status == OK}


def _rows(data: bytes, count: int) -> list[bytes]:
    size = len(data) // count
    return [data[k * size : (k + 1) * size] for k in range(count)]
