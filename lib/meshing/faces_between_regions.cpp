// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/faces_between_regions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;
using Edge = std::pair<std::int32_t, std::int32_t>;
using Regions = std::array<int, 2>;

/// Sets of connected faces.
class Connected {
 public:
  explicit Connected(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::size_t a, std::size_t b) { parent_[std::max(root(a), root(b))] = std::min(root(a), root(b)); }

 private:
  std::vector<std::size_t> parent_;
};

Vec3 middle_of(const RawMesh& mesh, const BoundaryFace& face) {
  const auto node = corners_of(mesh, face);
  return (1.0 / 3) * (mesh.position(node[0]) + mesh.position(node[1]) + mesh.position(node[2]));
}

/// The regions on both sides of each face, ascending: the cells behind them are found by their nodes.
std::vector<Regions> regions_beside(const RawMesh& mesh) {
  std::map<std::array<std::int32_t, 3>, Regions> regions;
  const auto key = [&](const BoundaryFace& face) {
    auto node = corners_of(mesh, face);
    std::sort(node.begin(), node.end());
    return node;
  };
  for (const auto& face : mesh.between) regions[key(face)] = {-1, -1};
  for (std::size_t c = 0; c < mesh.cell.size(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      const auto found = regions.find(key({static_cast<std::int32_t>(c), slot, -1}));
      if (found == regions.end()) continue;
      auto& [first, second] = found->second;
      (first < 0 ? first : second) = mesh.region[c];
      if (second >= 0 && second < first) std::swap(first, second);
    }
  std::vector<Regions> result;
  for (const auto& face : mesh.between) result.push_back(regions.at(key(face)));
  return result;
}

}  // namespace

std::array<std::int32_t, 3> corners_of(const RawMesh& mesh, const BoundaryFace& face) {
  std::array<std::int32_t, 3> corner{};
  for (std::size_t i = 0; i < 3; ++i)
    corner[i] = mesh.cell[at(face.cell)][at(mesh::tet::face_to_corner[at(face.slot)][i])];
  return corner;
}

void find_pieces_between_regions(const Domain& domain, const std::function<bool(Edge)>& is_feature, RawMesh& mesh) {
  const auto regions = regions_beside(mesh);
  Connected connected(mesh.between.size());
  std::map<std::pair<Edge, Regions>, std::size_t> known;
  for (std::size_t f = 0; f < mesh.between.size(); ++f) {
    const auto corner = corners_of(mesh, mesh.between[f]);
    for (std::size_t i = 0; i < 3; ++i) {
      const Edge edge = std::minmax(corner[i], corner[(i + 1) % 3]);
      if (is_feature(edge)) continue;
      const auto [other, is_new] = known.try_emplace({edge, regions[f]}, f);
      if (!is_new) connected.unite(other->second, f);
    }
  }
  std::map<std::size_t, std::vector<std::size_t>> parts;
  for (std::size_t f = 0; f < mesh.between.size(); ++f) parts[connected.root(f)].push_back(f);
  for (const auto& [first, faces] : parts) {
    int best = -1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < domain.pieces.size(); ++p) {
      if (domain.pieces[p].region != regions[first]) continue;
      double sum = 0;
      for (const auto f : faces) {
        const Vec3 middle = middle_of(mesh, mesh.between[f]);
        sum += squared_norm(domain.pieces[p].nearest(middle) - middle);
      }
      if (!(sum < least)) continue;
      least = sum;
      best = static_cast<int>(p);
    }
    if (best < 0)
      throw Error(
          fmt::format("expected a mesh whose regions meet where the solids do, found \"{}\" and \"{}\" beside each "
                      "other at {}: the sizes are too coarse for what is between them",
                      domain.regions[at(regions[first][0])].name, domain.regions[at(regions[first][1])].name,
                      geometry::decimal(middle_of(mesh, mesh.between[first]))));
    for (const auto f : faces) mesh.between[f].piece = best;
  }
}

}  // namespace pamr::meshing
