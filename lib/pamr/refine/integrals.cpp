// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/integrals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"

namespace pamr::refine {

namespace {

double volume_of(const mesh::DistMesh& mesh, LocalId first, LocalId end) {
  double volume = 0;
  for (auto c = first; c < end; ++c) volume += geometry::volume(mesh.points(c));
  return volume;
}

/// By what the values of each child are multiplied; 1 where volumes are the same to rounding.
std::vector<double> factors_of(const NumberedMesh& old, const mesh::DistMesh& fine) {
  constexpr double rounding = 0x1p-44;
  std::vector<double> factor(at(fine.n_cells()), 1.0);
  const auto& first_child = old.numbering.first_child;
  for (LocalId c = 0; c < old.mesh.n_cells(); ++c) {
    const auto begin = first_child[at(c)], end = first_child[at(c) + 1];
    if (begin == end) continue;  // its family is counted at the first member
    const bool is_family = old.closure.action[at(c)] == Action::rebuild;
    const auto before = volume_of(old.mesh, c, c + (is_family ? old.mesh.lineage[at(c)].family_size() : 1));
    const double ratio = before / volume_of(fine, begin, end);
    if (std::abs(ratio - 1) > rounding) std::fill(factor.begin() + begin, factor.begin() + end, ratio);
  }
  return factor;
}

}  // namespace

void require_integrals(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<std::string>& names) {
  if (names.empty()) return;
  par::agree(comm, [&] {
    for (const auto& name : names) {
      const auto* field = mesh.find_cell_field(name);
      if (field == nullptr || field->holds_integers())
        throw Error(fmt::format("adapt: expected a cell field of reals to keep the integral of, found {} '{}'",
                                field == nullptr ? "no cell field" : "the field of integers", name));
    }
  });
}

void keep_integrals(const NumberedMesh& old, const mesh::DistMesh& fine, const std::vector<std::string>& names,
                    std::vector<mesh::CellField>& of_cells) {
  std::vector<double> factor;
  for (auto& field : of_cells) {
    if (field.holds_integers() || std::find(names.begin(), names.end(), field.name) == names.end()) continue;
    if (factor.empty()) factor = factors_of(old, fine);
    const auto n = at(field.n_components);
    auto& values = field.real();
    for (std::size_t i = 0; i < values.size(); ++i) values[i] *= factor[i / n];
  }
}

}  // namespace pamr::refine
