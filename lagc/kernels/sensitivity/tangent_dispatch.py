"""Dispatch: the sensitivities on the stages of a method by its number."""

from typing import Any

from lagc.kernels.language.vocabulary import *


def method_tangent_stages(
    method: int, p: Params, s: State, m: Length, columns: IVec[Any], now: Rows[NX], after: Rows[NX],
    table: Rows[NX], noise: Rows[NGROUP], w: Work, v: TangentWork,
) -> Status:  # fmt: skip
    """Compute the rates of S at the stages of the last step."""
    for own in static(METHODS):
        if own.SENSITIVE > 0:
            if method == own.NUMBER:
                return own.tangent_stages(p, s, m, columns, now, after, table, noise, w, v)
    return OK


def method_tangent_extra(
    method: int, p: Params, s: State, m: Length, columns: IVec[Any], now: Rows[NX], table: Rows[NX],
    noise: Rows[NGROUP], w: Work, v: TangentWork,
) -> Status:  # fmt: skip
    """Compute those of its dense output."""
    for own in static(METHODS):
        if own.SENSITIVE > 0:
            if method == own.NUMBER:
                return own.tangent_extra(p, s, m, columns, now, table, noise, w, v)
    return OK


def method_tangent_error(method: int, h: Real, v: TangentWork) -> Real:
    """Return the scaled error of S in one direction."""
    for own in static(METHODS):
        if own.SENSITIVE > 0:
            if method == own.NUMBER:
                return own.tangent_error(h, v)
    return 0.0


def method_tangent_dense(
    method: int, share: Real, h: Real, k: Length, now: Rows[NX], after: Rows[NX], table: Rows[NX],
    found: Vec[NX], v: TangentWork,
) -> None:  # fmt: skip
    """Evaluate the dense output of S in direction k."""
    for own in static(METHODS):
        if own.SENSITIVE > 0:
            if method == own.NUMBER:
                own.tangent_dense(share, h, k, now, after, table, found, v)
