# SPDX-License-Identifier: GPL-3.0-or-later
# The text STL of a closed body, for the make_body.awk of a tutorial before it, which has point(i, j, p): the point p of row i (0
# and `rows` are the poles) and column j, and sets rows, columns, and turned = 1 if its triangles face inward otherwise.
function triangle(a, b, c, d, e, f,    p, q, r) {
  point(a, b, p)
  if (turned) { point(e, f, q); point(c, d, r) } else { point(c, d, q); point(e, f, r) }
  printf "facet normal 0 0 0\nouter loop\nvertex %.9g %.9g %.9g\nvertex %.9g %.9g %.9g\nvertex %.9g %.9g %.9g\nendloop\nendfacet\n", \
    p[1], p[2], p[3], q[1], q[2], q[3], r[1], r[2], r[3]
}
BEGIN {
  pi = 3.14159265358979
  print "solid body"
  for (i = 0; i < rows; ++i)
    for (j = 0; j < columns; ++j) {
      k = (j + 1) % columns
      if (i > 0) triangle(i, j, i + 1, j, i, k)
      if (i < rows - 1) triangle(i, k, i + 1, j, i + 1, k)
    }
  print "endsolid body"
}
