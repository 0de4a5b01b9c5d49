"""Vectors of nodes or numbers and 3x3 matrices of nodes, as plain tuples (matrices by rows)."""

from collections.abc import Sequence
from math import frexp
from typing import TypeAlias, TypeVar

from lagc.symbolic.graph import Node

Vector: TypeAlias = tuple[Node, Node, Node]
Matrix: TypeAlias = tuple[Vector, Vector, Vector]
T = TypeVar("T", Node, float)


def add(a: Vector, b: Vector) -> Vector:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a: tuple[T, T, T], b: tuple[T, T, T]) -> tuple[T, T, T]:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scale(c: Node | float, a: Vector) -> Vector:
    return (a[0] * c, a[1] * c, a[2] * c)


def dot(a: Sequence[T], b: Sequence[T]) -> T:
    """Return the sum of the products of elements; a and b have the same length, at least one."""
    total = a[0] * b[0]
    for x, y in zip(a[1:], b[1:]):
        total = total + x * y
    return total


def cross(a: tuple[T, T, T], b: tuple[T, T, T]) -> tuple[T, T, T]:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def norm(a: Sequence[Node]) -> Node:
    """Return the length; angles by which the vector is rotated as a whole drop out."""
    square = dot(a, a)
    if not square.is_const:
        from lagc.symbolic.simplify import without_turns  # loaded where a length can have angles

        square = without_turns(square)
    return square.graph.sqrt(square)


def matvec(m: Matrix, a: Vector) -> Vector:
    return (dot(m[0], a), dot(m[1], a), dot(m[2], a))


def transpose(m: Matrix) -> Matrix:
    return ((m[0][0], m[1][0], m[2][0]), (m[0][1], m[1][1], m[2][1]), (m[0][2], m[1][2], m[2][2]))


def matmul(a: Matrix, b: Matrix) -> Matrix:
    columns = transpose(b)
    return (
        (dot(a[0], columns[0]), dot(a[0], columns[1]), dot(a[0], columns[2])),
        (dot(a[1], columns[0]), dot(a[1], columns[1]), dot(a[1], columns[2])),
        (dot(a[2], columns[0]), dot(a[2], columns[1]), dot(a[2], columns[2])),
    )


def axis_rates(axes: Matrix, w: Vector) -> dict[Node, Node]:
    """Return d(axes)/dt for unit vectors (columns of `axes`) with angular velocity w in their own axes: e_k'
    = w x e_k. Only components that are sums are included; the others follow from their arguments."""
    found: dict[Node, Node] = {}
    for x, y, z in axes:
        for node, rate in ((x, w[2] * y - w[1] * z), (y, w[0] * z - w[2] * x), (z, w[1] * x - w[0] * y)):
            if node.op == "scale" and frexp(node.value)[0] in (0.5, -0.5):  # as it occurs in products
                node, rate = node.args[0], rate * (1.0 / node.value)
            if node.op == "add":
                found.setdefault(node, rate)
    return found
