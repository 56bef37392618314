# SPDX-License-Identifier: GPL-3.0-or-later
"""What a case measured, against the bounds of its expected.csv."""
import csv


def all_within(measured, expected_file):
    """Prints each quantity with its bounds; whether all lie within them. expected_file: rows quantity, at_least, at_most."""
    with open(expected_file, encoding="ascii") as file:
        expected = {row["quantity"]: row for row in csv.DictReader(file)}
    good = True
    for quantity, value in measured.items():
        low, high = float(expected[quantity]["at_least"]), float(expected[quantity]["at_most"])
        ok = low <= value <= high
        good = good and ok
        print(f"{quantity:36} {value:12.4g}   {low:g} to {high:g}   {'ok' if ok else 'NOT AS EXPECTED'}")
    return good
