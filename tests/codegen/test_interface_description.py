"""Texts that mirror the kernels agree with them: options, statuses, documentation."""

import re
from pathlib import Path
from typing import Any

import pytest

from lagc.base.records import replace
from lagc.codegen.c.emit import render
from lagc.codegen.identifiers import prefix
from lagc.codegen.kernel_compiler.library import library
from lagc.codegen.python.support import slices
from lagc.codegen.python.support.base import Options
from lagc.codegen.sizes import methods_of
from lagc.kernels import METHODS
from lagc.kernels.language import statuses
from lagc.lowering import jacobians
from lagc.semantics import model
from lagc.simulation import system
from tests.codegen.tools import of_model

DOCS = Path(__file__).parents[2] / "docs"


def test_options_are_those_of_the_kernels() -> None:
    names = [name for name, *_ in library("double").part("Options", {"NMODE": True}).members]
    assert sorted(names) == sorted(vars(Options()).keys() - {"watch"})
    bad = [part.name for part in library("double").constants("language/records", "Code")]
    assert [f"BAD_{name.upper()}" for name in slices.OPTIONS] == bad[: len(slices.OPTIONS)]


@pytest.mark.parametrize("levels", [model, system])
def test_levels_have_the_numbers_of_the_kernels(levels: Any) -> None:
    for part in library("double").constants("initialization/workspace", "Code"):
        assert getattr(levels, part.name) == int(part.text)


def test_the_header_numbers_statuses_and_methods() -> None:
    program = of_model("course/string_pendulum")
    header = next(text for name, text in render(program).items() if name.endswith(".h"))
    own = prefix(program.interface.model).upper()
    numbers = {name: int(k) for name, k in re.findall(rf"^  {own}_(\w+) = (\d+)", header, re.M)}
    expected = {name: value for name, value in vars(statuses).items() if name.isupper()}
    del expected["PARADOX"], expected["PENETRATION"]  # of contacts
    carried = methods_of(program.interface)
    expected.update({name.upper(): k for k, name in enumerate(METHODS) if name in carried})
    assert carried == METHODS[:-2] and not {"RADAU5", "TAYLOR", "PARADOX", "PENETRATION"} & {*numbers}
    assert {name: numbers[name] for name in expected} == expected


def test_docs_name_what_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    commands = (DOCS / "reference" / "commands.md").read_text(encoding="utf-8").replace("\\|", "|")
    assert f"--method {'|'.join(METHODS)}`" in commands
    generated = (DOCS / "reference" / "c-interface.md").read_text(encoding="utf-8")
    program = of_model("course/string_pendulum", derivatives=True)
    program = replace(program, interface=replace(program.interface, events=True, verified=True))
    written = render(program)
    header = next(text for name, text in written.items() if name.endswith(".h"))
    own = prefix(program.interface.model)
    names = set(re.findall(r"`(?:NAME)?_([a-z]\w*)", generated))
    assert len(names) > 10
    for name in names - {"by_time", "along", "hold", "gaps", "seated"}:  # no time, conditions, contacts
        assert re.search(rf"\b{own}_{name}\b", header), name
    monkeypatch.setattr(jacobians, "MOST", 0)
    large = render(of_model.__wrapped__("course/string_pendulum", derivatives=True))
    assert any(f" {own}_along(" in text for name, text in large.items() if name.endswith(".h"))
    owns = f"(?:{own.upper()}|STICK_SLIP_BELT|BOUNCING_BALL)"  # without, with discrete variables, contacts
    others = [render(of_model(name)) for name in ("classic/stick_slip_belt", "contact/bouncing_ball")]
    texts = [text for found in (written, *others) for text in found.values()]
    for name in re.findall(r"`NAME_([A-Z]\w*)", generated):
        assert any(re.search(rf"\b{owns}_{name}\b", text) for text in texts), name
    words = set(re.findall(r"`(?!NAME_)([A-Z]{2}[A-Z_]*)`", generated)) - {
        "NULL", "BOUNDS", "STACK", "PATTERNS", "PARAMETERS",
    }  # fmt: skip
    assert len(words) > 4 and words <= {name for name in vars(statuses) if name.isupper()}
