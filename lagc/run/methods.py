"""The integration methods, by name."""

from __future__ import annotations

from lagc.render.tableaus import TABLEAUS, Tableau

METHODS: dict[str, Tableau] = TABLEAUS
