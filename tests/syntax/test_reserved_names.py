"""Names that other languages reserve, and those that are keywords of this one elsewhere."""

import keyword

import pytest

from lagc.diagnostics.faults import Source
from lagc.syntax import tree
from lagc.syntax.lalr_tables import tables
from lagc.syntax.parse import parse

# The words that the grammar needs where an operand may stand.
RESERVED = {"if", "not", "true", "false"}
NAMES = sorted(
    {
        *keyword.kwlist,
        *("auto", "break", "case", "char", "const", "default", "do", "double", "enum", "extern", "float"),
        *("goto", "int", "long", "register", "short", "signed", "sizeof", "static", "struct", "switch"),
        *("typedef", "union", "unsigned", "void", "volatile", "t", "q", "x", "I", "E", "N", "main", "self"),
        *("math", "sin", "time", "world", "der", "y_1", "_x", "X9"),
        *tables().keywords,
    }
    - RESERVED
)


@pytest.mark.parametrize("name", NAMES)
def test_names_that_others_reserve_are_legal(name: str) -> None:
    text = (
        f"model {name}\n"
        f"  parameter Length {name}(min = 0) = 1, other = {name} + 1;\n"
        f"  coordinate Angle {name}[3](start = {name}, each {name} = 2);\n"
        f"  body {name} = Particle(mass = {name}, {name} = {name}.{name}[{name}]*{name});\n"
        f"  force {name} = {name}*{{{name}, -{name}, ({name})}} at {name};\n"
        f"  torque {name} = {name}/2 on {name} from {name} unless {name}, {name};\n"
        f"  constraint {name}: {name} = {name};\n"
        f"  for {name} in 1:{name} loop point P[{name}] = {name}; end for;\n"
        f"  effect {name} potential V = if {name} > 1 then {name} else {name}; end {name};\n"
        f"  scene {name} uses {name}, {name} start {name} = {name}; end {name};\n"
        f"  output Real {name} = {name}(1) + 2*{name};\n"
        f"end {name};\n"
    )
    (model,) = parse(Source("x", text)).declarations
    assert isinstance(model, tree.ModelDeclaration) and model.name == name
    assert len(model.body) == 10


@pytest.mark.parametrize("name", sorted(set(NAMES) - {"end", "initial", "when"}))
def test_keywords_are_names_before_signs_of_names(name: str) -> None:
    text = f"model M initial x = 0; {name} = 1; {name}.y = 2; {name}[1] = 3; {name} + 1 = 4; end M;"
    (model,) = parse(Source("x", text)).declarations
    assert isinstance(model, tree.ModelDeclaration)
    (initial,) = model.body
    assert isinstance(initial, tree.Initial) and len(initial.conditions) == 5
