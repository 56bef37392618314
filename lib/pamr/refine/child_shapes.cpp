// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/child_shapes.hpp"

#include <cstring>
#include <memory>

namespace pamr::refine {

namespace {

using mesh::tet::edge_to_corner;
using Codes = std::array<std::int8_t, 4>;

constexpr unsigned codes_of(const Codes& nodes) {
  unsigned codes = 0;
  for (const auto code : nodes) codes |= 1U << code;
  return codes;
}

/// Corners that a node lies at: twice its barycentric coordinates.
constexpr std::array<int, 4> barycentric(int code) {
  std::array<int, 4> b{};
  if (code < 4) {
    b[at(code)] = 2;
  } else {
    for (const int corner : edge_to_corner[at(code - 4)]) b[at(corner)] = 1;
  }
  return b;
}

constexpr int determinant(const Codes& nodes) {
  std::array<std::array<int, 3>, 3> d{};
  const auto o = barycentric(nodes[0]);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) d[at(i)][at(k)] = barycentric(nodes[at(i + 1)])[at(k + 1)] - o[at(k + 1)];
  return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
         d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

/// The squared length of a vector whose barycentric coordinates u add up to nothing is minus the sum of u_i u_j l_ij^2.
constexpr ChildShape make_shape(const Codes& nodes) {
  ChildShape shape;
  const int volume = determinant(nodes);
  shape.squared_volume = static_cast<double>(volume * volume);
  shape.nodes = volume > 0 ? nodes : Codes{nodes[0], nodes[1], nodes[3], nodes[2]};
  std::array<int, 6> factor{};
  for (const auto [p, q] : edge_to_corner) {
    const auto a = barycentric(nodes[at(p)]), b = barycentric(nodes[at(q)]);
    for (int e = 0; e < 6; ++e) {
      const auto [i, j] = edge_to_corner[at(e)];
      factor[at(e)] -= (a[at(i)] - b[at(i)]) * (a[at(j)] - b[at(j)]);
    }
  }
  for (std::size_t e = 0; e < 6; ++e) shape.factor[e] = static_cast<double>(factor[e]);
  shape.codes = codes_of(nodes);
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [p, q] = edge_to_corner[e];
    shape.pair[e] = static_cast<std::uint8_t>(pair_of(shape.nodes[at(p)], shape.nodes[at(q)]));
  }
  return shape;
}

constexpr ShapeTable make_table() {
  ShapeTable table;
  std::array<std::uint8_t, 1024> known{};  // by the bits of the codes: shape + 1
  std::uint8_t n = 0;
  const auto add = [&](const Codes& nodes) {
    auto& entry = known[codes_of(nodes)];
    if (entry == 0) {
      table.shape[n] = make_shape(nodes);
      entry = ++n;
    }
    return static_cast<std::uint8_t>(entry - 1);
  };
  for (std::size_t s = 0; s < mesh::closure_states.size(); ++s) {
    const auto& family = mesh::closure_states[s].family;
    for (int c = 0; c < family.n_children; ++c) {
      const auto shape = add(family.child_to_node[at(c)]);
      table.of_child[s][at(c)] = shape;
      table.sets[shape] |= std::uint64_t{1} << mesh::closure_states[s].mask;
    }
    for (int c = family.n_children; c < max_children; ++c) table.of_child[s][at(c)] = table.of_child[s][0];
  }
  for (int d = 0; d < 3; ++d) {
    std::size_t inner = 0;
    for (int e = 0; e < 6; ++e)
      for (int g = e + 1; g < 6; ++g)
        if (e != d && g != d && e + d != 5 && g + d != 5 && e + g != 5)
          table.of_inner[at(d)][inner++] = add({static_cast<std::int8_t>(4 + d), static_cast<std::int8_t>(9 - d),
                                                static_cast<std::int8_t>(4 + e), static_cast<std::int8_t>(4 + g)});
  }
  return table;
}

}  // namespace

constexpr ShapeTable shape_table = make_table();

namespace {

/// Shapes are measured two at a time, in vectors of the compiler's.
constexpr std::size_t n_lanes = 2;
using Doubles = double __attribute__((vector_size(16)));
using Sets = std::int64_t __attribute__((vector_size(16)));

/// A vector's numbers, from a place in memory that is a multiple of its size.
template <class Vector, class T>
Vector load(const T* numbers) {
  Vector vector;
  std::memcpy(&vector, std::assume_aligned<sizeof(vector)>(numbers), sizeof(vector));
  return vector;
}

/// The shape has midpoints, all of them on these edges.
constexpr bool is_listed(const ChildShape& shape, unsigned edges) {
  const unsigned midpoints = shape.codes >> 4U;
  return midpoints != 0 && (midpoints & ~edges) == 0;
}

constexpr std::size_t n_listed(unsigned edges) {
  std::size_t n = 0;
  for (const auto& shape : shape_table.shape) n += is_listed(shape, edges) ? 1 : 0;
  return (n + n_lanes - 1) / n_lanes * n_lanes;
}

constexpr std::array<std::size_t, 65> make_begins() {
  std::array<std::size_t, 65> begin{};
  for (unsigned edges = 0; edges < 64; ++edges) begin[edges + 1] = begin[edges] + n_listed(edges);
  return begin;
}
constexpr auto begin_of_list = make_begins();

/// For each set of edges the shapes whose midpoints lie on them, one list behind another, each filled up with its last
/// shape. That of all edges is in the order of the shapes.
struct Lists {
  static constexpr std::size_t n = begin_of_list[64];
  alignas(sizeof(Doubles)) std::array<std::array<double, n>, 6> factor{};
  alignas(sizeof(Doubles)) std::array<double, n> squared_volume{};
  alignas(sizeof(Doubles)) std::array<std::uint64_t, n> sets{};
  std::array<std::uint8_t, n> shape{};
};

constexpr Lists make_lists() {
  Lists lists;
  for (unsigned edges = 0; edges < 64; ++edges) {
    std::size_t i = begin_of_list[edges];
    const auto add = [&](std::size_t s) {
      for (std::size_t e = 0; e < 6; ++e) lists.factor[e][i] = shape_table.shape[s].factor[e];
      lists.squared_volume[i] = shape_table.shape[s].squared_volume;
      lists.sets[i] = shape_table.sets[s];
      lists.shape[i++] = static_cast<std::uint8_t>(s);
    };
    std::size_t last = 0;
    for (std::size_t s = 0; s < max_child_shapes; ++s)
      if (is_listed(shape_table.shape[s], edges)) add(last = s);
    while (i < begin_of_list[edges + 1]) add(last);
  }
  return lists;
}
constexpr Lists lists = make_lists();

}  // namespace

double cubed_ratio(int shape, const std::array<double, 6>& squared, double scale) {
  const auto& of_table = shape_table.shape[at(shape)];
  const auto& f = of_table.factor;
  const double sum = (f[0] * squared[0] + f[1] * squared[1]) + (f[2] * squared[2] + f[3] * squared[3]) +
                     (f[4] * squared[4] + f[5] * squared[5]);
  return scale * of_table.squared_volume / (sum * sum * sum);
}

std::uint64_t measure_child_shapes(EdgeMask edges, const std::array<double, 6>& squared, double scale, double limit,
                                   std::array<double, max_child_shapes>& ratio) {
  const auto lane = [](const auto& array, std::size_t i) { return load<Doubles>(&array[i]); };
  const auto& f = lists.factor;
  Sets below{};
  for (std::size_t i = begin_of_list[edges]; i < begin_of_list[at(edges + 1)]; i += n_lanes) {
    const Doubles sum = (lane(f[0], i) * squared[0] + lane(f[1], i) * squared[1]) +
                        (lane(f[2], i) * squared[2] + lane(f[3], i) * squared[3]) +
                        (lane(f[4], i) * squared[4] + lane(f[5], i) * squared[5]);
    const Doubles cubed = scale * lane(lists.squared_volume, i) / (sum * sum * sum);
    below |= ~(cubed >= limit) & load<Sets>(&lists.sets[i]);
    for (std::size_t k = 0; k < n_lanes; ++k) ratio[lists.shape[i + k]] = cubed[k];
  }
  return static_cast<std::uint64_t>(below[0] | below[1]);
}

}  // namespace pamr::refine
