"""Names of users become identifiers of C and Python."""

import keyword
import re
from pathlib import Path

import pytest

import lagc
from lagc.codegen.identifiers import (
    FAMILIES,
    HEADERS,
    RESERVED,
    Names,
    comment,
    identifier,
    is_reserved,
    local_names,
    prefix,
)
from lagc.compiler.pipeline import program
from lagc.compiler.stages import Choice, render
from lagc.diagnostics.faults import Source
from tests.codegen.programs import pendulum
from tests.codegen.tools import COMPILERS, call, present
from tests.interfaces import field

TRICKY = ["int", "lambda", "double", "main", "q", "t", "None", "I", "E", "x", "p", "a.b[2].m", "a_b_2_m",
          "x0", "t1",
          "der(theta)", "θ", "ω1", "__init__", "1st", "", "sin", "y0", "lagc_rhs",
          "pendulum_rhs", "PENDULUM_NQ"]  # fmt: skip


@pytest.mark.parametrize("name", TRICKY)
def test_identifier_is_one(name: str) -> None:
    found = identifier(name)
    assert found.isidentifier() and found.isascii() and "__" not in found and not found.startswith("_")
    assert not keyword.iskeyword(found) and found not in RESERVED


def test_every_keyword_of_python_is_reserved() -> None:
    assert set(keyword.kwlist) <= RESERVED


@pytest.mark.sample(2)
@pytest.mark.parametrize("compiler", COMPILERS)
def test_every_macro_of_the_headers_is_reserved(compiler: str, tmp_path: Path) -> None:
    if not present(compiler):
        pytest.skip(f"no {compiler}")
    (tmp_path / "headers.c").write_text("#include <stddef.h>\n#include <math.h>\n")
    done = call(*COMPILERS[compiler], "-dM", "-E", tmp_path / "headers.c")
    macros = [line.split()[1] for line in done.splitlines()]
    objects = [name for name in macros if "(" not in name and not name.startswith("_")]
    assert [name for name in objects if not is_reserved(name)] == []
    assert "INFINITY" in objects


def test_names_are_distinct_and_in_order() -> None:
    first, second = Names(), Names()
    given = [first.give(name) for name in TRICKY * 2]
    assert len(set(given)) == len(given)
    assert given == [second.give(name) for name in TRICKY * 2]


def test_paths_of_instances_keep_their_parts() -> None:
    names = Names()
    assert names.give("a.b[2].m") == "a_b_2_m"
    assert names.give("a.b_2.m") != "a_b_2_m"


def test_locals_never_hide_arrays_functions_or_temporaries() -> None:
    fields = tuple(field(name) for name in TRICKY)
    program = pendulum(parameters=fields)
    given = [local_names(program, ("cos",))["p", k] for k in range(len(fields))]
    assert not {"x", "p", "t", "q0", "cos", "x0", "t1"} & (set(given) - {"q"})
    assert not any(name.startswith(("lagc_", "pendulum_", "PENDULUM_")) for name in given)


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", ["size0", "c0", "t0"])
def test_entries_of_arrays_are_no_conditions(name: str) -> None:
    """A row with conditions, and sizes of states that its `reaches` use more than once."""
    text = f"""model M
      parameter Length {name} = 1 [m];
      coordinate Length x(start = 1 [m]), y, z(start = 2 [m]);
      body b = Particle(mass = 1 [kg], at = {{x, y, z}});
      constraint c: z = {name} + (if x^2 + y^2 > 0 then sqrt(x^2 + y^2) else 0);
      constraint d: x = {name} + (if y > 0 then y^2/(1 [m]) else 0);
    end M;"""
    program = lagc.loads(text).compile(backend="numpy").program
    names = local_names(program, ())
    assert any(array == "c" for array, _ in names)
    assert not [n for n in names.values() if re.fullmatch(r"[ct]\d+", n)]
    for function in program.functions.values():
        loaded = [names[o.payload] for o in function.operations if o.payload in names]
        assert len(set(loaded)) == len(loaded)


@pytest.mark.parametrize(
    "text", ["a */ b", "a /* b", "line\nbreak", "tail\\", "??/", "\u202e\u2066", "naïve θ²", "\x00\x1b[31m"]
)
def test_comments_cannot_end_or_hide(text: str) -> None:
    found = comment(text)
    assert found.isascii() and found.isprintable()
    assert "*/" not in found and "/*" not in found and "\\" not in found and "??" not in found


def test_comment_that_becomes_an_end_by_removal() -> None:
    assert "*/" not in comment("*\\/ **// */*/") and "/*" not in comment("/\\* //** /*/*")


@pytest.mark.parametrize(
    ("model", "expected"),
    [
        ("Pendulum", "pendulum"), ("Math", "math_model"), ("Or", "or_model"), ("Aux", "aux_model"),
        ("Ω", "omega"), ("FourBar2D", "four_bar2_d"),
    ],
)  # fmt: skip
def test_prefix(model: str, expected: str) -> None:
    assert prefix(model) == expected


def test_no_prefix_or_file_is_called_as_something_else() -> None:
    for word in RESERVED | HEADERS | FAMILIES:
        for model in (word, word.capitalize()):
            assert prefix(model) not in RESERVED | HEADERS | FAMILIES


@pytest.mark.parametrize("name", ["Or", "Time", "M", "Long" * 45])
def test_files_are_called_as_what_is_in_them(name: str) -> None:
    text = f"model {name} coordinate Length x; body b = Particle(mass = 1, at = {{x, 0, 0}}); end {name};"
    made = program(Source("m.lag", text), Choice())
    for file, code in render(made, "c").items():
        stem = file.removesuffix(".c").removesuffix(".h")
        assert f" {stem}_rhs(" in code and len(file) < 140
    assert [file.removesuffix(".py") for file in render(made, "numpy")] == [stem]


def test_a_name_whose_numbered_forms_are_all_reserved() -> None:
    names = Names(["M"])
    given = [names.give("M") for _ in range(3)]
    assert len({"M", *given}) == 4 and not any(is_reserved(name) for name in given)


@pytest.mark.parametrize("name", ["lagc_options", "lagc_", "LAGC_OK", "_lagc_work", "Lagc_H_"])
def test_no_name_is_of_the_support(name: str) -> None:
    """Its text is written with `lagc_`, which becomes the prefix of the model wherever it begins a name."""
    assert not re.match("lagc_", identifier(name), re.I) and not re.match("lagc_", prefix(name), re.I)
