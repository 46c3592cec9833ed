"""Dictionaries as TOML, which is what a scene is."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._arrays import numbers


#: Tables and lists in one another, far more than a scene has: beyond, one of them holds itself.
_DEEPEST = 32


def _inside(path: str, name: Any, depth: int) -> str:
    if depth > _DEEPEST:
        shown = ".".join(path.split(".")[:6])
        raise ValueError(f"`{shown}…` holds itself\n  allowed: dictionaries and lists that end")
    return f"{path}.{name}" if path else str(name)


def value(item: Any, path: str = "", depth: int = 0) -> str:
    """A value as it stands behind a key: a number, a text, an array or an inline table. ``path`` names the key."""
    if isinstance(item, np.ndarray):
        if item.dtype.kind not in "bUO":
            numbers(f"`{path}`", item)
        return value(item.tolist(), path, depth)
    if isinstance(item, (bool, np.bool_)):
        return "true" if item else "false"
    if isinstance(item, (int, np.integer)):
        return str(int(item))
    if isinstance(item, (float, np.floating)):
        number = float(item)
        if math.isfinite(number):
            return repr(number)
        return "nan" if math.isnan(number) else ("inf" if number > 0 else "-inf")
    if isinstance(item, str):
        return text(item)
    if isinstance(item, os.PathLike):
        return text(os.fspath(item))
    if isinstance(item, Mapping):
        each = [(k, v, _inside(path, k, depth)) for k, v in item.items() if v is not None]
        return "{ " + ", ".join(f"{key(k)} = {value(v, inner, depth + 1)}" for k, v, inner in each) + " }"
    if isinstance(item, Sequence):
        return "[" + ", ".join(value(v, _inside(path, k, depth), depth + 1) for k, v in enumerate(item)) + "]"
    where = f" at `{path}`" if path else ""
    raise TypeError(
        f"a scene holds numbers, texts, true and false, lists and dictionaries\n  found: {type(item).__name__}{where}"
    )


def text(item: str) -> str:
    """A text in quotes."""
    return json.dumps(item, ensure_ascii=False).replace("\x7f", "\\u007f")


def key(name: Any) -> str:
    """A key, in quotes where it needs them."""
    if not isinstance(name, str):
        raise TypeError(f"the keys of a scene are texts\n  found: {name!r}")
    plain = name and all(c.isascii() and (c.isalnum() or c in "_-") for c in name)
    return name if plain else text(name)


def document(scene: Mapping[str, Any]) -> str:
    """A whole scene: tables under their headings, lists of tables under double ones."""
    plain: list[str] = []
    tables: list[str] = []
    for name, item in scene.items():
        if item is None:
            continue
        if isinstance(item, Mapping):
            tables.append(f"\n[{key(name)}]\n{document_of_table(item, str(name))}")
        elif _is_list_of_tables(item):
            each = enumerate(item)
            tables.extend(f"\n[[{key(name)}]]\n{document_of_table(entry, f'{name}.{k}')}" for k, entry in each)
        else:
            plain.append(f"{key(name)} = {value(item, str(name))}\n")
    return "".join(plain + tables)


def document_of_table(table: Mapping[str, Any], path: str = "") -> str:
    """The lines of one table."""
    each = [(k, v, _inside(path, k, 0)) for k, v in table.items() if v is not None]
    return "".join(f"{key(k)} = {value(v, inner)}\n" for k, v, inner in each)


def _is_list_of_tables(item: Any) -> bool:
    is_list = isinstance(item, Sequence) and not isinstance(item, str)
    return is_list and len(item) > 0 and all(isinstance(entry, Mapping) for entry in item)


def overrides(changes: Mapping[str, Any], path: str = "", depth: int = 0) -> list[tuple[str, str]]:
    """Changes of a scene as ``(key, value)``: nested dictionaries become keys joined by dots."""
    found: list[tuple[str, str]] = []
    for name, item in changes.items():
        inner = _inside(path, name, depth)
        if item is None:
            continue
        if isinstance(item, Mapping) and "kind" not in item:
            found.extend(overrides(item, inner, depth + 1))
        else:
            found.append((inner, value(item, inner, depth)))
    return found
