# SPDX-License-Identifier: GPL-3.0-or-later
"""The colors of pictures."""
import numpy as np

# Of each level: edges, lit faces, faces of flat patches and sections. Deeper levels repeat the last.
LEVEL_EDGE = np.array([(106, 122, 143), (20, 121, 143), (214, 126, 20), (178, 24, 52), (96, 60, 150), (40, 110, 50),
                       (120, 80, 40), (30, 30, 30)], dtype=np.uint8)
LEVEL_LIT = np.array([(226, 230, 236), (205, 226, 229), (243, 222, 190), (233, 196, 193), (214, 202, 232),
                      (204, 226, 204), (224, 212, 198), (205, 205, 205)], dtype=np.uint8)
LEVEL_FLAT = np.array([(244, 246, 249), (222, 239, 241), (253, 236, 208), (250, 217, 213), (232, 222, 245),
                       (220, 240, 220), (238, 228, 216), (222, 222, 222)], dtype=np.uint8)
# Of patches (Okabe and Ito's colors, lightened, then repeated).
PATCH = np.array([(240, 190, 90), (130, 195, 235), (90, 190, 150), (240, 228, 120), (110, 150, 205), (225, 135, 95),
                  (215, 165, 195), (170, 170, 170)], dtype=np.uint8)
INK = (34, 41, 54)
NOTHING = (191, 191, 191)  # where a field is not finite

# Maps in which equal steps of a value look equal; the last three are for values with a middle.
MAPS = ("viridis", "cividis", "magma", "inferno", "plasma", "coolwarm", "RdBu_r", "PuOr_r")


def of_levels(palette, levels):
    return palette[np.minimum(levels, len(palette) - 1)]


def of_patches(patches):
    return PATCH[patches % len(PATCH)]
