# SPDX-License-Identifier: GPL-3.0-or-later
"""What a case measured, against the bounds of its expected.csv: rows quantity, at_least, at_most, source; an empty bound is none."""
import csv
import math


def student_95(n):
    """Student's factor from the standard error of a mean of `n` values to its bound of 95 %, infinite for fewer than two."""
    if n < 2:
        return math.inf
    freedom, low, high = n - 1, 0.0, math.pi / 2

    def probability(angle):  # M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 26.7.3 and 26.7.4
        odd = freedom % 2
        term = math.cos(angle) if odd else 1.0
        total = term if freedom > 1 else 0.0
        for k in range(3 if odd else 2, freedom, 2):
            term *= (k - 1) / k * math.cos(angle) ** 2
            total += term
        return 2 / math.pi * (angle + math.sin(angle) * total) if odd else math.sin(angle) * total
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if probability(middle) < 0.95 else (low, middle)
    return math.sqrt(freedom) * math.tan(low)


def rows_of(table):
    """The rows of a table by the names of its columns, without its comments."""
    with open(table, encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def bounds_of(table):
    """By quantity the smallest and the largest value that is good."""
    return {row["quantity"]: (float(row.get("at_least") or -math.inf), float(row.get("at_most") or math.inf)) for row in rows_of(table)}


def misses(where, measured, bounds):
    """A line for each quantity that is out of its bounds, or not a number."""
    for quantity, value in measured.items():
        low, high = bounds[quantity]
        if not low <= value <= high:
            yield f"NOT AS EXPECTED: {where}: {quantity} is {value:.4g}, expected {low:g} to {high:g}"


def all_within(measured, table):
    """Prints each quantity with its bounds; whether all lie within them."""
    bounds = bounds_of(table)
    for quantity, value in measured.items():
        low, high = bounds[quantity]
        print(f"{quantity:36} {value:12.4g}   {low:g} to {high:g}   {'ok' if low <= value <= high else 'NOT AS EXPECTED'}")
    return not any(misses("", measured, bounds))
