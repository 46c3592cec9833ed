"""The states of a sweep beside the equations of state, as a page of the book.

    lennard sweep sweep/states --out runs/states
    python validation/beside_equations.py runs/states > validation/results/states.md

It reads `sweep.json`, `equations.csv`, `beside_equations.csv` and `table.csv` of the sweep, and needs the standard library alone. A sweep over
several models, or with points that are not at constant density and temperature, is refused.
"""

import csv
import json
import math
import sys
import tomllib
from pathlib import Path

SYMBOLS = {
    "potential_energy": "U",
    "pressure": "P",
    "heat_capacity": "c_v",
    "heat_capacity_pressure": "c_p",
    "thermal_pressure_coefficient": "γ_V",
    "isothermal_compressibility": "κ_T",
    "isentropic_compressibility": "κ_S",
    "thermal_expansion": "α_P",
    "speed_of_sound": "w",
    "joule_thomson_coefficient": "μ_JT",
    "grueneisen_parameter": "Γ",
    "density_scaling_exponent": "γ",
}


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def column(equation):
    """The column of an equation."""
    return equation.replace("-", "_")


def number(text):
    return float(text) if text else math.nan


def measured(value, error):
    """A number with its error in brackets, in the last two digits of the error."""
    if not (math.isfinite(error) and error > 0):
        return f"{value:.5g}"
    decimals = max(0, 1 - math.floor(math.log10(error)))
    if round(error * 10**decimals) >= 100:
        # 0.00996 has the digits 10, of one decimal less.
        decimals = max(0, decimals - 1)
    digits = round(error * 10**decimals)
    return f"{value:.{decimals}f}({digits})"


def line(cells):
    return "| " + " | ".join(cells) + " |"


def equations_table(judged):
    """χ² per point, and the largest distance in errors: a row for each property, a column for each equation."""
    names = list(dict.fromkeys(row["equation"] for row in judged))
    properties = [p for p in SYMBOLS if any(row["property"] == p for row in judged)]
    yield line(["Property", *names])
    yield line(["---"] * (len(names) + 1))
    for key in properties:
        cells = [SYMBOLS[key]]
        for name in names:
            found = [r for r in judged if r["property"] == key and r["equation"] == name]
            if not found:
                cells.append("–")
                continue
            row = found[0]
            cells.append(f"{row['chi_squared_per_point']} ({row['points']} points, {row['largest_in_errors']})")
        yield line(cells)


def state_tables(beside, names):
    """Every property of every state with its error, and the values of the equations beside it."""
    for key in SYMBOLS:
        of_property = [row for row in beside if row["property"] == key]
        if not of_property:
            continue
        equations = [e for e in names if any(row[column(e)] not in ("", "nan") for row in of_property)]
        own_error = [row["error_of_difference"] != row["standard_error"] for row in of_property]
        at_given = ["error at given T"] if any(own_error) else []
        yield f"### {SYMBOLS[key]} ({key.replace('_', ' ')})"
        yield ""
        yield line(["ρ", "T", "measured", *at_given, *(names[e] for e in equations)])
        yield line(["---"] * (len(equations) + len(at_given) + 3))
        for row in sorted(of_property, key=lambda r: (number(r["density"]), number(r["temperature"]))):
            error = number(row["standard_error"])
            cells = [f"{number(row['density']):.4g}", f"{number(row['temperature']):.4f}"]
            cells.append(measured(number(row["measured"]), error))
            if at_given:
                of_difference = number(row["error_of_difference"])
                cells.append("–" if math.isnan(of_difference) else f"{of_difference:.2g}")
            for name in equations:
                value = number(row[column(name)])
                cells.append("–" if math.isnan(value) else f"{value:.5g}")
            yield line(cells)
        yield ""


def the_model(compared):
    """The one model of all runs, in words."""
    models = sorted({run["model"] for run in compared})
    if len(models) != 1:
        sys.exit(f"a page is of one model\n  found: {'; '.join(models) or 'no finished run'}")
    return models[0]


def is_at_constant_temperature(scene):
    """Whether every measured stage has a bath and no barostat."""
    measured_stages = [stage for stage in scene["stage"] if stage.get("measure", True)]
    return all("thermostat" in stage and "barostat" not in stage for stage in measured_stages)


def main(folder):
    folder = Path(folder)
    with open(folder / "sweep.json", encoding="utf-8") as file:
        record = json.load(file)
    compared = {p["name"]: p["compared"] for p in record["points"] if p["compared"]}
    model = the_model(compared.values())
    for name in compared:
        with open(folder / name / "scene.toml", "rb") as file:
            if not is_at_constant_temperature(tomllib.load(file)):
                sys.exit(f"a page is of runs at constant density and temperature\n  found: {name}, which is not")
    cards = [run["card"] for run in compared.values() if run["card"]]
    names = {equation["key"]: equation["name"] for card in cards for equation in card["equations"]}
    judged = rows(folder / "equations.csv")
    beside = rows(folder / "beside_equations.csv")
    points = rows(folder / "table.csv")
    states = len({row["point"] for row in beside})
    steps = sorted({int(row["steps"]) for row in points if row["steps"] not in ("", "0")})
    atoms = sorted({row["atoms"] for row in points if row["atoms"] not in ("", "0")})
    between = f"{steps[0]:,}" if len(steps) == 1 else f"{steps[0]:,} to {steps[-1]:,}"
    print("# States beside the equations")
    print()
    print(
        f"{states} states at constant density and temperature, {between} measured steps each, {', '.join(atoms)} particles.\n"
        f"The model is: {model}. Made by these commands:"
    )
    print()
    print("```sh")
    print("lennard sweep sweep/states --out runs/states")
    print("python validation/beside_equations.py runs/states > validation/results/states.md")
    print("```")
    print()
    for count in reversed(steps):
        some = [row for row in points if row["steps"] == str(count)]
        at = ", ".join(f"({number(r['density']):.4g}, {number(r['temperature']):.3f})" for r in some)
        print(f"- {count:,} steps at (ρ, T) = {at}.")
    print()
    print("## χ² of each equation")
    print()
    print(
        "Each entry: χ² per point, the number of points, and the largest distance in errors. An equation that is exact to the errors of the runs has 1. U and P are\n"
        "compared for as many particles in a closed box, less the bias of the cutoff where it is known. Their errors are at the given T: the correlation of U, P and T\n"
        "makes them smaller than the printed ones. Other properties are compared for an infinite system. The bias is known to a third of itself, and no error counts the\n"
        "rest."
    )
    print()
    for text in equations_table(judged):
        print(text)
    print()
    print("## Every state")
    print()
    print(
        "Digits in brackets are one standard error in the last digits. A run that gives no error for a property has no row. Values of equations are of an infinite system,\n"
        "at the measured T. The differences that χ² is made of stand in `beside_equations.csv`, with their errors."
    )
    print()
    for text in state_tables(beside, names):
        print(text)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("python validation/beside_equations.py FOLDER: one folder of a sweep")
    main(sys.argv[1])
