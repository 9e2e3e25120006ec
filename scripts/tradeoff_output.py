"""Files and the table of tradeoff.py."""

import csv

import h5py
import numpy as np

from carom_deck import COSTS
from carom_script import ScriptError
from tradeoff_errors import ERRORS

TEXT = h5py.string_dtype()
DESCRIPTIONS = {
    "problem": "values of *PARAMETER that make the problem",
    "settings": "how it was computed, where it differs from the deck",
    "dt": "step of time; with TOLERANCE the first one",
    "tolerance": "TOLERANCE, empty for fixed steps",
    "state": "good, or what went wrong",
    "say": "why a run is not good",
    "displacement": "largest error of the displacements over the largest displacement",
    "force": "time integral of the error of the contact force over that of the force",
    "impulse": "error of the whole contact impulse over the impulse",
    "energy": "error of kinetic and strain energy at the end over their largest sum",
    "solves": "solutions with a factor or a diagonal matrix",
    "factorizations": "factorizations of effective matrices",
    "element_updates": "element forces or matrices worked out",
    "cpu_seconds": "processor time of the run",
    "elapsed_seconds": "time of the run",
    "key": "name of the files in the folder points",
    "order": "error = C dt^order over the asymptotic part of the series",
    "deviation": "standard error of the order",
    "slope": "error = C cost^slope over the same part",
    "floor": "error that finer steps do not fall below",
    "cost_at_wanted": "cost at the wanted error, along the points or the fitted line",
}


def columns_of(rows):
    """All columns by name: lists as long as the rows."""
    columns = {
        "problem": [row.point.problem_text for row in rows],
        "settings": [row.point.series for row in rows],
        "dt": [row.point.dt for row in rows],
        "tolerance": [row.point.tolerance or "" for row in rows],
        "state": [row.state for row in rows],
        "say": [row.say for row in rows],
    }
    for name in ERRORS:
        if any(name in row.errors for row in rows):
            columns[name] = [row.errors.get(name, np.nan) for row in rows]
            if any(row.bars for row in rows):
                columns[f"{name}_bar"] = [row.bars.get(name, np.nan) for row in rows]
    for name in [*COSTS, *sorted({n for row in rows for n in row.costs} - set(COSTS))]:
        if any(name in row.costs for row in rows):
            columns[name] = [row.costs.get(name, np.nan) for row in rows]
    columns["key"] = [row.point.key for row in rows]
    return columns


def write_csv(path, rows):
    """A line a point."""
    columns = columns_of(rows)
    try:
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            writer.writerows(zip(*columns.values()))
    except OSError as error:
        raise ScriptError(f"cannot write '{path}': {error.strerror}") from None


def write_h5(path, rows, fits, spent, attributes):
    """/points, a row a run; /fits, a row a series, problem and error; the rest as attributes."""
    try:
        with h5py.File(path, "w") as file:
            file.attrs.update(attributes)
            write_table(file.create_group("points"), columns_of(rows))
            table = {"problem": [], "settings": [], "error": [], "order": [], "deviation": [],
                     "slope": [], "floor": [], "verdict": [], "cost_at_wanted": []}
            for (problem, series, error), fit in fits.items():
                found = spent[(problem, series, error)]
                values = (problem, series, error, fit.order, fit.deviation, fit.slope,
                          np.nan if fit.floor is None else fit.floor, fit.text,
                          np.nan if found is None else found[0])
                for column, value in zip(table.values(), values):
                    column.append(value)
            write_table(file.create_group("fits"), table)
    except OSError as error:
        raise ScriptError(f"cannot write '{path}': {error}") from None


def write_table(group, columns):
    """Columns as datasets with a description each."""
    for name, values in columns.items():
        is_text = any(isinstance(value, str) for value in values)
        data = np.array(values, dtype=TEXT if is_text else float)
        dataset = group.create_dataset(name, data=data)
        dataset.attrs["description"] = DESCRIPTIONS.get(name, name.replace("_", " "))


def print_table(rows, errors, cost, fits, spent, wanted):
    """All points, a block a problem and series, each with its order."""
    shown = [name for name in dict.fromkeys([cost, "solves", "factorizations", "iterations",
                                             "element_updates", "cpu_seconds"])
             if any(row.costs.get(name) for row in rows)]
    head = ["step", *errors, *(name.replace("_", " ") for name in shown), ""]
    last = None
    for row in rows:
        block = (row.point.problem_text, row.point.series)
        if block != last:
            title = f"{block[0]}: {block[1]}" if block[0] else block[1]
            orders = [f"{error}: {fits[(*block, error)].text}" for error in errors]
            at = spent[(*block, errors[0])]
            if at:
                orders.append(f"{at[0]:.3g} {cost.replace('_', ' ')} at {wanted:g}"
                              + ("" if at[1] else ", extrapolated"))
            print(f"\n{title}\n   {'; '.join(orders)}")
            print("".join(f"{word:>17}" for word in head).rstrip())
            last = block
        print(table_line(row, errors, shown))


def table_line(row, errors, shown):
    """A point in a line."""
    step = f"{row.point.dt:.5g}" if row.point.tolerance is None else row.point.tolerance
    words = [step]
    for name in errors:
        if name not in row.errors:
            words.append("-")
            continue
        bar = row.bars.get(name)
        words.append(f"{row.errors[name]:.3e}" + (f" ±{bar:.0e}" if bar else ""))
    for name in shown:
        value = row.costs.get(name)
        words.append("-" if value is None else
                     f"{value:.3g}" if name.endswith("seconds") else f"{value:.0f}")
    say = "" if row.state == "good" else f"  {row.state}: {row.say}"[:100]
    return "".join(f"{word:>17}" for word in words) + say
