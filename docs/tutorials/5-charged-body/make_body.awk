# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f make_body.awk -f ../closed_body.awk > body.stl: a grain with three lobes, bent, 2 Debye lengths long, over z = 0. It stands for a file
# of yours.
function point(i, j, p,    u, v, r, s) {
  u = pi * i / rows; v = 2 * pi * j / columns; s = sin(u)
  if (i == 0 || i == rows) { s = 0; v = 0 }
  r = 1 + 0.22 * cos(3 * v) * s * s * s
  p[1] = cos(u); p[2] = 0.5 * r * s * cos(v) + 0.2 * p[1] * p[1]; p[3] = 1.4 + 0.45 * r * s * sin(v) + 0.3 * p[1]
}
BEGIN { rows = 48; columns = 48 }
