# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f make_body.awk -f ../closed_body.awk > body.stl: a flattened drop, 0.1 m long, blunt end first. It stands for a file of yours.
function point(i, j, p,    u, v, r) {
  u = pi * i / rows; v = 2 * pi * j / columns
  r = (i == 0 || i == rows) ? 0 : sin(u) * (1 + 0.45 * cos(u))
  p[1] = -0.05 * cos(u); p[2] = 0.035 * r * cos(v); p[3] = 0.022 * r * sin(v)
}
BEGIN { rows = 40; columns = 40; turned = 1 }
