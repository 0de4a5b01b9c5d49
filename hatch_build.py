"""Ships the parser's tables, so that no run has to make them from the grammar."""

from __future__ import annotations

import sys
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CustomBuildHook(BuildHookInterface[Any]):
    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        sys.path.insert(0, self.root)
        from lagc.frontend.tables import packed, shipped_path

        with open(shipped_path(), "w", encoding="utf-8") as file:
            file.write(packed())
        build_data["artifacts"].append("lagc/frontend/tables.json")
