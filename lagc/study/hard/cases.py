"""All hard cases, in the order of the table."""

from __future__ import annotations

from lagc.study.hard import accuracy, chains, constraints, contacts, long_runs, mechanisms, published
from lagc.study.hard.case import Case

CASES: tuple[Case, ...] = (
    *mechanisms.CASES, *long_runs.CASES, *chains.CASES, *accuracy.CASES, *constraints.CASES, *contacts.CASES,
    *published.CASES,
)  # fmt: skip
