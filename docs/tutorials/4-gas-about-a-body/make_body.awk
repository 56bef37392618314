# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f make_body.awk > body.stl: a flattened drop, 0.1 m long, blunt end first. It stands for a file of yours.
function point(i, j, p,    u, v, r) {
  u = pi * i / rows; v = 2 * pi * j / columns
  r = (i == 0 || i == rows) ? 0 : sin(u) * (1 + 0.45 * cos(u))
  p[1] = -0.05 * cos(u); p[2] = 0.035 * r * cos(v); p[3] = 0.022 * r * sin(v)
}
function triangle(a, b, c, d, e, f,    p, q, r) {
  point(a, b, p); point(c, d, q); point(e, f, r)
  printf "facet normal 0 0 0\nouter loop\nvertex %.9g %.9g %.9g\nvertex %.9g %.9g %.9g\nvertex %.9g %.9g %.9g\nendloop\nendfacet\n", \
    p[1], p[2], p[3], r[1], r[2], r[3], q[1], q[2], q[3]
}
BEGIN {
  pi = 3.14159265358979; rows = 40; columns = 40
  print "solid body"
  for (i = 0; i < rows; ++i)
    for (j = 0; j < columns; ++j) {
      k = (j + 1) % columns
      if (i > 0) triangle(i, j, i + 1, j, i, k)
      if (i < rows - 1) triangle(i, k, i + 1, j, i + 1, k)
    }
  print "endsolid body"
}
