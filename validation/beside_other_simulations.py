"""Where a sweep differs from the equation of state, do other people's simulations differ from it as well?

    python validation/beside_other_simulations.py runs/verlet-4/table.csv

The tables of G. Chaparro and E. A. Müller (J. Phys. Chem. B 2023, doi:10.1021/acs.jpcb.3c06813) hold U and P of their own
simulations beside the transport coefficients. Tails for their cutoff are added, and their differences from Thol 2016 are
taken on the line between two temperatures of the same density. They stand beside the differences of the sweep. The last
lines are the distribution of the sweep's differences in standard errors: chi squared, and the Kolmogorov-Smirnov test against the
normal distribution.
"""

from __future__ import annotations

import csv
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
from scipy import stats

DATA = Path(__file__).resolve().parents[1] / "crates/literature/data/chaparro-mueller-2023"

#: The largest gap between two tabulated temperatures, relative.
GAP = 0.35


def rows(path: Path) -> list[dict[str, str]]:
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def others() -> dict[float, np.ndarray]:
    """For each density of the tables: temperature, U - U_Thol and P - P_Thol, sorted by temperature."""
    found: dict[float, set] = defaultdict(set)
    for path in sorted(DATA.glob("*.csv")):
        for row in rows(path):
            if row["phase"] == "stable_fluid" and not row["flag"]:
                found[float(row["rho"])].add((float(row["T"]), float(row["dU_vs_Thol"]), float(row["dP_vs_Thol"])))
    return {rho: np.array(sorted(values)) for rho, values in found.items()}


def theirs(table: dict[float, np.ndarray], rho: float, t: float) -> tuple[float, float] | None:
    near = next((d for d in table if abs(d - rho) < 1e-3), None)
    if near is None:
        return None
    temperatures = table[near][:, 0]
    i = int(np.searchsorted(temperatures, t))
    if i in (0, len(temperatures)) or temperatures[i] / temperatures[i - 1] > 1.0 + GAP:
        return None
    return tuple(float(np.interp(t, temperatures, table[near][:, k])) for k in (1, 2))


def distribution(name: str, z: list[float]) -> str:
    chi_squared = float(np.square(z).sum())
    p = stats.chi2.sf(chi_squared, len(z))
    return (
        f"{name}: {len(z)} points, mean {np.mean(z):+.2f} and standard deviation {np.std(z, ddof=1):.2f} in errors, "
        f"chi squared {chi_squared:.1f} (p = {p:.2g}), Kolmogorov-Smirnov p = {stats.kstest(z, 'norm').pvalue:.2g}"
    )


def main(path: Path) -> None:
    table = others()
    alone = {"U": [], "P": []}
    beside = {"U": [], "P": []}
    print("| point | T, half steps | U - Thol | theirs | P - Thol | theirs |")
    print("|---|---|---|---|---|---|")
    for row in rows(path):
        if not row["phase"].startswith("stable") or not row["potential_energy_difference"]:
            continue
        rho, t = float(row["density"]), float(row["temperature"])
        other = theirs(table, rho, t)
        cells = [row["name"], f"{t:.4f}"]
        for k, (name, key) in enumerate((("U", "potential_energy"), ("P", "pressure"))):
            column = f"{key}_difference"
            difference, error = float(row[column]), float(row[f"{column}_standard_error"])
            alone[name].append(difference / error)
            cells.append(f"{difference:+.4f} ± {error:.4f}")
            if other is None:
                cells.append("–")
            else:
                beside[name].append((difference - other[k]) / error)
                cells.append(f"{other[k]:+.4f}")
        print("| " + " | ".join(cells) + " |")
    print()
    for name in ("U", "P"):
        print(distribution(f"{name} beside Thol 2016", alone[name]))
        if len(beside[name]) > 2:
            print(distribution(f"{name} beside the other simulations", beside[name]))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
