"""The results of a sweep: a row for each point, as a table, an array over the axes, or a file."""

from collections import Counter
from collections.abc import Mapping, Sequence
from importlib import import_module
from math import nan
from typing import Any

import numpy as np
import numpy.typing as npt

from lagc.base.text import json_text
from lagc.simulation.formats import Table, check_path, write, writing
from lagc.study.sweep.plan import Plan
from lagc.study.sweep.worker import FIRST, STATUSES, Record

NOT_RUN = "not run"
TEXTS = ("status", "code", "message")
NEEDS = {".csv": (), ".parquet": ("pyarrow",), ".nc": ("xarray", "scipy")}  # packages of a format

Array = npt.NDArray[np.float64]


class Sweep:
    """The runs of a sweep, in the order of the points, in SI units.

    `len(sweep)` is their number, `sweep["theta"]` an array over them: an axis, a column such as `max(theta)`,
    `t` (the last time), `estimated` (the estimated error), or `status`, `code` and `message`.  A run is ok,
    terminated, failed or refused; failed and refused ones have the code of a message and the reason.  An
    interrupted sweep is not `complete`: runs that are missing are not run."""

    def __init__(
        self, plan: Plan, columns: Sequence[str], units: Mapping[str, str], metadata: Mapping[str, object]
    ):
        self.plan, self.columns, self.units = plan, tuple(columns), dict(units)
        self.metadata, self.stored = {**metadata, "units": self.units}, (*FIRST, *columns)
        self.rows: Array = np.full((len(plan), len(self.stored)), nan)
        self.reasons: dict[int, tuple[str, str]] = {}
        self.interrupted = False

    def __len__(self) -> int:
        return len(self.plan)

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {status}" for status, count in self.counts.items())
        return f"<{type(self).__name__} of {self.metadata['model']}: {len(self)} runs, {counts}>"

    def add(self, record: Record) -> int:
        """Fill in finished runs; return how many there are."""
        rows = np.frombuffer(record.rows).reshape(-1, self.rows.shape[1])
        self.rows[record.first : record.first + len(rows)] = rows
        self.reasons.update({record.first + k: reason for k, reason in record.reasons.items()})
        return len(rows)

    def gaps(self) -> list[tuple[int, int]]:
        """The ranges of points that are not run: first and last + 1 of each."""
        missing = np.concatenate(([False], np.isnan(self.rows[:, 0]), [False]))
        edges = np.flatnonzero(missing[1:] != missing[:-1]).tolist()
        return [*zip(edges[::2], edges[1::2])]

    @property
    def axes(self) -> tuple[str, ...]:
        return self.plan.names

    @property
    def counts(self) -> dict[str, int]:
        """How many runs have each status."""
        found = Counter(self.rows[~np.isnan(self.rows[:, 0]), 0].astype(int).tolist())
        counts = {status: found[k] for k, status in enumerate(STATUSES) if found[k]}
        missing = len(self) - sum(counts.values())
        return {**counts, NOT_RUN: missing} if missing else counts

    @property
    def complete(self) -> bool:
        return NOT_RUN not in self.counts

    def common_reasons(self) -> list[tuple[int, str, str]]:
        """The codes of failed and refused runs, the most frequent first: their number and the first
        message."""
        counts = Counter(code for code, _ in self.reasons.values() if code)
        first = {code: message for _, (code, message) in sorted(self.reasons.items(), reverse=True)}
        return [(count, code, first[code]) for code, count in counts.most_common()]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all columns, in the order of files."""
        return (*self.axes, *self.columns, *FIRST[1:], *TEXTS)

    def __getitem__(self, name: str) -> Any:
        if name in self.axes:
            place = self.axes.index(name)
            return np.fromiter((point[place] for point in self.plan.points(0, len(self))), float, len(self))
        if name in TEXTS:
            place = TEXTS.index(name)
            return np.array([self._texts(k)[place] for k in range(len(self))], dtype=object)
        if name in self.stored:
            return self.rows[:, self.stored.index(name)]
        from lagc.simulation.request import unknown

        fault = unknown(name, self.names, "column", "LAG0601")
        raise KeyError(fault.message + (f"; {fault.remedy}" if fault.remedy else ""))

    def _texts(self, k: int) -> tuple[str, str, str]:
        status = self.rows[k, 0]
        return (NOT_RUN if status != status else STATUSES[int(status)], *self.reasons.get(k, ("", "")))

    @property
    def frame(self) -> Any:
        """A pandas DataFrame of all runs, a column for each name, with the metadata in `attrs`.  Raises
        ImportError if pandas is not installed."""
        frame = _package("pandas").DataFrame({name: self[name] for name in self.names})
        frame.attrs.update(self.metadata)
        return frame

    @property
    def failed(self) -> Any:
        """The rows of `frame` whose run is failed or refused."""
        frame = self.frame
        return frame[frame["status"].isin(STATUSES[2:])]

    def to_xarray(self) -> Any:
        """Return an xarray Dataset over the axes: a dimension for each axis of a grid, `point` for axes that
        are zipped, `sample` for random ones.  Raises ImportError if xarray is not installed."""
        xarray = _package("xarray")
        dims, coords, shape = [], {}, []
        for block in self.plan.blocks:
            name = block.names[0] if len(block.names) == 1 and block.kind == "point" else block.kind
            dims.append(name)
            shape.append(len(block))
            attributes = [{"units": self.units[n]} if self.units.get(n) else {} for n in block.names]
            coords.update(
                {n: (name, np.array(c), a) for n, c, a in zip(block.names, block.columns, attributes)}
            )
        data = {}
        for name in self.names[len(self.axes) :]:
            own = {"units": self.units[name]} if self.units.get(name) else {}
            data[name] = (dims, self[name].reshape(shape), own)
        return xarray.Dataset(data, coords, {"lagc": json_text(self.metadata)})

    def save(self, path: str, units: bool = False) -> None:
        """Write all runs to a file; the ending gives the format: .csv, .parquet or .nc.

        `units` adds units to the header of a CSV file.  The metadata is in the file, or in `PATH.json` beside
        a CSV file.  Raises `lagc.simulation.formats.CannotSave` if the ending is unknown, a package is
        missing or the file cannot be written."""
        ending = check_path(path, NEEDS)
        with writing(path) as files:
            if ending == ".nc":
                found = self.to_xarray()
                data = found.assign({name: found[name].astype(str) for name in TEXTS}).to_netcdf()
                files.open(path).write(data)
            else:
                columns = {name: self[name] for name in self.names}
                write(Table(columns, {"t": "s", **self.units}, self.metadata, ""), files, path, ending, units)


def _package(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        raise ImportError(f"this table needs {name}: pip install {name}") from None
