"""What a run gives back."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

from . import _lennard
from ._tables import Table, with_error

if TYPE_CHECKING:
    import pandas

    from ._frames import Frames


@dataclass(frozen=True)
class Mean:
    """A mean with its standard error, correlation included.

    ``error`` is ``nan`` where the number is no result. ``standing`` then names what is wrong (``too-short``,
    ``not-in-equilibrium``, ``incomplete``, ``thermostat``), and ``reason`` says why. A standing of ``sound`` means that
    nothing is wrong. The error is itself known to 1/√(2·``freedom``) of its value.
    """

    name: str
    value: float
    error: float
    n_eff: float
    unit: str
    freedom: float
    equilibration_cut: int
    standing: str
    reason: str

    @property
    def is_sound(self) -> bool:
        """Whether nothing speaks against it."""
        return self.standing == "sound"

    def __float__(self) -> float:
        return self.value

    def __format__(self, spec: str) -> str:
        """The value alone, by the format of a number: ``f"{mean:.3f}"``."""
        return format(self.value, spec) if spec else str(self)

    def __str__(self) -> str:
        number = f"{with_error(self.value, self.error)} {self.unit}".rstrip()
        return number if self.is_sound else f"{number} ({self.standing.replace('-', ' ')})"

    def __repr__(self) -> str:
        doubt = "" if self.is_sound else f", standing={self.standing!r}"
        return (
            f"Mean({self.name!r}, value={self.value!r}, error={self.error!r}, "
            f"n_eff={self.n_eff:.6g}, unit={self.unit!r}{doubt})"
        )

    def _repr_html_(self) -> str:
        return f"<table>{_HEAD}<tbody>{self._row()}</tbody></table>"

    def _row(self) -> str:
        note = "" if self.is_sound else escape(self.reason or self.standing)
        cells = (self.name, with_error(self.value, self.error), self.unit, f"{self.n_eff:.0f}", note)
        return "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>"


_HEAD = (
    "<thead><tr><th>quantity</th><th>mean (standard error)</th><th>unit</th>"
    "<th>independent samples</th><th></th></tr></thead>"
)


class Averages(Mapping[str, Mean]):
    """Means by name, in the order of the run's record."""

    def __init__(self, means: dict[str, Mean]) -> None:
        self._means = means

    @classmethod
    def _of(cls, raw: Mapping[str, Mapping[str, Any]]) -> Averages:
        return cls({name: _mean(name, record) for name, record in raw.items()})

    def __getitem__(self, name: str) -> Mean:
        try:
            return self._means[name]
        except KeyError:
            known = _lennard.instead_of(name) or ", ".join(self._means)
            raise KeyError(f"nothing called `{name}` was measured; there are {known}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._means)

    def __len__(self) -> int:
        return len(self._means)

    def to_pandas(self) -> pandas.DataFrame:
        """A data frame with a row for each quantity. Needs pandas."""
        import pandas

        rows = [
            {
                "quantity": mean.name,
                "value": mean.value,
                "error": mean.error,
                "n_eff": mean.n_eff,
                "unit": mean.unit,
                "standing": mean.standing,
            }
            for mean in self._means.values()
        ]
        columns = ["quantity", "value", "error", "n_eff", "unit", "standing"]
        return pandas.DataFrame(rows, columns=columns).set_index("quantity")

    def __repr__(self) -> str:
        width = max((len(name) for name in self._means), default=0)
        return "\n".join(f"{name:<{width}}  {mean}" for name, mean in self._means.items())

    def _repr_html_(self) -> str:
        rows = "".join(mean._row() for mean in self._means.values())
        return f"<table>{_HEAD}<tbody>{rows}</tbody></table>"


def _number(value: float | None) -> float:
    return float("nan") if value is None else float(value)


def _mean(name: str, record: Mapping[str, Any]) -> Mean:
    return Mean(
        name=name,
        value=_number(record["mean"]),
        error=_number(record["standard_error"]),
        n_eff=_number(record["n_effective"]),
        unit=record["unit"],
        freedom=_number(record["freedom"]),
        equilibration_cut=record["equilibration_cut"],
        standing=record["standing"],
        reason=record["reason"],
    )


class Run:
    """What a run found.

    ``averages`` are means by name. ``tables`` are the tables of the observables by name: ``run.rdf`` is
    ``run.tables["rdf"]``. ``thermo`` has the instantaneous values. ``record`` is the whole record, as in ``run.json``.
    ``scene`` is the TOML from which the command line gets the same numbers.
    """

    def __init__(
        self,
        *,
        record: dict[str, Any],
        tables: dict[str, Table],
        thermo: Table,
        frames: Frames,
        scene: str,
    ) -> None:
        self.record = record
        self.tables = tables
        self.thermo = thermo
        self.frames = frames
        self.scene = scene
        self.averages = Averages._of(record["averages"])

    @property
    def finished(self) -> bool:
        """Whether all steps of the scene were done."""
        return bool(self.record["finished"])

    @property
    def steps(self) -> int:
        """Steps done since the start."""
        return int(self.record["steps"])

    @property
    def remarks(self) -> list[str]:
        """What belongs beside the numbers."""
        return list(self.record["remarks"])

    @property
    def ns_per_atom_step(self) -> float:
        """Wall time of an atom and step, ns."""
        return _number(self.record["performance"]["ns_per_atom_step"])

    def compare(self) -> pandas.DataFrame:
        """The measured values beside the values of the literature, as a data frame. Needs pandas."""
        import pandas

        return pandas.DataFrame(self.record["comparison"])

    def to_json(self) -> str:
        """The record as ``run.json`` holds it."""
        return json.dumps(self.record, indent=2, ensure_ascii=False)

    def __getattr__(self, name: str) -> Table:
        if not name.startswith("_") and "tables" in self.__dict__:
            table = self.tables.get(name, self.tables.get(name.replace("_", "-")))
            if table is not None:
                return table
            names = ", ".join(self.tables) or "none"
            raise AttributeError(f"this run has no table `{name}`; its tables: {names}")
        raise AttributeError(name)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(name for name in self.tables if name.isidentifier())]

    def __repr__(self) -> str:
        state = "finished" if self.finished else "under way"
        head = f"<run of {self.record['atoms']} particles, {self.steps} steps, {state}>"
        return f"{head}\n{self.averages!r}" if self.averages else head

    def _repr_html_(self) -> str:
        model = escape(str(self.record["model"]))
        state = "" if self.finished else ", under way"
        remarks = "".join(f"<li>{escape(remark)}</li>" for remark in self.remarks)
        remarks = f"<ul>{remarks}</ul>" if remarks else ""
        head = f"<p>{model}: {self.record['atoms']} particles, {self.steps} steps{state}</p>"
        return head + self.averages._repr_html_() + remarks
