// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

/// Prisms, pyramids and quadrangles as tetrahedra and triangles. The diagonal of each quadrangle goes through its node
/// of the smallest number, so that the cells on both sides of a face, and the quadrangle in a group on it, are cut
/// alike without knowing each other. Source: J. Dompierre, P. Labbe, M.-G. Vallet, R. Camarero, "How to subdivide
/// pyramids, prisms, and hexahedra into tetrahedra", 8th International Meshing Roundtable, 1999. Local.
namespace pamr::io {

/// Whether elements of this type (`element_type`) are cut.
bool is_cut(int type);

/// Three tetrahedra of a prism, two of a pyramid, none of other types: they join the node of the smallest number with
/// the faces that do not have it. Nodes of a prism: those of a triangle, seen counter-clockwise from the other triangle,
/// then those of the other one above them; of a pyramid: the quadrangle, seen counter-clockwise from the apex, then the
/// apex. Of such a cell all tetrahedra have positive volumes unless a quadrangle is twisted far.
std::vector<std::array<std::int64_t, 4>> tetrahedra_of(int type, std::span<const std::int64_t> nodes);

/// Two triangles of a quadrangle, which turn as it does; none of other types.
std::vector<std::array<std::int64_t, 3>> triangles_of(int type, std::span<const std::int64_t> nodes);

/// One sentence on how many elements of each type became how many tetrahedra and triangles; empty where there are none.
std::string text_of_cut(const std::map<int, std::int64_t>& n_of_type);

}  // namespace pamr::io
