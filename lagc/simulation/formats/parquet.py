"""Apache Parquet by pyarrow: a column a quantity, its unit in the field, the rest in the schema."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from lagc.base.printable import json_text
from lagc.host.atomic_write import Files

if TYPE_CHECKING:
    from lagc.simulation.solution import Solution


def write(solution: Solution, path: str, units: bool) -> None:
    """Units are in the fields, whatever `units` is."""
    pyarrow = importlib.import_module("pyarrow")
    parquet = importlib.import_module("pyarrow.parquet")

    known = {"time": "s", **solution.units}
    columns = {"time": solution.times, **{name: solution.column(name) for name in solution.columns}}
    fields = [pyarrow.field(n, pyarrow.float64(), metadata={"unit": known[n]}) for n in columns]
    schema = pyarrow.schema(fields, metadata={"lagc": json_text(solution.metadata())})
    with Files() as files:
        parquet.write_table(pyarrow.table(columns, schema=schema), files.open(path))
