# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbering of a tetrahedron's faces and edges, as `mesh/tet.hpp` has it: for scripts that read mesh files."""
import numpy as np

FACE_TO_CORNER = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])  # face i opposite corner i, outward
EDGE_TO_CORNER = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])
