// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/cut_elements.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/io/elements/element_parts.hpp"
#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/validate/validate.hpp"
#include "support/dice.hpp"
#include "support/error_of.hpp"

namespace pamr::io {
namespace cut_elements_test {

using geometry::Vec3;
using Tags = std::vector<std::int64_t>;
using Face = std::vector<std::size_t>;

/// A cell without symmetry, whose quadrangles are planar, and its quadrangles by the places of their nodes.
struct Shape {
  int type;
  std::vector<Vec3> point;
  std::vector<Face> quadrangle;
  std::size_t n_triangles;  ///< faces of the cell itself
  double volume;
};

/// A frustum: the upper triangle is half of the lower one, about (1, 2, 3).
Shape prism() {
  const std::vector<Vec3> base{{0, 0, 0}, {2, 0.3, 0}, {0.4, 1.7, 0}};
  auto point = base;
  for (const auto& p : base) point.push_back(0.5 * (p + Vec3{1, 2, 3}));
  const double area = 0.5 * (2 * 1.7 - 0.4 * 0.3);
  return {element_type::prism, point, {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}, 2, area * 3 / 3 * 7 / 8};
}

Shape pyramid() {
  return {element_type::pyramid,
          {{0, 0, 0}, {2, 0.3, 0}, {2.5, 1.9, 0}, {0.4, 1.7, 0}, {1.1, 0.2, 1.5}},
          {{0, 1, 2, 3}},
          4,
          // half the cross product of the diagonals of the base
          0.5 * (2.5 * (1.7 - 0.3) - 1.9 * (0.4 - 2)) * 1.5 / 3};
}

/// The faces that one of the tetrahedra has, ascending.
std::vector<Tags> outer_faces(const std::vector<std::array<std::int64_t, 4>>& cells) {
  std::map<Tags, int> n;
  for (const auto& cell : cells)
    for (const auto& corner : mesh::tet::face_to_corner) {
      Tags face;
      for (const auto c : corner) face.push_back(cell[at(c)]);
      std::sort(face.begin(), face.end());
      ++n[face];
    }
  std::vector<Tags> faces;
  for (const auto& [face, count] : n)
    if (count == 1) faces.push_back(face);
  return faces;
}

void check(const Shape& shape, const Tags& tag) {
  const auto cells = tetrahedra_of(shape.type, tag);
  ASSERT_EQ(cells.size(), shape.type == element_type::prism ? 3U : 2U);
  double sum = 0;
  for (const auto& cell : cells) {
    geometry::TetPoints p;
    for (std::size_t k = 0; k < 4; ++k)
      p[k] = shape.point[at(std::find(tag.begin(), tag.end(), cell[k]) - tag.begin())];
    EXPECT_GT(geometry::volume(p), 0);
    sum += geometry::volume(p);
  }
  EXPECT_NEAR(sum, shape.volume, 1e-14);
  auto faces = outer_faces(cells);
  EXPECT_EQ(faces.size(), shape.n_triangles + 2 * shape.quadrangle.size());
  for (const auto& places : shape.quadrangle) {
    Tags quadrangle;
    for (const auto place : places) quadrangle.push_back(tag[place]);
    const auto least = std::min_element(quadrangle.begin(), quadrangle.end()) - quadrangle.begin();
    const auto opposite = quadrangle[at(least + 2) % 4];
    for (auto triangle : triangles_of(element_type::quadrangle, quadrangle)) {
      EXPECT_EQ(std::count(triangle.begin(), triangle.end(), quadrangle[at(least)]), 1);
      EXPECT_EQ(std::count(triangle.begin(), triangle.end(), opposite), 1);
      std::sort(triangle.begin(), triangle.end());
      EXPECT_EQ(std::erase(faces, Tags(triangle.begin(), triangle.end())), 1U) << "a face of the cell is cut otherwise";
    }
  }
  EXPECT_EQ(faces.size(), shape.n_triangles);
}

TEST(CutElements, FillTheCellForEveryOrderOfNumbersAndMeetTheirNeighbors) {
  for (const auto& shape : {prism(), pyramid()}) {
    Tags tag(shape.point.size());
    std::iota(tag.begin(), tag.end(), 3);
    do check(shape, tag);
    while (std::next_permutation(tag.begin(), tag.end()));
  }
}

TEST(CutElements, KeepTheSenseOfAQuadrangle) {
  Tags tag{4, 7, 5, 9};
  do {
    for (const auto& triangle : triangles_of(element_type::quadrangle, tag)) {
      std::vector<std::ptrdiff_t> place;
      for (const auto node : triangle) place.push_back(std::find(tag.begin(), tag.end(), node) - tag.begin());
      const int n_descents =
          (place[0] > place[1] ? 1 : 0) + (place[1] > place[2] ? 1 : 0) + (place[2] > place[0] ? 1 : 0);
      EXPECT_EQ(n_descents, 1);  // ascending but for the way back to the begin
    }
  } while (std::next_permutation(tag.begin(), tag.end()));
}

TEST(CutElements, OthersGiveNothing) {
  const Tags nodes{1, 2, 3, 4, 5, 6};
  EXPECT_TRUE(tetrahedra_of(element_type::tetrahedron, nodes).empty());
  EXPECT_TRUE(triangles_of(element_type::triangle, nodes).empty());
  EXPECT_FALSE(is_cut(element_type::hexahedron));
}

TEST(CutElements, AreCountedInOneSentence) {
  EXPECT_EQ(text_of_cut({}), "");
  EXPECT_EQ(text_of_cut({{element_type::prism, 2}, {element_type::pyramid, 1}}),
            "2 prisms and 1 pyramid were cut into 8 tetrahedra");
  EXPECT_EQ(text_of_cut({{element_type::quadrangle, 1}}), "1 quadrangle was cut into 2 triangles");
  EXPECT_EQ(text_of_cut({{element_type::prism, 1}, {element_type::quadrangle, 3}}),
            "1 prism and 0 pyramids were cut into 3 tetrahedra, 3 quadrangles into 6 triangles");
}

/// Layers of prisms over a random triangulation of the unit square, with pyramids on the side x = 1 and tetrahedra on
/// top, all numbers drawn.
struct Layers {
  static constexpr double tall = 0.3, wide = 0.25, high = 0.2;
  struct Element {
    int type;
    Tags nodes;
    std::int64_t group;
  };
  std::vector<Vec3> point;
  std::vector<Element> element;
  double volume = tall + tall * wide / 3 + high / 3;

  Layers(std::int64_t n, std::uint64_t seed) : dice_(seed) {
    const std::vector<double> height{0, 0.04 + 0.1 * dice_.unit(), 0.2, tall};
    n_ = n;
    for (const auto z : height)
      for (std::int64_t k = 0; k < (n + 1) * (n + 1); ++k)
        point.push_back({static_cast<double>(k / (n + 1)) / static_cast<double>(n),
                         static_cast<double>(k % (n + 1)) / static_cast<double>(n), z});
    for (std::int64_t k = 0; k < plane(); ++k) {
      const auto p = point[at(k)];
      const auto shift = 0.25 / static_cast<double>(n) * Vec3{dice_.symmetric(), dice_.symmetric(), 0};
      if (p.x * (1 - p.x) * p.y * (1 - p.y) > 0)
        for (std::int64_t layer = 3; layer >= 0; --layer)
          point[at(k + layer * plane())] = point[at(k + layer * plane())] + shift;
    }
    for (std::int64_t i = 0; i < n; ++i)
      for (std::int64_t j = 0; j < n; ++j) {
        const auto a = node(i, j), b = node(i + 1, j), c = node(i + 1, j + 1), d = node(i, j + 1);
        const bool falls = dice_.below(2) == 1;
        stack(a, b, falls ? d : c);
        stack(falls ? b : a, c, d);
      }
    for (std::int64_t layer = 0; layer < 3; ++layer)
      for (std::int64_t i = 0; i < n; ++i) {
        add_quadrangle(node(0, i + 1), node(0, i), layer, 2);
        add_quadrangle(node(i, 0), node(i + 1, 0), layer, 3);
        add_quadrangle(node(i + 1, n), node(i, n), layer, 4);
        add_pyramid(layer, i);
      }
    renumber();
    dice_.shuffle(element);
  }

 private:
  std::int64_t plane() const { return (n_ + 1) * (n_ + 1); }
  std::int64_t node(std::int64_t i, std::int64_t j) const { return i * (n_ + 1) + j; }
  std::int64_t middle_of(const Tags& nodes, const Vec3& shift) {
    Vec3 sum{0, 0, 0};
    for (const auto k : nodes) sum = sum + point[at(k)];
    point.push_back((1 / static_cast<double>(nodes.size())) * sum + shift);
    return std::ssize(point) - 1;
  }

  void stack(std::int64_t a, std::int64_t b, std::int64_t c) {
    const auto m = plane();
    element.push_back({element_type::triangle, {a, c, b}, 1});
    for (std::int64_t z = 0; z < 3 * m; z += m) {
      Tags prism{a + z, b + z, c + z, a + z + m, b + z + m, c + z + m};
      const auto turn = static_cast<std::ptrdiff_t>(dice_.below(3));
      std::rotate(prism.begin(), prism.begin() + turn, prism.begin() + 3);
      std::rotate(prism.begin() + 3, prism.begin() + 3 + turn, prism.end());
      element.push_back({element_type::prism, prism, 7});
    }
    const Tags top{a + 3 * m, b + 3 * m, c + 3 * m};
    const auto apex = middle_of(top, {0, 0, high});
    element.push_back({element_type::tetrahedron, {top[0], top[1], top[2], apex}, 8});
  }

  Tags quadrangle(std::int64_t a, std::int64_t b, std::int64_t layer) const {
    const auto z = layer * plane();
    return {a + z, b + z, b + z + plane(), a + z + plane()};
  }
  void add_quadrangle(std::int64_t a, std::int64_t b, std::int64_t layer, std::int64_t group) {
    element.push_back({element_type::quadrangle, quadrangle(a, b, layer), group});
  }
  void add_pyramid(std::int64_t layer, std::int64_t i) {
    auto nodes = quadrangle(node(n_, i), node(n_, i + 1), layer);
    nodes.push_back(middle_of(nodes, {wide, 0, 0}));
    element.push_back({element_type::pyramid, nodes, 9});
  }

  void renumber() {
    Tags now(point.size());
    std::iota(now.begin(), now.end(), 0);
    dice_.shuffle(now);
    std::vector<Vec3> moved(point.size());
    for (std::size_t k = 0; k < point.size(); ++k) moved[at(now[k])] = point[k];
    point = std::move(moved);
    for (auto& one : element)
      for (auto& k : one.nodes) k = now[at(k)];
  }

  test::Dice dice_;
  std::int64_t n_ = 0;
};

/// This rank's part of them: its block of the nodes, and any elements.
ElementParts parts_of(const par::Comm& comm, const Layers& layers, std::uint64_t seed) {
  ElementParts parts;
  parts.n_nodes = std::ssize(layers.point);
  parts.n_elements = std::ssize(layers.element);
  const auto own = par::block_range(parts.n_nodes, comm.rank(), comm.size());
  for (auto k = own.begin; k < own.end; ++k) {
    parts.node_tag.push_back(k);
    parts.position.push_back(layers.point[at(k)]);
  }
  test::Dice dice(seed);
  for (const auto& element : layers.element) {
    if (static_cast<Rank>(dice.below(at(comm.size()))) != comm.rank()) continue;
    std::array<std::int64_t, max_nodes> nodes{};
    std::copy(element.nodes.begin(), element.nodes.end(), nodes.begin());
    keep_element(parts, element.type, nodes, element.group);
  }
  return parts;
}

ElementMesh read(const par::Comm& comm, ElementParts parts, bool split = true) {
  return mesh_of_elements(comm, std::move(parts), "file 'layers'", {.repair = false, .split_prisms = split},
                          [](std::int64_t group) {
                            return mesh::Patch{std::to_string(group), ""};
                          });
}

TEST(CutElements, OfRandomLayersConformOnAnyRanks) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Layers layers(2 + static_cast<std::int64_t>(seed % 3), seed);
    const auto here = read(world, parts_of(world, layers, seed)), alone = read(self, parts_of(self, layers, seed));
    validate::require_valid(world, here.mesh, "layers");

    EXPECT_EQ(mesh::fingerprint(world, here.mesh), mesh::fingerprint(self, alone.mesh));
    EXPECT_EQ(here.n_turned, 0);
    EXPECT_EQ(here.cut, alone.cut);
    ASSERT_EQ(alone.notes.size(), 1U);
    EXPECT_EQ(here.notes, alone.notes);
    double volume = 0;
    std::map<std::string, double> area;
    for (LocalId c = 0; c < alone.mesh.n_cells(); ++c) {
      geometry::TetPoints p;
      for (std::size_t k = 0; k < 4; ++k) p[k] = alone.mesh.node_position[at(alone.mesh.cell_to_node[at(c)][k])];
      volume += geometry::volume(p);
      for (std::size_t slot = 0; slot < 4; ++slot) {
        const auto next = alone.mesh.cell_to_cell[at(c)][slot];
        if (next >= 0) continue;
        const auto& corner = mesh::tet::face_to_corner[slot];
        const auto a = p[at(corner[0])], b = p[at(corner[1])], d = p[at(corner[2])];
        area[alone.mesh.info.patches[at(mesh::slot_to_patch(next))].name] += norm(cross(b - a, d - a)) / 2;
      }
    }
    EXPECT_NEAR(volume, layers.volume, 1e-12);
    ASSERT_EQ(area.size(), 5U);  // those of the quadrangles, the bottom, and all else
    EXPECT_NEAR(area["1"], 1, 1e-12);
    for (const auto* side : {"2", "3", "4"}) EXPECT_NEAR(area[side], Layers::tall, 1e-12);
  }
}

TEST(CutElements, AreRefusedWithCountsUnlessAskedFor) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Layers layers(2, 1);
  const auto error_with = [&](const std::function<void(ElementParts&)>& change, bool split) {
    auto parts = parts_of(comm, layers, 1);
    change(parts);
    return test::error_of([&] { (void)read(comm, std::move(parts), split); });
  };
  const std::string expected =
      "file 'layers': expected tetrahedra and triangles of first order (points and lines are left out), found ";
  const auto nothing = [](ElementParts&) {};
  const auto hexahedron = [&](ElementParts& parts) {
    if (comm.is_first()) parts.refused[element_type::hexahedron] = 1;
  };

  EXPECT_EQ(error_with(nothing, false),
            expected +
                "18 quadrangles, 24 prisms, 6 pyramids (--split-prisms, in Python split_prisms=True, cuts prisms "
                "and pyramids into tetrahedra)");
  EXPECT_EQ(error_with(hexahedron, false), expected + "18 quadrangles, 1 hexahedra, 24 prisms, 6 pyramids");
  EXPECT_EQ(error_with(hexahedron, true), expected + "1 hexahedra");
  EXPECT_EQ(error_with(nothing, true), "no error");
}

}  // namespace cut_elements_test
}  // namespace pamr::io
