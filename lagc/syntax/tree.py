"""The syntax tree: the content of a `.lag` text before names are looked up.

Every node has the `span` of its text.  Sequences are tuples, and `None` means "not written".  Nodes are
compared by their fields, spans included, and never changed (`lagc.base.records.replace` makes changed
copies).
"""

from __future__ import annotations

from typing import TypeAlias

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Source, Span

# -- expressions ------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Number:
    value: float
    text: str  # as written, for the formatter
    span: Span


@dataclass(frozen=True, slots=True)
class Boolean:
    value: bool
    span: Span


@dataclass(frozen=True, slots=True)
class String:
    value: str
    span: Span


@dataclass(frozen=True, slots=True)
class Unit:
    """The text between brackets, `kg.m2`; its meaning is looked up later."""

    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number or vector literal with its unit: `0.5 [m]`, `{1, 0, 0} [rad/s]`."""

    value: Expression
    unit: Unit
    span: Span


@dataclass(frozen=True, slots=True)
class Name:
    name: str
    span: Span


@dataclass(frozen=True, slots=True)
class Member:
    """`base.name`: a member of an instance, a unit vector of a frame, ..."""

    base: Expression
    name: str
    name_span: Span
    span: Span


@dataclass(frozen=True, slots=True)
class Index:
    """`base[i, j]`."""

    base: Expression
    indices: tuple[Expression, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a call or a modification: `name = value`, or a value (`name` None). `each` is Modelica's
    `each start = 0`.  `arguments` are nested modifications: `bob(m(min = 0) = 2 [kg])`. The modification
    `bob(m = 2 [kg])` without a value parses as a call, with `name` None."""

    name: str | None
    name_span: Span | None
    value: Expression | None
    span: Span
    each: bool = False
    arguments: tuple[Argument, ...] = ()


@dataclass(frozen=True, slots=True)
class Call:
    function: Expression  # a Name or a Member
    arguments: tuple[Argument, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Unary:
    op: str  # "-", "+", "not"
    operand: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Binary:
    """op is one of + - * / ^ < <= > >= == <> and or."""

    op: str
    left: Expression
    right: Expression
    op_span: Span
    span: Span


@dataclass(frozen=True, slots=True)
class Conditional:
    """`if c then x elseif d then y else z`: branches are (condition, value) pairs."""

    branches: tuple[tuple[Expression, Expression], ...]
    otherwise: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Vector:
    """`{a, b, c}`; nested for a matrix."""

    elements: tuple[Expression, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Family:
    """`{x[i]^2 for i in 1:n}`: one element for each value."""

    element: Expression
    variable: str
    range: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Range:
    """`1:n` or `1:2:n`."""

    start: Expression
    step: Expression | None
    stop: Expression
    span: Span


Literal: TypeAlias = Number | Boolean | String | Quantity
Path: TypeAlias = Name | Member | Index | Call
Expression: TypeAlias = Literal | Path | Unary | Binary | Conditional | Vector | Family | Range

# -- declarations -----------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class TypeName:
    """`Length`, `lib.Length`, or `Real[kg/m]`."""

    path: tuple[str, ...]
    unit: Unit | None
    span: Span


@dataclass(frozen=True, slots=True)
class TypeDeclaration:
    """`type Name = Real[unit] "..." ;`; `arguments` where `(displayUnit = ...)` is written."""

    name: str
    name_span: Span
    definition: TypeName
    description: str | None
    span: Span
    arguments: tuple[Argument, ...] = ()


@dataclass(frozen=True, slots=True)
class Declarator:
    """One name of a list: `th[n](each start = 0.1 [rad]) = value "description"`. `within` is the whole name
    if it belongs to an instance, `a.b[2].m`; only in scenes."""

    name: str
    name_span: Span
    dimensions: tuple[Expression, ...]
    arguments: tuple[Argument, ...]
    value: Expression | None
    description: str | None
    span: Span
    within: Expression | None = None


@dataclass(frozen=True, slots=True)
class Quantities:
    """`parameter Mass m = 1 [kg], n;`.  kind: constant parameter structural input coordinate speed
    discrete output."""

    kind: str
    type: TypeName | None  # None in a scene: `parameter l = 0.7 [m];`
    declarators: tuple[Declarator, ...]
    unless: tuple[Name, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class FunctionDeclaration:
    name: str
    name_span: Span
    parameters: tuple[tuple[TypeName, str, Span], ...]
    body: Expression
    description: str | None
    span: Span


@dataclass(frozen=True, slots=True)
class Construct:
    """`frame A = expr`, `point P[0] = expr`, `body b = Particle(...)`, `joint j = ...`,
    `potential V = ...`, `kinetic`, `lagrangian`, `dissipation`, `draw`. kind is that keyword; `index` the
    subscripts of an element, as in `point P[i]`."""

    kind: str
    name: str
    name_span: Span
    index: tuple[Expression, ...]
    value: Expression
    unless: tuple[Name, ...]
    description: str | None
    span: Span


@dataclass(frozen=True, slots=True)
class Placeholder:
    """`body b;`, `point P;`, `frame F;`: each instance of the model says which one it is."""

    kind: str
    name: str
    name_span: Span
    description: str | None
    span: Span


@dataclass(frozen=True, slots=True)
class Load:
    """`force F = vec [on body] at point [from other]` / `torque M = vec on body [from other]`. kind: force,
    torque.  `target` is the point of a force, the body of a torque."""

    kind: str
    name: str
    name_span: Span
    index: tuple[Expression, ...]
    value: Expression
    target: Expression
    reaction: Expression | None  # `from other`
    unless: tuple[Name, ...]
    description: str | None
    span: Span
    body: Expression | None = None  # that a force is `on`


@dataclass(frozen=True, slots=True)
class Constraint:
    """`constraint c: lhs = rhs (restitution = 0.8) unless e;`.  relation: = >= <=."""

    name: str
    name_span: Span
    index: tuple[Expression, ...]
    left: Expression
    relation: str
    relation_span: Span
    right: Expression
    arguments: tuple[Argument, ...]
    unless: tuple[Name, ...]
    description: str | None
    span: Span


@dataclass(frozen=True, slots=True)
class Condition:
    """One line of the `initial` section: `lhs = rhs;`."""

    left: Expression
    right: Expression
    relation_span: Span
    span: Span


@dataclass(frozen=True, slots=True)
class Initial:
    """`initial` ... up to the next section or declaration."""

    conditions: tuple[Condition, ...]
    unless: tuple[Name, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class ForLoop:
    variable: str
    range: Expression
    body: tuple[Declaration, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Statement:
    """One line of a `when`: a call, or what would be an equation."""

    action: Expression
    value: Expression | None
    span: Span


@dataclass(frozen=True, slots=True)
class When:
    """`when cond then statements end when;`."""

    condition: Expression
    statements: tuple[Statement, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Effect:
    """`effect name "..." [requires a, b;] [excludes c;] declarations end name;`
    or the short `effect gravity Gravity field(...); end gravity;`."""

    name: str
    name_span: Span
    description: str | None
    requires: tuple[Name, ...]
    excludes: tuple[Name, ...]
    body: tuple[Declaration, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Start:
    """`start theta = 30 [deg];` or `start der(theta) = 1;` in a scene."""

    target: Expression
    value: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Simulate:
    """`simulate(stop = 20 [s], accuracy = 1e-8);`"""

    arguments: tuple[Argument, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Scene:
    name: str
    name_span: Span
    description: str | None
    uses: tuple[Name, ...]
    body: tuple[Declaration, ...]  # Quantities (parameter), Start, Simulate
    span: Span


@dataclass(frozen=True, slots=True)
class Extends:
    path: tuple[str, ...]
    path_span: Span
    arguments: tuple[Argument, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Import:
    """`import a.b.C;` (alias C), `import X = a.b.C;`, `import a.b.*;`, `import "file.lag";`."""

    path: tuple[str, ...]
    file: str | None
    alias: str | None
    wildcard: bool
    span: Span


@dataclass(frozen=True, slots=True)
class Instance:
    """`Chain a(n = 3), b(n = 4);` and, inside an effect, `Gravity field(g = ...);`."""

    type: TypeName
    declarators: tuple[Declarator, ...]
    unless: tuple[Name, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Annotation:
    arguments: tuple[Argument, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class ModelDeclaration:
    """`[partial] model Name "..." ... end Name;`"""

    name: str
    name_span: Span
    partial: bool
    description: str | None
    body: tuple[Declaration, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Package:
    name: str
    name_span: Span
    description: str | None
    body: tuple[Declaration, ...]
    span: Span


Declaration: TypeAlias = (
    TypeDeclaration | Quantities | FunctionDeclaration | Construct | Placeholder | Load | Constraint | Initial
    | ForLoop | When | Effect | Start | Simulate | Scene | Extends | Import | Instance | Annotation
    | ModelDeclaration | Package
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Tree:
    """A whole file."""

    source: Source
    declarations: tuple[Declaration, ...]
