"""The Taylor coefficients of a motion, from its right-hand side, order by order.

series      (p,t,x) -> xdot[nx], w[]   order 0: the rates, and what the further orders need of the state
series_next (p,x,d,w,r) -> a[], b[], s[], xdot[nx]   order k, of the rates and of what they are made of

In order k, x are the coefficients of the states, d = k x, then k, 1/k and the coefficient of time. Each
product of two series a and b needs the convolution sum a_j b_(k-j), j = 1 ... k-1: one *lane*. Each square
needs half of it. r holds these sums, lanes first; a, b and s are the factors of order k, for the sums of
higher orders.

R. E. Moore, Interval Analysis, Prentice-Hall 1966, chapter 11; A. Jorba, M. Zou, Experimental Mathematics 14
(2005) 99-117, section 2; G. F. Corliss, Y. F. Chang, ACM Trans. Math. Software 8 (1982) 114-144.
"""

from collections.abc import Callable, Mapping

from lagc.base.records import replace
from lagc.lowering.program import Function, Operation, uses
from lagc.lowering.scalar.value_numbering import Block
from lagc.lowering.storage import WEIGHTS
from lagc.symbolic.operators import TRUTHS

_LATENCY = {"load": 0, "const": 0, "neg": 1}  # others: 4


class NoSeries(Exception):
    """An operation has no recurrence: its name."""


def series(rhs: Function, integrated: int) -> list[Function]:
    """Return both functions for the states x[:integrated]. Raises NoSeries."""
    return _Series(rhs, integrated).functions()


def unfit(rhs: Function, integrated: int) -> str | None:
    """Return the name of an operation without a recurrence, if there is one."""
    try:
        series(rhs, integrated)
    except NoSeries as missing:
        return str(missing)
    return None


def counts(functions: Mapping[str, Function]) -> tuple[int, int, int, int, int]:
    """Return the numbers of values, lanes and squares of a program, and the work of an order besides sums and
    of a right-hand side, in additions; 0 without series."""
    if "series" not in functions:
        return 0, 0, 0, 0, 0
    lengths = dict(functions["series_next"].outputs)
    finish, rhs = [
        sum([WEIGHTS[o.op] for o in functions[name].operations]) for name in ("series_next", "rhs")
    ]
    return dict(functions["series"].outputs)["w"], lengths["a"], lengths["s"], finish, rhs


class _Series:
    def __init__(self, rhs: Function, integrated: int) -> None:
        self.rhs, self.integrated = rhs, integrated
        self.first, self.next = Block(), Block()
        self.moving: set[int] = set()  # operations that depend on the time or the state
        self.value: list[int] = []  # of each operation, in order 0: reference in `first`
        self.coefficient: dict[int, int] = {}  # of each that moves, in order k: reference in `next`
        self.kept: dict[int, int] = {}  # values of `first` -> their places in w
        self.lanes: list[tuple[int, int]] = []  # factors: references in `next`
        self.squares: list[int] = []
        self.pairs: dict[tuple[str, int], tuple[int, int]] = {}
        self.depths: dict[int, int] = {}

    def functions(self) -> list[Function]:
        rhs = self.rhs
        for k, o in enumerate(rhs.operations):
            if self.moves(o):
                self.moving.add(k)
        operations = [self.as_power(o) for o in rhs.operations]
        used = uses_of_rates(replace(rhs, operations=tuple(operations)))
        for k, o in enumerate(rhs.operations):
            # Each operation in order 0 in one block, and its recurrence for order k in another. Operations
            # that nothing of the rates uses, and those that do not move, have none.
            self.value.append(self.first.repeat(o, [self.value[i] for i in o.operands]))
            if used[k] and k in self.moving:
                self.coefficient[k] = self.order_k(k, operations[k])
        return [self.order_0(), self.later()]

    def moves(self, o: Operation) -> bool:
        if o.op == "load":
            assert isinstance(o.payload, tuple)
            array, index = o.payload
            return array == "t" or (array == "x" and index < self.integrated)
        return any(i in self.moving for i in o.operands)

    def as_power(self, o: Operation) -> Operation:
        """Return a constant over a power as one operation `power` of both and the exponent: one recurrence
        takes the place of those of the root, the product and the quotient."""
        if o.op == "div" and o.operands[0] not in self.moving:
            base, exponent = self.power(o.operands[1])
            if exponent not in (1.0, 2.0) and base in self.moving:
                return Operation("power", (o.operands[0], base), -exponent)
        return o

    # -- the functions --

    def order_0(self) -> Function:
        nx = dict(self.rhs.outputs)["xdot"]
        for store in self.rhs.stores:
            if store.array == "xdot":
                self.first.store("xdot", store.index, self.value[store.value])
        for a, place in self.kept.items():
            self.first.store("w", place, a)
        outputs = (("xdot", nx), ("w", len(self.kept)))
        return self.first.function("series", self.rhs.inputs, outputs, "order 0 of the Taylor series")

    def later(self) -> Function:
        nx = dict(self.rhs.outputs)["xdot"]
        for place, (a, b) in enumerate(self.lanes):
            self.next.store("a", place, a)
            self.next.store("b", place, b)
        for place, a in enumerate(self.squares):
            self.next.store("s", place, a)
        for store in self.rhs.stores:
            if store.array == "xdot":
                self.next.store("xdot", store.index, self.coefficient.get(store.value, self.next.zero))
        lanes = len(self.lanes)
        outputs = (("a", lanes), ("b", lanes), ("s", len(self.squares)), ("xdot", nx))
        found = self.next.function("series_next", ("p", "x", "d", "w", "r"), outputs,
                                   "order k of the Taylor series, from the sums r")  # fmt: skip
        operations = [
            Operation(o.op, o.operands, ("r", lanes + o.payload[1]))
            if isinstance(o.payload, tuple) and o.payload[0] == "s"
            else o
            for o in found.operations
        ]
        return replace(found, operations=tuple(operations))

    # -- parts of recurrences --

    def at_0(self, a: int) -> int:
        """Return the value `a` of `first` in `next`: a number, a parameter, or an entry of w."""
        # Values of order 0 that recurrences need are kept in w, each once.
        if a < 0:
            return ~self.at_0(~a)
        op, _, payload = self.first.row(a)
        if op == "const":
            assert isinstance(payload, float | int)
            return self.next.const(payload)
        if op == "load" and isinstance(payload, tuple) and payload[0] == "p":
            return self.next.load(*payload)
        return self.next.load("w", self.kept.setdefault(a, len(self.kept)))

    def n(self, k: int) -> int:
        """Return the value of operation k in order 0."""
        return self.at_0(self.value[k])

    def number(self, place: int) -> int:
        """Return k, 1/k or the coefficient of time, by `place`."""
        return self.next.load("d", dict(self.rhs.outputs)["xdot"] + place)

    def times_k(self, k: int) -> int:
        """Return the order times the coefficient of operation k."""
        # j x_j of a state is its rate in the scaled time: it needs no product.
        o = self.rhs.operations[k]
        if o.op == "load" and isinstance(o.payload, tuple) and o.payload[0] == "x":
            return self.next.load("d", o.payload[1])
        return self.next.mul(self.number(0), self.coefficient[k])

    def new_lane(self) -> int:
        """Return the sum of a new lane, whose factors follow."""
        self.lanes.append((0, 0))
        return self.next.load("r", len(self.lanes) - 1)

    def convolved(self, a: int, b: int) -> int:
        """Return the sum of a new lane with these factors."""
        found = self.new_lane()
        self.lanes[-1] = a, b
        return found

    def new_square(self) -> int:
        """Return the sum of a new square, whose root follows."""
        self.squares.append(0)
        return self.next.load("s", len(self.squares) - 1)

    def square(self, a: int, a_0: int) -> int:
        """Return the coefficient of a^2."""
        found = self.new_square()
        self.squares[-1] = a
        return self.next.add(found, self.next.mul(self.next.add(a_0, a_0), a))

    def depth(self, a: int) -> int:
        """Return about how many cycles after the sums the coefficient `a` is ready."""
        a = self.next.unsigned(a)
        if a not in self.depths:
            op, operands, _ = self.next.row(a)
            self.depths[a] = max([self.depth(i) for i in operands], default=0) + _LATENCY.get(op, 4)
        return self.depths[a]

    def product(self, i: int, j: int) -> int:
        """Return the coefficient of a product; the factor that is known last is added last."""
        # (xy)_k = x_k y_0 + x_0 y_k + sum of x_j y_(k-j): the sum is a lane of the convolution, the rest is
        # added here.
        block, coefficient = self.next, self.coefficient
        if i not in coefficient or j not in coefficient:
            i, j = (i, j) if i in coefficient else (j, i)
            return block.mul(coefficient[i], self.n(j))
        if i == j:
            return self.square(coefficient[i], self.n(i))
        if self.depth(coefficient[i]) > self.depth(coefficient[j]):
            i, j = j, i
        early = block.mul(coefficient[i], self.n(j))
        found = block.add(self.convolved(coefficient[i], coefficient[j]), early)
        return block.add(found, block.mul(self.n(i), coefficient[j]))

    # -- one operation --

    def order_k(self, k: int, o: Operation) -> int:
        block, coefficient = self.next, self.coefficient
        c = [coefficient.get(i) for i in o.operands]
        if o.op == "load":
            assert isinstance(o.payload, tuple)
            return self.number(2) if o.payload[0] == "t" else block.load("x", o.payload[1])
        if o.op == "neg":
            return ~coefficient[o.operands[0]]
        if o.op in ("add", "sub"):
            left = block.zero if c[0] is None else c[0]
            right = block.zero if c[1] is None else c[1]
            return block.add(left, right if o.op == "add" else ~right)
        if o.op == "mul":
            return self.product(*o.operands)
        own: Callable[[int, Operation], int] | None = getattr(self, f"of_{o.op}", None)
        if own is None or o.op in TRUTHS:
            raise NoSeries(o.op)
        return own(k, o)

    def of_div(self, k: int, o: Operation) -> int:
        block = self.next
        a, b = o.operands
        # q b = a gives q_k = (a_k - sum b_j q_(k-j) - b_k q_0) / b_0.
        inverse = self.at_0(self.first.div(self.first.one, self.value[b]))
        right = self.coefficient.get(a, block.zero)
        if b not in self.coefficient:
            return block.div(right, self.n(b))
        place = len(self.lanes)
        rest = block.sub(right, self.new_lane())
        found = block.mul(block.sub(rest, block.mul(self.coefficient[b], self.n(k))), inverse)
        self.lanes[place] = self.coefficient[b], found
        return found

    def of_sqrt(self, k: int, o: Operation) -> int:
        return self.root(self.coefficient[o.operands[0]], self.value[k])

    def root(self, a: int, root_0: int) -> int:
        """Return the coefficient of a square root, `root_0` in order 0."""
        # r^2 = a gives r_k = (a_k - sum r_j r_(k-j)) / (2 r_0).
        inverse = self.at_0(self.first.div(self.first.const(0.5), root_0))
        place = len(self.squares)
        found = self.next.mul(self.next.sub(a, self.new_square()), inverse)
        self.squares[place] = found
        return found

    def sine_and_cosine(self, i: int, ops: tuple[str, str], sign: float) -> tuple[int, int]:
        """Return the coefficients of s = sin or sinh and c = cos or cosh of operation i, with s' = c x' and
        c' = -s x' or s x'."""
        # k s_k = sum j x_j c_(k-j), k c_k = -sum j x_j s_(k-j): both in one, as each needs the other (JZ 2.1
        # in `kernels/integrators/taylor`).
        if (ops[0], i) not in self.pairs:
            block, own, d = self.next, self.coefficient[i], self.times_k(i)
            values = [self.at_0(self.first.apply(op, self.value[i])) for op in ops]
            place = len(self.lanes)
            made = [block.add(block.mul(self.number(1), self.new_lane()), block.mul(own, values[1 - m]))
                    for m in range(2)]  # fmt: skip
            sine, cosine = made[0], made[1] if sign > 0.0 else ~made[1]
            self.lanes[place], self.lanes[place + 1] = (d, cosine), (d, sine)
            self.pairs[ops[0], i] = sine, cosine
        return self.pairs[ops[0], i]

    def of_sin(self, k: int, o: Operation) -> int:
        return self.sine_and_cosine(o.operands[0], ("sin", "cos"), -1.0)[0]

    def of_cos(self, k: int, o: Operation) -> int:
        return self.sine_and_cosine(o.operands[0], ("sin", "cos"), -1.0)[1]

    def of_sinh(self, k: int, o: Operation) -> int:
        return self.sine_and_cosine(o.operands[0], ("sinh", "cosh"), 1.0)[0]

    def of_cosh(self, k: int, o: Operation) -> int:
        return self.sine_and_cosine(o.operands[0], ("sinh", "cosh"), 1.0)[1]

    def integral(self, i: int, rate: int, rate_0: int) -> int:
        """Return the coefficient of y with y' = rate * x', x operation i: rate_0 x_k and 1/k of the sum of
        j x_j rate_(k-j)."""
        block = self.next
        return block.add(block.mul(self.number(1), self.convolved(self.times_k(i), rate)),
                         block.mul(self.coefficient[i], rate_0))  # fmt: skip

    def of_exp(self, k: int, o: Operation) -> int:
        place = len(self.lanes)
        found = self.integral(o.operands[0], 0, self.n(k))
        self.lanes[place] = self.lanes[place][0], found
        return found

    def of_tan(self, k: int, o: Operation, sign: float = 1.0) -> int:
        """Return the coefficient of tan, y' = (1 + y^2) x', or of tanh, y' = (1 - y^2) x'."""
        y = self.value[k]
        square = self.first.mul(y, y)
        rate = self.at_0(self.first.add(self.first.one, square if sign > 0.0 else ~square))
        place = len(self.lanes)
        found = self.integral(o.operands[0], 0, rate)
        square = self.square(found, self.n(k))
        self.lanes[place] = self.lanes[place][0], square if sign > 0.0 else ~square
        return found

    def of_tanh(self, k: int, o: Operation) -> int:
        return self.of_tan(k, o, -1.0)

    def inverse(self, i: int, divisor: int, divisor_0: int) -> int:
        """Return the coefficient of y with y' * divisor = x', x operation i."""
        block = self.next
        # k y_k d_0 = k x_k - sum j y_j d_(k-j).
        place = len(self.lanes)
        rest = block.sub(self.coefficient[i], block.mul(self.number(1), self.new_lane()))
        found = block.mul(rest, self.at_0(self.first.div(self.first.one, divisor_0)))
        self.lanes[place] = block.mul(self.number(0), found), divisor
        return found

    def of_log(self, k: int, o: Operation) -> int:
        (i,) = o.operands
        return self.inverse(i, self.coefficient[i], self.value[i])

    def of_atan(self, k: int, o: Operation) -> int:
        (i,) = o.operands
        x = self.value[i]
        divisor_0 = self.first.add(self.first.one, self.first.mul(x, x))
        return self.inverse(i, self.square(self.coefficient[i], self.n(i)), divisor_0)

    def of_asin(self, k: int, o: Operation) -> int:
        (i,) = o.operands
        x = self.value[i]
        inner = self.first.sub(self.first.one, self.first.mul(x, x))
        divisor_0 = self.first.apply("sqrt", inner)
        divisor = self.root(~self.square(self.coefficient[i], self.n(i)), divisor_0)
        return self.inverse(i, divisor, divisor_0)

    def of_acos(self, k: int, o: Operation) -> int:
        return ~self.of_asin(k, o)

    def of_atan2(self, k: int, o: Operation) -> int:
        """Return the coefficient of y with y' (a^2 + b^2) = b a' - a b'."""
        # The same with a^2 + b^2 for the divisor.
        block, first, (i, j) = self.next, self.first, o.operands
        a, b = [self.coefficient.get(n, block.zero) for n in (i, j)]
        a_0, b_0 = self.value[i], self.value[j]
        inverse = self.at_0(first.div(first.one, first.add(first.mul(a_0, a_0), first.mul(b_0, b_0))))
        squares, sums = [block.zero, block.zero], [block.zero, block.zero]
        for m, (n, other) in enumerate(((i, b), (j, a))):
            if n in self.coefficient:
                squares[m] = self.square(self.coefficient[n], self.n(n))
                if not block.is_zero(other):
                    sums[m] = self.convolved(self.times_k(n), other)
        turned = block.sub(block.mul(a, self.n(j)), block.mul(b, self.n(i)))
        place = len(self.lanes)
        rest = block.mul(self.number(1), block.sub(block.sub(*sums), self.new_lane()))
        found = block.mul(block.add(rest, turned), inverse)
        self.lanes[place] = block.mul(self.number(0), found), block.add(*squares)
        return found

    def power(self, k: int) -> tuple[int, float]:
        """Return an operation and its exponent in operation k, a product of powers of it: (k, 1) if there is
        none."""
        o = self.rhs.operations[k]
        if o.op == "sqrt":
            base, exponent = self.power(o.operands[0])
            return base, 0.5 * exponent
        if o.op == "mul":
            (base, one), (other, two) = [self.power(i) for i in o.operands]
            if base == other:
                return base, one + two
        return k, 1.0

    def of_power(self, k: int, o: Operation) -> int:
        assert isinstance(o.payload, float)
        return self.power_of(o.operands[1], self.first.const(o.payload), self.value[k])

    def of_pow(self, k: int, o: Operation) -> int:
        i, exponent = o.operands
        if exponent in self.coefficient:
            raise NoSeries("pow with an exponent that varies")
        return self.power_of(i, self.value[exponent], self.value[k])

    def power_of(self, i: int, exponent: int, y_0: int) -> int:
        """Return the coefficient of y with y' x = exponent x' y, x operation i: a multiple of a power with a
        fixed exponent. `exponent` and `y_0` are values in order 0."""
        block, first = self.next, self.first
        inverse = self.at_0(first.div(first.one, self.value[i]))
        one_more = self.at_0(first.add(exponent, first.one))
        slope = self.at_0(first.mul(exponent, y_0))
        place = len(self.lanes)
        weighted = block.mul(self.number(1), block.mul(one_more, self.new_lane()))
        rest = block.add(block.sub(weighted, self.new_lane()), block.mul(slope, self.coefficient[i]))
        found = block.mul(rest, inverse)
        self.lanes[place], self.lanes[place + 1] = (self.times_k(i), found), (self.coefficient[i], found)
        return found

    def of_abs(self, k: int, o: Operation) -> int:
        (i,) = o.operands
        return self.next.mul(self.at_0(self.first.apply("sign", self.value[i])), self.coefficient[i])

    def of_select(self, k: int, o: Operation) -> int:
        """Return the coefficient of a choice that does not change within a step."""
        condition, *others = o.operands
        if condition in self.coefficient:
            raise NoSeries("a condition that may change within a step")
        first, block = self.first, self.next
        chosen = self.at_0(first.apply("select", self.value[condition], first.one, first.zero))
        branches = [self.coefficient.get(i, block.zero) for i in others]
        return block.apply("select", block.apply("lt", block.const(0.5), chosen), *branches)


def uses_of_rates(rhs: Function) -> list[int]:
    """Return how often each operation is used on the way to the rates."""
    return uses(replace(rhs, stores=tuple([store for store in rhs.stores if store.array == "xdot"])))
