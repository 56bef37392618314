# SPDX-License-Identifier: GPL-3.0-or-later
# A regular octahedron about (0, 0, height), its corners `size` from there (both by -v), for closed_body.awk of the tutorials: all
# of its edges are sharp, so that each of its sides becomes a patch.
function point(i, j, p) {
  p[1] = i == 1 ? size * cos(pi / 2 * j) : 0
  p[2] = i == 1 ? size * sin(pi / 2 * j) : 0
  p[3] = height + size * (1 - i)
}
BEGIN {
  rows = 2
  columns = 4
  turned = 0
}
