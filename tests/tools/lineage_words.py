# SPDX-License-Identifier: GPL-3.0-or-later
"""Words of `/PAMR/lineage` of format 2 taken apart, as docs/file-format-lineage.md describes them."""
import pathlib
import re

import numpy as np

TABLE = pathlib.Path(__file__).parents[2] / "lib" / "pamr" / "mesh" / "closure_state_table.hpp"
FAMILY_SIZES = [len(children.split()) for children in re.findall(r'^    \{.*"([0-9 ]+)"\}', TABLE.read_text(), re.M)]
"""Cells of a family by its state."""
assert FAMILY_SIZES[:11] == [1] + 6 * [2] + 4 * [4]

STATE_OF_CODE = np.repeat(np.arange(len(FAMILY_SIZES)), FAMILY_SIZES)
CHILD_OF_CODE = np.concatenate([np.arange(size) for size in FAMILY_SIZES])


class Lineage:
    """Arrays of state, child, broken, level and path, one entry a cell."""

    def __init__(self, words):
        words = np.asarray(words).astype(np.int64)
        code = words & 0x7FF
        self.state, self.child = STATE_OF_CODE[code], CHILD_OF_CODE[code]
        self.broken, self.level, self.path = words >> 11 & 1, words >> 12 & 0xFF, words >> 20
        self.is_regular = code == 0
        self.is_member = (code != 0) & (self.broken == 0)
        """Belongs to a whole family."""
        self.child_in_whole = np.where(self.is_member, self.child, 0)
