"""Faults of the syntax (LAG01xx)."""

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
    """Return an entry whose examples are placed at the end of a small model."""
    return Entry(title, explanation, _complete(wrong), _complete(right))


def _complete(lines: str) -> str:
    return _MODEL.format(lines="\n".join("  " + line for line in lines.splitlines()))


ENTRIES: dict[str, Entry] = {
    "LAG0101": _entry(
        "a character that the language does not use",
        "Names consist of the letters A-Z and a-z, digits and `_`, and do not begin with a digit. Texts "
        "stand between straight double quotes. Write Greek letters as words (`phi`), powers as `^2`, and "
        "degrees as `[deg]`.",
        "parameter Angle φ = 30 [deg];",
        "parameter Angle phi = 30 [deg];",
    ),
    "LAG0102": _entry(
        "a text that is not closed",
        'A text stands between double quotes on one line. Write a `"` inside a text as `\\"`.',
        'output Energy E = energy() "kinetic and potential;',
        'output Energy E = energy() "kinetic and potential";',
    ),
    "LAG0103": _entry(
        "a comment that is not closed",
        "A comment that begins with `/*` ends with the next `*/`. A comment that begins with `//` ends "
        "with its line.",
        "output Energy E = energy(); /* conserved",
        "output Energy E = energy(); /* conserved */",
    ),
    "LAG0104": _entry(
        "a unit that is not closed",
        "Write the unit of a number in brackets after it, on the same line: `9.81 [m/s2]`.",
        "parameter Acceleration g = 9.81 [m/s2;",
        "parameter Acceleration g = 9.81 [m/s2];",
    ),
    "LAG0105": _entry(
        "a number that cannot be read",
        "Write decimals with a point: `0.5`. The largest number is about 1.8e308.",
        "parameter Length d = 0,5 [m];",
        "parameter Length d = 0.5 [m];",
    ),
    "LAG0106": _entry(
        "nesting that is too deep",
        "Brackets, `if` expressions, signs and blocks can be nested 100 deep, and a name can have 100 "
        "parts. Give parts of a longer expression a name with `point`, `function` or `output`.",
        f"parameter Real x = {'(' * 101}1{')' * 101};",
        "parameter Real x = (1);",
    ),
    "LAG0110": _entry(
        "something that cannot stand here",
        "A declaration begins with a keyword, such as `parameter`, `coordinate` or `body`, or with the "
        "name of a model. It ends with `;`.",
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
        "`model`, `package`, `effect` and scenes with a body end with `end name;`. Loops end with `end "
        "for;`.",
        "effect gravity\n  Gravity field;\nscene lab uses gravity;",
        "effect gravity\n  Gravity field;\nend gravity;\nscene lab uses gravity;",
    ),
    "LAG0113": _entry(
        "an `end` with the wrong name",
        "`end` repeats the name of the block that it closes, so that a missing `end` is found at its place.",
        "effect gravity\n  Gravity field;\nend gravitation;\nscene lab uses gravity;",
        "effect gravity\n  Gravity field;\nend gravity;\nscene lab uses gravity;",
    ),
    "LAG0114": _entry(
        "brackets that do not match",
        "Every `(`, `[` and `{` is closed by its own `)`, `]` or `}` within the same declaration. Blocks "
        "have no braces: they end with `end name;`.",
        "point P = l*{sin(theta), 0, -cos(theta);",
        "point P = l*{sin(theta), 0, -cos(theta)};",
    ),
    "LAG0115": _entry(
        "a comparison instead of an equation",
        "A declaration and a constraint use a single `=`. A constraint can also be an inequality with "
        "`>=` or `<=`. `==` compares two values in a condition.",
        "parameter Length d == 0.1 [m];",
        "parameter Length d = 0.1 [m];",
    ),
    "LAG0116": _entry(
        "an equation instead of a comparison",
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
        "The unknowns are declared with `coordinate`. There is no equation section: lagc derives the "
        "equations of motion from bodies, constraints and forces. Other quantities begin with "
        "`parameter`, `constant`, `input` or `output`.",
        "const Length d = 0.1 [m];",
        "constant Length d = 0.1 [m];",
    ),
    "LAG0119": _entry(
        "an unknown keyword",
        "Keywords are written in lower case. A declaration that begins with another name is an instance "
        "of the model with that name, and an instance has no value.",
        "paramter Length d = 0.1 [m];",
        "parameter Length d = 0.1 [m];",
    ),
    "LAG0120": _entry(
        "a declaration in the wrong place",
        "`start` and `simulate` belong in a scene, `requires` and `excludes` in an effect, effects and "
        "scenes in a model, models and packages at the top of a file or in a package. A loop contains "
        "declarations with subscripts: frames, points, bodies, forces, constraints. Declare arrays of "
        "coordinates, parameters and outputs outside of the loop, and give their values with `{... for i "
        "in 1:n}`.",
        "start theta = 30 [deg];",
        "scene lab\n  start theta = 30 [deg];\nend lab;",
    ),
    "LAG0121": _entry(
        "a unit in the wrong place",
        "A unit stands in brackets after a number, after a vector in braces, or after `Real`.",
        "parameter Length d = 0.1 m;",
        "parameter Length d = 0.1 [m];",
    ),
    "LAG0122": _entry(
        "an equation outside the `initial` section",
        "lagc derives the equations of motion. Write an equation that holds during the whole motion as a "
        "`constraint`, and one that holds only at the initial time in the `initial` section.",
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
        "an extra `;`",
        "A `;` ends a declaration. Write none after the first line of a block, and none after `then` and "
        "`loop`.",
        "parameter Length d = 0.1 [m];;",
        "parameter Length d = 0.1 [m];",
    ),
    "LAG0125": _entry(
        "a description in the wrong place",
        "The description of a quantity follows its value, right before the `,` or the `;`. The "
        "description of a block follows its name.",
        'parameter Length d "width" = 0.1 [m];',
        'parameter Length d = 0.1 [m] "width";',
    ),
    "LAG0126": _entry(
        "a chain of powers or comparisons",
        "`a^b^c` and `a < b < c` mean different things in different languages. Write `a^(b^c)` or "
        "`(a^b)^c`, and `a < b and b < c`.",
        "parameter Real x = 2^3^2;",
        "parameter Real x = 2^(3^2);",
    ),
    "LAG0127": _entry(
        "a force or torque without its target",
        "A force acts `at` a point or a particle, a torque acts `on` a body.",
        "force pull = {1, 0, 0} [N];",
        "force pull = {1, 0, 0} [N] at bob;",
    ),
    "LAG0128": _entry(
        "a missing word",
        "Write `for i in 1:n loop ... end for;` and `if condition then value else other` with all their "
        "words. An `if` always has an `else`.",
        "output Real side = if theta > 0 then 1;",
        "output Real side = if theta > 0 then 1 else -1;",
    ),
    "LAG0129": _entry(
        "an incomplete constraint",
        "A constraint has a name and two sides: `constraint name: left = right;`. The name also gives its "
        "reaction: `reaction(name)`.",
        "constraint theta = 0;",
        "coordinate Angle phi;\nconstraint equal: theta + phi = 0;",
    ),
    "LAG0130": _entry(
        "a missing operator",
        "Write a product with `*`, and separate the names in a list by `,`.",
        "output Length x = l sin(theta);",
        "output Length x = l*sin(theta);",
    ),
    "LAG0131": _entry(
        "a missing value",
        "A value is missing after an operator, a `=` or a comma.",
        "parameter Length d = ;",
        "parameter Length d = 0.1 [m];",
    ),
    "LAG0132": _entry(
        "a missing name",
        "Every declaration has a name. Results, messages and other declarations use it.",
        "point = {0, 0, 1} [m];",
        "point P = {0, 0, 1} [m];",
    ),
    "LAG0133": _entry(
        "a quantity without a type or a name",
        "A quantity has a type, which gives its dimension, and a name: `parameter Length l`. Only a "
        "scene, which gives a parameter another value, leaves the type out.",
        "parameter d = 0.1;",
        "parameter Length d = 0.1;",
    ),
    "LAG0134": _entry(
        "a declared name that contains a point",
        "The name in a declaration is one word. Declare a part of an instance in the model of that "
        "instance. Change its value where the instance is declared, or in a scene.",
        "parameter Mass bob.m = 2 [kg];",
        "parameter Mass bob_m = 2 [kg];",
    ),
}
