"""All hard cases, in the order of the table: the rows of `cases.toml`, then the files of references."""

import tomllib
from collections.abc import Mapping
from functools import partial
from importlib import import_module
from importlib.resources import files
from typing import Any

from lagc.study.hard.case import Case, Figure, line, read, values

_TABLE = tomllib.loads((files("lagc.study.hard") / "cases.toml").read_text("utf-8"))
HARD: dict[str, str] = _TABLE["published"]  # what is hard, by file of references
GROUP = f"{len(HARD)} problems with published or closed values"


def _of_row(row: Mapping[str, Any]) -> Case:
    """Return the case of a row; one with a `reference` has the model and the source of that file."""
    module, _, name = row["measure"].rpartition(".")
    measure = getattr(import_module(f"lagc.study.hard.{module}"), name)
    known = read(row["reference"]) if "reference" in row else {"citation": row["source"], **row}
    return Case(
        row["name"], row["title"], row["hard"], known["citation"], row["why"], known["model"], row["line"],
        tuple([Figure(**figure) for figure in row["figures"]]),
        partial(measure, *row["given"]) if "given" in row else measure,
    )  # fmt: skip


def _of_reference(name: str) -> Case:
    reference = read(name)
    return Case(
        name, f"{name.replace('_', ' ')}, values of the literature", HARD[name], reference["citation"],
        "A global error is asked a decade below the figure, or a local one far below it; the source states "
        f"its values so: {reference['stated_accuracy']}.",
        reference["model"], line(reference), (Figure("values, relative", reference["accuracy"]),),
        partial(values, name), GROUP,
    )  # fmt: skip


CASES = (*map(_of_row, _TABLE["case"]), *map(_of_reference, HARD))
