"""How far the seeds of one state scatter, beside the errors that their runs print.

    lennard sweep sweep/seeds --out runs/seeds
    python validation/scatter_of_seeds.py runs/seeds

At constant energy each seed has another energy: the scatter about a line in the energy is what the printed errors describe. It reads
`table.csv` of the sweep, and needs the standard library alone.
"""

import csv
import math
import re
import statistics
import sys
from pathlib import Path

#: Names of columns, and how a reader knows them.
PROPERTIES = {
    "speed_of_sound": "w",
    "heat_capacity": "c_v",
    "thermal_pressure_coefficient": "γ_V",
    "density_scaling_exponent": "γ",
}
FEWEST = 4


def states(folder):
    """The rows of the table by state: what the name says without the seed."""
    found = {}
    with open(Path(folder) / "table.csv", newline="", encoding="utf-8") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            found.setdefault(re.sub(r"-seed\d+", "", row["name"]), []).append(row)
    return found


def about_line(x, y):
    """The scatter of y about its line in x, of which two numbers are fitted."""
    mean_x, mean_y = statistics.fmean(x), statistics.fmean(y)
    squares = sum((a - mean_x) ** 2 for a in x)
    slope = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / squares
    rest = sum((b - mean_y - slope * (a - mean_x)) ** 2 for a, b in zip(x, y))
    return math.sqrt(rest / (len(x) - 2))


def line(rows, key):
    """One property of one state; `None` with fewer than four seeds that print an error."""
    columns = ("conserved_energy", key, f"{key}_standard_error")
    numbers = [[float(row[name] or "nan") for name in columns] for row in rows]
    whole = [n for n in numbers if all(map(math.isfinite, n))]
    if len(whole) < FEWEST:
        return None
    energy, value, printed = zip(*whole, strict=True)
    scatter = statistics.stdev(value)
    error = scatter / math.sqrt(len(value))
    rms = math.sqrt(statistics.fmean(s * s for s in printed))
    return (
        f"{PROPERTIES[key]}: {statistics.fmean(value):.5g} ± {error:.2g}, {len(value)} seeds: scatter {scatter:.2g}, "
        f"about a line in the energy {about_line(energy, value):.2g}, printed {rms:.2g}"
    )


def main(folder):
    for name, rows in states(folder).items():
        for key in PROPERTIES:
            if told := line(rows, key):
                print(f"{name}, {told}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("python validation/scatter_of_seeds.py FOLDER: one folder of a sweep")
    main(sys.argv[1])
