"""Tables of numbers with names and units."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from . import _lennard

if TYPE_CHECKING:
    import pandas

Floats: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Column:
    """A column: ``values`` are numbers, or words where it holds some; ``errors`` are standard errors, if it has any."""

    name: str
    unit: str
    values: Floats | list[str]
    errors: Floats | None = None

    @property
    def heading(self) -> str:
        """The name with its unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


class Table(Mapping[str, "Floats"]):
    """A table: ``table["r"]`` is a column as a numpy array, and ``table.g`` is the same as ``table["g"]``."""

    def __init__(self, name: str, caption: str, columns: list[Column]) -> None:
        self.name = name
        self.caption = caption
        self.columns = columns

    @classmethod
    def _of(cls, raw: Mapping[str, Any]) -> Table:
        return cls(raw["name"], raw["caption"], [Column(**column) for column in raw["columns"]])

    def column(self, name: str) -> Column:
        """A column with its unit and errors."""
        for column in self.columns:
            if column.name == name:
                return column
        known = _lennard.instead_of(name) or ", ".join(column.name for column in self.columns)
        raise KeyError(f"the table `{self.name}` has no column `{name}`; it has {known}")

    def __getitem__(self, name: str) -> Floats:
        values = self.column(name).values
        # Columns of words are rare, and an array of them is what a reader expects.
        return np.asarray(values)

    def __getattr__(self, name: str) -> Floats:
        if name.startswith("_") or "columns" not in self.__dict__:
            raise AttributeError(name)
        try:
            return self[name]
        except KeyError as error:
            raise AttributeError(str(error.args[0])) from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def __iter__(self) -> Iterator[str]:
        return (column.name for column in self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def units(self) -> dict[str, str]:
        """Units by name of the column."""
        return {column.name: column.unit for column in self.columns}

    @property
    def rows(self) -> int:
        """Number of rows."""
        return max((len(column.values) for column in self.columns), default=0)

    def to_pandas(self) -> pandas.DataFrame:
        """A data frame; standard errors are columns called ``NAME_error``. Needs pandas."""
        import pandas

        data: dict[str, Any] = {}
        for column in self.columns:
            data[column.name] = column.values
            if column.errors is not None:
                data[f"{column.name}_error"] = column.errors
        return pandas.DataFrame(data)

    def __repr__(self) -> str:
        headings = ", ".join(column.heading for column in self.columns)
        return f"<table {self.name}: {self.rows} rows of {headings}>"

    def _repr_html_(self) -> str:
        shown = 12
        heads = "".join(f"<th>{escape(column.heading)}</th>" for column in self.columns)
        rows = []
        for i in range(min(self.rows, shown)):
            cells = "".join(f"<td>{escape(_cell(column, i))}</td>" for column in self.columns)
            rows.append(f"<tr>{cells}</tr>")
        more = f"<p>{self.rows} rows</p>" if self.rows > shown else ""
        caption = f"<caption>{escape(self.caption)}</caption>"
        return f"<table>{caption}<thead><tr>{heads}</tr></thead><tbody>{''.join(rows)}</tbody></table>{more}"


def _cell(column: Column, row: int) -> str:
    if row >= len(column.values):
        return ""
    value = column.values[row]
    if isinstance(value, str):
        return value
    if column.errors is not None:
        return with_error(float(value), float(column.errors[row]))
    return "" if np.isnan(value) else f"{float(value):.6g}"


def with_error(value: float, error: float) -> str:
    """A number with its standard error in brackets: 0.192(3) is 0.192 ± 0.003."""
    if not np.isfinite(value):
        return "–"
    if not np.isfinite(error):
        return f"{value:.6g}"
    if error <= 0.0:
        return f"{value:.10g}"
    places = max(0, -int(np.floor(np.log10(error))) + (1 if _first_digit(error) < 2 else 0))
    if places > 12:
        return f"{value:.12g} ± {error:.2g}"
    if places == 0:
        return f"{value:.0f} ± {error:.2g}"
    return f"{value:.{places}f}({round(error * 10**places)})"


def _first_digit(number: float) -> float:
    return float(number / 10 ** np.floor(np.log10(number)))
