"""Faults of the syntax: LAG01xx."""

from __future__ import annotations

from lagc.diagnostics.catalogue import Entry

_MODEL = """model Pendulum
  parameter Mass m = 1 [kg];
  parameter Length l = 0.5 [m];
  coordinate Angle theta(start = 60 [deg]);
  body bob = Particle(mass = m, at = l*{{sin(theta), 0, -cos(theta)}});
{lines}
end Pendulum;
"""


def _entry(title: str, explanation: str, wrong: str, right: str) -> Entry:
    """The lines stand at the end of a small model."""
    return Entry(title, explanation, _complete(wrong), _complete(right))


def _complete(lines: str) -> str:
    return _MODEL.format(lines="\n".join("  " + line for line in lines.splitlines()))


ENTRIES: dict[str, Entry] = {
    "LAG0101": _entry(
        "a sign that the language does not have",
        "Names are made of the letters A-Z and a-z, digits and `_`; they do not begin with a digit. "
        "Texts stand between straight double quotes. Letters of other alphabets, typographic quotes and "
        "dashes, and the signs for powers and degrees are written out.",
        "parameter Angle φ = 30 [deg];",
        "parameter Angle phi = 30 [deg];",
    ),
    "LAG0102": _entry(
        "a text that is not closed",
        'A text stands between double quotes, on one line. A `"` within it is written `\\"`.',
        'output Energy E = energy() "kinetic and potential;',
        'output Energy E = energy() "kinetic and potential";',
    ),
    "LAG0103": _entry(
        "a comment that is not closed",
        "A comment that begins with `/*` goes on up to the next `*/`; one that begins with `//` ends with "
        "its line.",
        "output Energy E = energy(); /* conserved",
        "output Energy E = energy(); /* conserved */",
    ),
    "LAG0104": _entry(
        "a unit that is not closed",
        "The unit of a number stands in brackets behind it, on the same line.",
        "parameter Acceleration g = 9.81 [m/s2;",
        "parameter Acceleration g = 9.81 [m/s2];",
    ),
    "LAG0105": _entry(
        "a number that cannot be read",
        "The decimals of a number stand behind a point. Numbers reach to about 1.8e308.",
        "parameter Length d = 0,5 [m];",
        "parameter Length d = 0.5 [m];",
    ),
    "LAG0106": _entry(
        "nested too deep",
        "Brackets, `if`s, signs and blocks may stand inside one another 100 deep; a name has at most 100 "
        "parts. Name the parts of a longer expression with `point`, `function` or `output`.",
        f"parameter Real x = {'(' * 101}1{')' * 101};",
        "parameter Real x = (1);",
    ),
    "LAG0110": _entry(
        "something that cannot stand here",
        "A declaration begins with a keyword, such as `parameter`, `coordinate` or `body`, or with "
        "the name of "
        "a model; it ends with `;`.",
        "parameter Length d = 1 [m] : 2;",
        "parameter Length d = 1 [m];",
    ),
    "LAG0111": _entry(
        "a missing `;`",
        "Every declaration ends with `;`, and so does the `end name` of a block.",
        "parameter Length d = 0.1 [m]\noutput Energy E = energy();",
        "parameter Length d = 0.1 [m];\noutput Energy E = energy();",
    ),
    "LAG0112": _entry(
        "a block that is not closed",
        "`model`, `package`, `effect` and scenes with a body end with `end name;`, loops with `end for;`.",
        "effect gravity\n  Gravity field;\nscene lab uses gravity;",
        "effect gravity\n  Gravity field;\nend gravity;\nscene lab uses gravity;",
    ),
    "LAG0113": _entry(
        "an `end` that names something else",
        "An `end` names the block that it closes, so that a forgotten one is found where it is missing.",
        "effect gravity\n  Gravity field;\nend gravitation;",
        "effect gravity\n  Gravity field;\nend gravity;",
    ),
    "LAG0114": _entry(
        "brackets that do not match",
        "Every `(`, `[` and `{` is closed by its own `)`, `]` and `}`, within one declaration. "
        "Blocks have no "
        "braces: they end with `end name;`.",
        "point P = l*{sin(theta), 0, -cos(theta);",
        "point P = l*{sin(theta), 0, -cos(theta)};",
    ),
    "LAG0115": _entry(
        "a comparison in place of an equation",
        "A declaration and a constraint have a single `=`; a constraint may also be an inequality, "
        "with `>=` or "
        "`<=`. `==` compares two values, in a condition.",
        "parameter Length d == 0.1 [m];",
        "parameter Length d = 0.1 [m];",
    ),
    "LAG0116": _entry(
        "an equation in place of a comparison",
        "A condition compares with `==`.",
        "output Real side = if theta = 0 then 1 else 2;",
        "output Real side = if theta == 0 then 1 else 2;",
    ),
    "LAG0117": _entry(
        "an operator of another language",
        "The operators are `+ - * / ^`, the comparisons `< <= > >= == <>`, and `and`, `or`, `not`.",
        "output Length x = l*sin(theta)**2;",
        "output Length x = l*sin(theta)^2;",
    ),
    "LAG0118": _entry(
        "a keyword of another language",
        "The unknowns are coordinates, and the equations of motion are derived: there is no place for them. "
        "A quantity says what it is: `parameter`, `constant`, `coordinate`, `input`, `output`.",
        "const Length d = 0.1 [m];",
        "constant Length d = 0.1 [m];",
    ),
    "LAG0119": _entry(
        "no keyword",
        "Keywords are written in small letters. A declaration that begins with another name is an "
        "instance of "
        "the model of that name, and has no value.",
        "paramter Length d = 0.1 [m];",
        "parameter Length d = 0.1 [m];",
    ),
    "LAG0120": _entry(
        "a declaration in the wrong place",
        "`start` and `simulate` stand in a scene, `requires` and `excludes` in an effect; effects "
        "and scenes in a "
        "model; models and packages at the top of a file or in a package. A loop holds what has subscripts: "
        "frames, points, bodies, forces, constraints and so on; an array of coordinates, "
        "parameters or outputs stands outside of it, with values by number, `{... for i in 1:n}`.",
        "start theta = 30 [deg];",
        "scene lab\n  start theta = 30 [deg];\nend lab;",
    ),
    "LAG0121": _entry(
        "a unit in the wrong place",
        "A unit stands in brackets behind a number, behind a vector in braces, or behind `Real`.",
        "parameter Length d = 0.1 m;",
        "parameter Length d = 0.1 [m];",
    ),
    "LAG0122": _entry(
        "an equation outside the `initial` section",
        "The laws of the motion are derived. An equation that the motion keeps to is a `constraint`; "
        "one that "
        "holds at the start only stands in the section `initial`.",
        "theta = 30 [deg];",
        "initial\n  theta = 30 [deg];",
    ),
    "LAG0123": _entry(
        "an argument without a name before its `=`",
        "An argument is a value, or `name = value`.",
        "output Real x = max(l/m = 3, 1);",
        "output Real x = max(3, 1);",
    ),
    "LAG0124": _entry(
        "a `;` too many",
        "A `;` ends a declaration. None stands after the first line of a block, nor after `then` and `loop`.",
        "parameter Length d = 0.1 [m];;",
        "parameter Length d = 0.1 [m];",
    ),
    "LAG0125": _entry(
        "a description in the wrong place",
        "The description of a quantity stands behind its value, right before the `,` or the `;`; "
        "that of a block "
        "behind its name.",
        'parameter Length d "width" = 0.1 [m];',
        'parameter Length d = 0.1 [m] "width";',
    ),
    "LAG0126": _entry(
        "a chain of powers or comparisons",
        "`a^b^c` and `a < b < c` mean different things in different languages, and nothing here.",
        "parameter Real x = 2^3^2;",
        "parameter Real x = 2^(3^2);",
    ),
    "LAG0127": _entry(
        "a load without its target",
        "A force acts `at` a point or a particle, a torque `on` a body.",
        "force pull = {1, 0, 0} [N];",
        "force pull = {1, 0, 0} [N] at bob;",
    ),
    "LAG0128": _entry(
        "a missing word",
        "`for i in 1:n loop ... end for;` and `if condition then value else other` are written with "
        "all their "
        "words; an `if` always has its `else`.",
        "output Real side = if theta > 0 then 1;",
        "output Real side = if theta > 0 then 1 else -1;",
    ),
    "LAG0129": _entry(
        "an incomplete constraint",
        "A constraint has a name and two sides: `constraint name: left = right;`. The name is that of its "
        "reaction, too: `reaction(name)`.",
        "constraint theta = 0;",
        "coordinate Angle phi;\nconstraint equal: theta + phi = 0;",
    ),
    "LAG0130": _entry(
        "a missing operator",
        "A product is written with `*`; names in a list stand apart by `,`.",
        "output Length x = l sin(theta);",
        "output Length x = l*sin(theta);",
    ),
    "LAG0131": _entry(
        "a missing value",
        "Between an operator, a `=` or a comma and what follows, a value is expected.",
        "parameter Length d = ;",
        "parameter Length d = 0.1 [m];",
    ),
    "LAG0132": _entry(
        "a missing name",
        "What is declared has a name, by which results, messages and other declarations speak of it.",
        "point = {0, 0, 1} [m];",
        "point P = {0, 0, 1} [m];",
    ),
    "LAG0133": _entry(
        "a quantity without its type or its name",
        "A quantity has a type, which gives its dimension, and a name: `parameter Length l`. Only in "
        "a scene, where "
        "a parameter is given another value, the type is left out.",
        "parameter d = 0.1;",
        "parameter Length d = 0.1;",
    ),
    "LAG0134": _entry(
        "a declared name with a point in it",
        "A name that is declared is one word. What is within an instance is declared in the instance's "
        "model; where the instance is declared, and in scenes, it can be given another value.",
        "parameter Mass bob.m = 2 [kg];",
        "parameter Mass bob_m = 2 [kg];",
    ),
}
