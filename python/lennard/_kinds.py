"""Methods by name: ``lennard.thermostat.bussi(tau=0.5)``.

Names, keys and documentation come from the program, so that a method of the program is a method here.
"""

from __future__ import annotations

import difflib
import functools
import inspect
import json
from collections.abc import Callable
from typing import Any

from . import _lennard


class Table(dict[str, Any]):
    """A table of a scene: a dictionary that shows itself as it was called."""

    def __init__(self, group: str, kind: str, keys: dict[str, Any]) -> None:
        super().__init__(kind=kind, **keys)
        self._group = group

    def __repr__(self) -> str:
        keys = ", ".join(f"{k}={v!r}" for k, v in self.items() if k != "kind")
        return f"{self._group}.{self['kind'].replace('-', '_')}({keys})"

    def __reduce__(self) -> tuple[Any, ...]:
        keys = {k: v for k, v in self.items() if k != "kind"}
        return (Table, (self._group, self["kind"], keys))


@functools.cache
def reference() -> list[dict[str, Any]]:
    """Every key of a scene: table, method, key, what is allowed, default, unit and meaning."""
    keys: list[dict[str, Any]] = json.loads(_lennard.key_reference())
    return keys


class Kinds:
    """The methods of a table of the scene, each a function of its keys."""

    def __init__(self, group: str, table: str) -> None:
        self._group = group
        self._table = table

    def _names(self) -> list[str]:
        for entry in reference():
            if entry["table"] == self._table and entry["key"] == "kind":
                return [str(name) for name in entry["names"] if name != "none"]
        return []

    def _keys(self, kind: str) -> list[dict[str, Any]]:
        def belongs(entry: dict[str, Any]) -> bool:
            of_kind = entry["method"] in (None, kind)
            return entry["table"] == self._table and of_kind and entry["key"] != "kind"

        return [entry for entry in reference() if belongs(entry)]

    def __getattr__(self, name: str) -> Callable[..., Table]:
        kind = name.replace("_", "-")
        names = self._names() if not name.startswith("__") else []
        if kind not in names:
            close = difflib.get_close_matches(kind, names, 1)
            nearest = f"\n  nearest: {close[0].replace('-', '_')}" if close else ""
            allowed = ", ".join(n.replace("-", "_") for n in names)
            raise AttributeError(
                f"there is no {self._group} `{name}`\n  allowed: {allowed}{nearest}", name=name, obj=self
            )
        group = self._group

        def make(**keys: Any) -> Table:
            return Table(group, kind, keys)

        make.__name__ = make.__qualname__ = name
        make.__doc__ = self._documentation(kind)
        parameters = [
            inspect.Parameter(entry["key"], inspect.Parameter.KEYWORD_ONLY, default=_Default(entry["default"]))
            for entry in self._keys(kind)
            if entry["key"].isidentifier()
        ]
        make.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        return make

    def _documentation(self, kind: str) -> str:
        lines = [f"The {self._group} `{kind}` of a scene.", ""]
        for entry in self._keys(kind):
            unit = f" [{entry['unit']}]" if entry["unit"] else ""
            lines.append(
                f"{entry['key']}{unit}: {entry['meaning']} Allowed: {entry['allowed']}. Default: {entry['default']}."
            )
        return "\n".join(lines)

    def __dir__(self) -> list[str]:
        return [name.replace("-", "_") for name in self._names()]

    def __repr__(self) -> str:
        return f"lennard.{self._group}: {', '.join(dir(self))}"


class _Default:
    """A default as the documentation words it."""

    def __init__(self, words: str) -> None:
        self._words = words.strip("`")

    def __repr__(self) -> str:
        return self._words


potential = Kinds("potential", "potential")
truncation = Kinds("truncation", "truncation")
integrator = Kinds("integrator", "integrator")
thermostat = Kinds("thermostat", "stage.thermostat")
barostat = Kinds("barostat", "stage.barostat")
wall = Kinds("wall", "wall")
observable = Kinds("observable", "observable")
