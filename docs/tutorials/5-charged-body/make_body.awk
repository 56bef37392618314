# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f make_body.awk > body.stl: a grain with three lobes, bent, 2 Debye lengths long, over z = 0. It stands for a file
# of yours.
function point(i, j, p,    u, v, r, s) {
  u = pi * i / rows; v = 2 * pi * j / columns; s = sin(u)
  if (i == 0 || i == rows) { s = 0; v = 0 }
  r = 1 + 0.22 * cos(3 * v) * s * s * s
  p[1] = cos(u); p[2] = 0.5 * r * s * cos(v) + 0.2 * p[1] * p[1]; p[3] = 1.4 + 0.45 * r * s * sin(v) + 0.3 * p[1]
}
function triangle(a, b, c, d, e, f,    p, q, r) {
  point(a, b, p); point(c, d, q); point(e, f, r)
  printf "facet normal 0 0 0\nouter loop\nvertex %.9g %.9g %.9g\nvertex %.9g %.9g %.9g\nvertex %.9g %.9g %.9g\nendloop\nendfacet\n", \
    p[1], p[2], p[3], q[1], q[2], q[3], r[1], r[2], r[3]
}
BEGIN {
  pi = 3.14159265358979; rows = 48; columns = 48
  print "solid body"
  for (i = 0; i < rows; ++i)
    for (j = 0; j < columns; ++j) {
      k = (j + 1) % columns
      if (i > 0) triangle(i, j, i + 1, j, i, k)
      if (i < rows - 1) triangle(i, k, i + 1, j, i + 1, k)
    }
  print "endsolid body"
}
