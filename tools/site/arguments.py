"""An extension of griffe: arguments that a docstring explains, each as `name: what it is`, become a list."""

import re

import griffe

_LINE = re.compile(r"(\w+(?:, \w+)*): ")


class Arguments(griffe.Extension):
    def on_function(self, *, func: griffe.Function, **_: object) -> None:
        if func.docstring is not None:
            known = {parameter.name.lstrip("*") for parameter in func.parameters}
            func.docstring.value = "\n".join(_as_list(func.docstring.value.splitlines(), known))


def _as_list(lines: list[str], known: set[str]) -> list[str]:
    found, inside = list[str](), False
    for line in lines:
        begins = _LINE.match(line)
        if begins is not None and {*begins[1].split(", ")} <= known:
            names = ", ".join(f"`{name}`" for name in begins[1].split(", "))
            found += [*([] if inside else [""]), f"- {names}: {line[begins.end() :]}"]
            inside = True
        else:
            inside = inside and bool(line.strip())
            found.append(f"  {line.strip()}" if inside else line)
    return found
