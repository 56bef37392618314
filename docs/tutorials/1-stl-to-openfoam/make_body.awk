# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f make_body.awk -f ../closed_body.awk > body.stl: a pebble with three lobes, bent, 0.1 m long, as a text STL. It stands for a file of yours.
function point(i, j, p,    u, v, r, s) {
  u = pi * i / rows; v = 2 * pi * j / columns; s = sin(u)
  if (i == 0 || i == rows) { s = 0; v = 0 }
  r = 1 + 0.22 * cos(3 * v) * s * s * s
  p[1] = 0.05 * cos(u); p[2] = 0.025 * r * s * cos(v) + 4 * p[1] * p[1]; p[3] = 0.02 * r * s * sin(v)
}
BEGIN { rows = 48; columns = 48 }
