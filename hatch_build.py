"""Ships the parser's tables and the kernels of common models, so that no run has to make them, and in a wheel
the list of what it holds of others (PEP 770)."""

from __future__ import annotations

import json
import os
import re
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SBOM = "lagc.cdx.json"
BUNDLED = re.compile(r"^(\S+) (\S+), in lagc/", re.M)  # the headings of web/LICENSES.txt
FMI = ("fmi-standard", ("2.0", "3.0"))  # of the headers in lagc/codegen/fmi/headers


class CustomBuildHook(BuildHookInterface[Any]):
    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        sys.path.insert(0, self.root)
        from lagc.compiler.shipped import files

        for path, text in files(Path(self.root)).items():
            path.write_text(text, encoding="utf-8")
            build_data["artifacts"].append(os.path.relpath(path, self.root))
        if self.target_name == "wheel" and version == "standard":
            sbom = Path(self.directory) / SBOM
            sbom.parent.mkdir(parents=True, exist_ok=True)
            sbom.write_text(json.dumps(self.bill(), indent=2) + "\n", encoding="utf-8")
            build_data["sbom_files"].append(str(sbom))

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        (Path(self.directory) / SBOM).unlink(missing_ok=True)

    def bill(self) -> dict[str, Any]:
        """Return the software bill of materials in CycloneDX: lagc, and the code of others in the wheel. What
        it needs beside is in the metadata of the wheel."""
        core = self.metadata.core
        notices = (Path(self.root) / "web" / "LICENSES.txt").read_text(encoding="utf-8")
        parts = [component(name, version, f"pkg:npm/{name}@{version}", "MIT")
                 for name, version in BUNDLED.findall(notices)]  # fmt: skip
        name, versions = FMI
        parts += [component(name, v, f"pkg:github/modelica/{name}@v{v}", "BSD-2-Clause") for v in versions]
        own = component(
            core.name, self.metadata.version, f"pkg:pypi/{core.name}@{self.metadata.version}", "MIT"
        )
        refs = [part["bom-ref"] for part in parts]
        return {
            "$schema": "http://cyclonedx.org/schema/bom-1.6.schema.json",
            "bomFormat": "CycloneDX", "specVersion": "1.6", "version": 1,
            "metadata": {"lifecycles": [{"phase": "build"}], "component": own},
            "components": parts,
            "dependencies": [{"ref": own["bom-ref"], "dependsOn": refs}, *({"ref": ref} for ref in refs)],
        }  # fmt: skip


def component(name: str, version: str, purl: str, licence: str) -> dict[str, Any]:
    return {"type": "library", "bom-ref": purl, "name": name, "version": version,
            "licenses": [{"license": {"id": licence}}], "purl": purl}  # fmt: skip
