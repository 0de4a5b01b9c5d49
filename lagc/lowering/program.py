"""Program: straight-line functions of binary operations in the order of execution.

This is the last form without a target. Every printer writes the same operations on the same operands in the
same order, so that all targets return the same bits.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from lagc.base.records import dataclass, field, replace
from lagc.kernels import IMPLICIT

FARTHEST = 1.7e308  # in tables: an end that no number reaches

if TYPE_CHECKING:
    from lagc.symbolic.leaves import Table

LEAVES = ("const", "load")


def operands() -> dict[str, int]:
    """Return the number of operands of each operation. `load` and `const` have none. Integer powers are
    products, x*x. Comparisons give truth values, which only select, and, or and not use."""
    from lagc.symbolic.operators import OPERATORS  # a run from the cache has no use for it

    arithmetic = {"const": 0, "load": 0, "neg": 1, "add": 2, "sub": 2, "mul": 2, "div": 2}
    return arithmetic | {op: row.arity for op, row in OPERATORS.items()}


@dataclass(frozen=True, slots=True)
class Operation:
    """Value number k of a function is the result of its operation number k. The payload of `const` is the
    float, that of `load` is (array, index) such as ("x", 3), that of a look-up is the `Table`."""

    op: str
    operands: tuple[int, ...] = ()
    payload: float | tuple[str, int] | Table | None = None


@dataclass(frozen=True, slots=True)
class Store:
    """array[index] = value."""

    array: str
    index: int
    value: int


@dataclass(frozen=True, slots=True)
class Run:
    """`count` repetitions of the same `period` operations on other operands. Stores are numbered after the
    operations."""

    first: int
    period: int
    count: int

    @property
    def end(self) -> int:
        return self.first + self.period * self.count


@dataclass(frozen=True, slots=True)
class Function:
    """A straight-line function. `comments` maps the position of an operation or store to the formula or
    source line that begins there. A long repetitive function has its leaves first and then `runs` (see
    `loop_rolling`)."""

    name: str
    inputs: tuple[str, ...]  # arrays read, in signature order: p t x e a lam c d w r s
    outputs: tuple[tuple[str, int], ...]  # (array, length), in signature order
    operations: tuple[Operation, ...]
    stores: tuple[Store, ...]
    description: str = ""
    comments: dict[int, str] = field(default_factory=dict)
    cleared: tuple[str, ...] = ()  # outputs that are zero but for what is stored
    runs: tuple[Run, ...] = ()

    @property
    def spelled(self) -> str:
        """The name in generated code; a function of modes has a suffix."""
        return f"{self.name}_on" if "modes" in self.inputs else self.name

    @property
    def cost(self) -> int:
        """Arithmetic operations and function calls (loads, constants, negations not counted)."""
        free = (*LEAVES, "neg")
        return sum(1 for o in self.operations if o.op not in free)

    @property
    def written(self) -> int:
        """The number of operations and stores as text: those of loops count once."""
        loops = sum([run.period for run in self.runs])
        return loops or len(self.operations) + len(self.stores)


def tables(functions: Iterable[Function]) -> list[Table]:
    """Return the tables that `functions` look numbers up in, in the order of their first use."""
    from lagc.symbolic.leaves import Table

    found = [o.payload for f in functions for o in f.operations if isinstance(o.payload, Table)]
    return list(dict.fromkeys(found))


def uses(function: Function) -> list[int]:
    """Return how often each value is used on the way to a store; 0: it need not be computed."""
    found = [0] * len(function.operations)
    for store in function.stores:
        found[store.value] += 1
    for k in range(len(found) - 1, -1, -1):
        if found[k]:
            for operand in function.operations[k].operands:
                found[operand] += 1
    return found


@dataclass(frozen=True, slots=True)
class Field:
    """A parameter or input as the generated code knows it."""

    name: str  # the user's
    value: float | None
    minimum: float
    maximum: float
    unit: str
    display_unit: str
    place: str  # "pendulum.lag:3"
    description: str
    whole: bool = False  # an Integer


@dataclass(frozen=True, slots=True)
class Clause:
    """A `when`: its condition as written, the names of its event, the reason if it ends the run (else None),
    the states that get new values, and whether such a run has failed."""

    words: str
    marks: tuple[str, ...]
    reason: str | None
    states: tuple[int, ...]
    fails: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        return self.marks or (f"when {self.words}",)


@dataclass(frozen=True, slots=True)
class Contact:
    """A one-sided constraint, or the friction of a constraint with `=` or a joint, as a run needs it."""

    name: str
    unit: str  # of its gap
    place: str  # "ball.lag:9"
    slips: int = 0  # slip rows
    poisson: bool = False  # its law of impact; else that of Newton
    impulse: int = -1  # index in x of the impulse of its last impact; -1: nothing asks for it
    normals: int = 0  # components of the normal force of a two-sided contact
    bounds_rate: bool = False  # its gap is one between velocities


@dataclass(frozen=True)
class Block:
    """Contacts of a system whose motion does not depend on others, as indices."""

    contacts: tuple[int, ...]
    coordinates: tuple[int, ...]
    speeds: tuple[int, ...]
    rows: tuple[int, ...]  # constraint equations
    timed: bool  # it depends on time itself


def _ranges(sizes: Mapping[str, int]) -> dict[str, range]:
    """Return the ranges of parts that follow each other."""
    found, first = dict[str, range](), 0
    for name, size in sizes.items():
        found[name] = range(first, first + size)
        first += size
    return found


@dataclass(frozen=True)
class Interface:
    """Facts of a compiled model for a run, a file header and a cache; plain data. State x = (q, v, z, d): nq
    coordinates, nv speeds, nz work integrals (0 or 1: z' = power), discrete variables. Multipliers: nc rows,
    the first nh holonomic. Parameter array p: `parameters`, then `inputs`, then what `bind` computes."""

    model: str
    scene: str
    source_name: str
    model_hash: str
    nq: int
    nv: int
    nz: int
    nc: int
    nh: int
    q_names: tuple[str, ...]
    v_names: tuple[str, ...]
    q_units: tuple[str, ...]
    v_units: tuple[str, ...]
    kinds: tuple[int, ...]  # of each coordinate and speed: those of one unit; 0 are the angles
    row_labels: tuple[str, ...]
    row_units: tuple[str, ...]
    quaternions: tuple[int, ...]  # first index in q of each unit quaternion
    parameters: tuple[Field, ...]
    inputs: tuple[Field, ...]
    outputs: tuple[Field, ...]
    rate_names: tuple[str, ...]  # rates that are stated and no speeds: further unknowns of the start
    rate_units: tuple[str, ...]
    massless: tuple[int, ...]  # speeds without inertia, as of filters and circuits
    start_levels: tuple[int, ...]  # of q, v and these rates: how firmly stated, from 0 (not) to 4 (fixed)
    start_places: tuple[str, ...]  # source line of each statement, or of the declaration
    row_places: tuple[str, ...]  # source line of each constraint equation
    initial_places: tuple[str, ...]  # and of each initial condition
    condition_ends: tuple[int, ...]  # where in J each condition's derivatives end
    condition_columns: tuple[int, ...]  # index in (q, v, stated rates) of each derivative
    solve: str  # "straight": rhs holds the LDL^T;  "looped": rhs = system + dense LDL^T of the support code
    work_size: int  # doubles of w that assemble/factor/solve use
    health: int  # numbers that rhs tells of its solve
    operations: int  # of one right-hand side
    written: int  # operations and stores of all functions as their text has them
    functions: tuple[str, ...]  # the names that exist
    effects: tuple[str, ...]
    simulate: dict[str, float]
    notes: tuple[str, ...]
    warnings: tuple[str, ...]  # what may not be meant as it is written
    dropped: tuple[str, ...]  # coordinates and speeds on which nothing depends
    relations: tuple[str, ...] = ()  # conditions that a motion may change: what changes, in words
    counted_relations: tuple[int, ...] = ()  # 1: at the edges of its mode, which counts, else at zero
    relations_aside: tuple[int, ...] = ()  # 1: clauses `when` alone ask for it
    whens: tuple[Clause, ...] = ()
    discretes: tuple[Field, ...] = ()  # variables that clauses `when` alone change: the last of x
    booleans: tuple[int, ...] = ()  # 1: a truth value, stored as 0 or 1
    features: int = 0  # terms that may be narrow
    enclosed: tuple[int, ...] = ()  # states of (q, v) that bounds in a box depend on
    contacts: tuple[Contact, ...] = ()  # the last of `discretes` and of `relations`
    blocks: tuple[Block, ...] = ()  # of contacts
    poles: int = 0  # divisors that may come near zero
    late_relations: int = 0  # those that accelerations or reactions decide, before those of contacts
    loading_rows: tuple[int, ...] = ()  # constraint equations whose multipliers loads depend on
    held_rows: tuple[int, ...] = ()  # of these, 1 where an actuator holds the equation
    pushed_contacts: tuple[int, ...] = ()  # contacts whose normal forces loads depend on
    servos: tuple[tuple[str, str], ...] = ()  # constraints that act through an actuator, and that
    curved_loads: bool = False  # these loads are not linear in these reactions
    timed_relations: int = 0  # the first ones, which time alone changes, when is known
    timed: bool = False  # the rates, or when they change, depend on time itself
    flowing: bool = False  # the rates do between changes
    doubtful: bool = (
        False  # kinetic energy that nothing keeps from being negative: free terms, products of inertia
    )
    driven: bool = False  # and so do constraints
    balance: str = "K + V"  # the energy of it, as it is written
    conservative: bool = False  # no action and no constraint does work, and all constraints are holonomic
    velocity_unknowns: int = 0  # velocities that are unknowns of the linear solve beside the speeds
    limits: tuple[Field, ...] = ()  # values made of parameters that have bounds
    preparation: int = 0  # operations of `bind`
    prepared: int = 0  # numbers that it makes
    read: tuple[int, ...] = ()  # the parameters that it reads: copies of them are the last of these
    part_ends: tuple[int, ...] = ()  # where in J those by sums too of each condition, then each sum, end
    part_columns: tuple[int, ...] = ()  # of an unknown, or behind these of a sum
    methods: tuple[str, ...] = ()  # of integration that generated code has; none: all that it can have
    events: bool = False  # generated code has functions for integrators of the caller
    verified: bool = False  # generated C has the run that returns its error
    series: tuple[int, int, int, int, int] = (0, 0, 0, 0, 0)  # see `lagc.lowering.series.counts`
    scales: dict[str, float] = field(default_factory=dict)  # that quantities are declared with
    # places of their entries
    derivatives: dict[str, tuple[tuple[int, int], ...]] = field(default_factory=dict)

    @property
    def state_names(self) -> tuple[str, ...]:
        """Return the names of (q, v)."""
        return (*self.q_names, *self.v_names)

    @property
    def state_units(self) -> tuple[str, ...]:
        return (*self.q_units, *self.v_units)

    @property
    def nx(self) -> int:
        """Return the size of x: the integrated states, then discrete variables."""
        return self.nq + self.nv + self.nz + len(self.discretes)

    @property
    def needs_consistency(self) -> bool:
        """Whether the start values alone need not be a consistent start."""
        return bool(self.condition_ends or self.quaternions)

    def condition_entries(self, k: int) -> range:
        """Return the places in J of the derivatives of condition k."""
        return range(self.condition_ends[k - 1] if k else 0, self.condition_ends[k])

    @property
    def differentiated(self) -> bool:
        return "stack" in self.functions

    @property
    def follows(self) -> bool:
        """Whether the functions of sensitivities exist."""
        return "tangent" in self.functions

    @property
    def stiff(self) -> bool:
        """Whether implicit methods can be carried: their functions exist, or contacts, which need none."""
        asked = bool(self.contacts) and not set(IMPLICIT).isdisjoint(self.methods)
        return asked or "residual" in self.functions

    @property
    def expands(self) -> bool:
        """Whether the functions of Taylor series exist."""
        return "series" in self.functions

    @property
    def groups(self) -> dict[str, range]:
        """The places in a direction of each group of variables that the stack is differentiated by."""
        sizes = {"time": 1, "state": self.nq + self.nv, "acceleration": self.nv + self.nc,
                 "parameter": len(self.parameters) + len(self.inputs)}  # fmt: skip
        return _ranges(sizes)

    @property
    def stack(self) -> dict[str, range]:
        """The rows of `derivatives` that belong to each part of what is differentiated."""
        sizes = {
            "qdot": self.nq, "inertia": self.nv, "force": self.nv, "row": self.nc,
            "condition": len(self.condition_ends), "start": self.nq + self.nv + len(self.rate_names),
            "output": len(self.outputs), "indicator": len(self.relations),
            "reinit": sum(len(clause.states) for clause in self.whens),
        }  # fmt: skip
        return _ranges(sizes)

    def drives(self, relation: int) -> bool:
        """Return whether the equations depend on relation `k`; an index beyond the relations is that of a
        clause `when`."""
        return relation < len(self.relations) and not self.relations_aside[relation]

    @property
    def noted(self) -> tuple[int, ...]:
        """The relations whose changes are events. Those that only clauses `when` use are not."""
        return tuple([k for k, aside in enumerate(self.relations_aside) if not aside])

    @property
    def angles(self) -> tuple[int, ...]:
        return tuple([i for i, unit in enumerate(self.q_units) if unit == "rad"])

    @property
    def start_units(self) -> tuple[int, ...]:
        """The unit of each unknown of the start, as its place in the list of those that occur."""
        units = [*self.state_units, *self.rate_units]
        known = list(dict.fromkeys(units))
        return tuple([known.index(unit) for unit in units])


@dataclass(frozen=True)
class Program:
    """The interface and its functions.

    (absent ones do not exist for the model):
      bind        (p)             -> prepared[]   what depends on parameters alone, behind which p goes on:
                                     values, then copies of the parameters that they are made of
      rhs         (p,t,x)         -> xdot[nx], lam[nc], health[]    "straight" solve only, not refined
      watch       (p,health)      -> health     the residual of that solution, from what follows the first two
      system      (p,t,x)         -> qdot[nq], M[nv*(nv+1)/2], r[nv], G[nc*nv], gamma[nc]
                                     M packed by rows of the lower triangle, r = tau - h,
                                     G dense by rows; not of large models that rhs solves
      forces      (p,t,x)         -> qdot[nq], r[nv + nc]   r as above, then gamma     nc > 0, no `system`
      assemble    (p,t,x)         -> w    KKT entries M and G into w       "straight" and nc > 0, or with
                                     derivatives
      factor      (w)             -> w, health[2]   L and D after the entries
      solve       (w,r)           -> s[nv+nc]   r = (r1, r2): M s1 - G^T s2 = r1, G s1 = r2
      refine      (w,r,s)         -> s          one step of iterative refinement of what solve gave
      rest        (w,r,s)         -> e[nv+nc]   what s leaves of r        in place of `refine`: no `system`
      displace    (p,t,x,d)       -> dq[nq]     dq = N(t,q) d      where N is not the identity
      position    (p,t,x)         -> phi[nh]
      velocity    (p,t,x)         -> psi[nc]    rates of all rows
      scales      (p,t,x)         -> s[nc]      size of each row's terms, for scaled residuals
      gamma_sizes (p,t,x)         -> s[nc]      size of the terms of each row's gamma
      gradient_sizes (p,t,x)      -> s[nc]      size of the terms of each row's gradient
      gradients   (p,t,x)         -> s[nc]      size of each row's gradient      nc > 0, no `system`
      reaches     (p,t,x,c)       -> s[nc+nh+nkind] change of each row, and of each holonomic row's rate,
                                     for states that change by the size c of their kind; then these,
                                     with those of what displacements are added to
      energies    (p,t,x)         -> e[3]       kinetic, potential, energy of the balance
      power       (p,t,x,a,lam)   -> e[1]       d(energy)/dt            where not identically zero
      outputs     (p,t,x,e,a,lam) -> y[ny]      e: of `energies`, where they are read
      start       (p)             -> x[nx]      start values and guesses
      conditions  (p,t,x)         -> c[n], J[], sizes[n]   of a consistent start: phi, psi, initial section,
                                     stated rates; J sparse by rows (`condition_ends`, `condition_columns`),
                                     where there are sums by their parts (`part_ends`, `part_columns`);
                                     `sizes` those of the terms
      limits      (p)             -> b[]   those of `limits`
      gaps        (p,t,x)         -> g[]    gap of each contact
      contact_rows (p,t,x,modes)  -> R[], u[], bias[]   gradient by v, rate, acceleration for v' = 0
      restitutions (p,t,x)        -> r[]    of each contact
      normals     (p,t,x,modes)   -> N[], bias[]  of two-sided contacts: slopes by a, lam and forces, rest
      frictions   (p,t,x,modes)   -> f[]    friction of slip and of sticking of each contact
      features    (p,t,x)         -> e[]    terms that may be narrow
      feature_bounds (p,box)      -> e[]    least and largest value of each, in a box
      poles       (p,t,x)         -> e[]    divisors that may come near zero
      pole_bounds (p,box)         -> e[]    least and largest value of each, in a box
    and with relations, where `rhs`, `system`, `assemble` and `power` are functions of (p,t,x,modes...):
      modes       (p,t,x)         -> modes[]   of the state: sign(e), floor(e), or the piece of a table
      indicators  (p,t,x,modes)   -> e[]    the event indicators
      own_modes   (p,t,x,modes)   -> e[]    the modes by the indicators
      indicator_rates (p,t,x,modes,d) -> e[] their rates, for rates of the state
      edges       (modes)         -> e[]    bounds of each counted indicator, in its mode
      slopes      (p,modes)       -> e[]    of those that time alone changes
      enclosure   (p,modes,box)   -> e[]    least and largest value of each other one, where time and states
                                            keep to a box (least ones, then largest)
      holds       (p,t,x,modes)   -> c[]    1 where the condition of a `when` holds
      reinit      (p,t,x)         -> r[]    the values that states take then, one clause after the other
      measures    (p)             -> s[], largest[]   stated rates; largest parameter of each of `start_units`
      stack       (p,t,x,a,lam)   -> s[]        where derivatives are asked for: what is differentiated
      by_time, by_state, by_acceleration, by_parameter   (p,t,x,a,lam) -> J[]   its derivatives, each at the
                                     (row, column) of `derivatives`; see `lagc.lowering.jacobians`;
                                     with relations, all of them of (p,t,x,modes,a,lam)
      series, series_next   of Taylor series, see `lagc.lowering.series`
      residual, newton, newton_column   of implicit methods, see `lagc.lowering.jacobians`
      along       (p,t,x,a,lam,d) -> s[]        in their place where they are very many: what the stack
                                     changes by with (t, x, a, lam, p) along d = (dt, dx, da, dlam, dp)
    health = (smallest pivot ratio |d_k|/|a_kk|, square of the relative residual, 0 of rhs, ...).
    """

    interface: Interface
    functions: dict[str, Function]

    def __repr__(self) -> str:
        scene = f"{self.interface.model}, scene {self.interface.scene}"
        return f"<{type(self).__name__} of {scene}: {', '.join(self.functions)}>"

    @property
    def shipped(self) -> Program:
        """The interface without the factors that only derivatives need, for runs of lagc."""
        interface = self.interface
        if interface.nc or not interface.work_size or interface.follows or interface.contacts:
            return self
        kept = {name: f for name, f in self.functions.items() if name not in ("assemble", "factor", "solve")}
        return Program(replace(interface, work_size=0, functions=tuple(kept)), kept)
