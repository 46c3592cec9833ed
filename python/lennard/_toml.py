"""Dictionaries as TOML, which is what a scene is."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np


def value(item: Any) -> str:
    """A value as it stands behind a key: a number, a text, an array or an inline table."""
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
        entries = (f"{key(k)} = {value(v)}" for k, v in item.items() if v is not None)
        return "{ " + ", ".join(entries) + " }"
    if isinstance(item, np.ndarray):
        return value(item.tolist())
    if isinstance(item, Sequence):
        return "[" + ", ".join(value(i) for i in item) + "]"
    raise TypeError(
        f"a scene holds numbers, texts, true and false, lists and dictionaries\n  found: {type(item).__name__}"
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
            tables.append(f"\n[{key(name)}]\n{document_of_table(item)}")
        elif _is_list_of_tables(item):
            tables.extend(f"\n[[{key(name)}]]\n{document_of_table(entry)}" for entry in item)
        else:
            plain.append(f"{key(name)} = {value(item)}\n")
    return "".join(plain + tables)


def document_of_table(table: Mapping[str, Any]) -> str:
    """The lines of one table."""
    return "".join(f"{key(k)} = {value(v)}\n" for k, v in table.items() if v is not None)


def _is_list_of_tables(item: Any) -> bool:
    is_list = isinstance(item, Sequence) and not isinstance(item, str)
    return is_list and len(item) > 0 and all(isinstance(entry, Mapping) for entry in item)


def overrides(changes: Mapping[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """Changes of a scene as ``(key, value)``: nested dictionaries become keys joined by dots."""
    found: list[tuple[str, str]] = []
    for name, item in changes.items():
        path = f"{prefix}{name}"
        if item is None:
            continue
        if isinstance(item, Mapping) and "kind" not in item:
            found.extend(overrides(item, f"{path}."))
        else:
            found.append((path, value(item)))
    return found
