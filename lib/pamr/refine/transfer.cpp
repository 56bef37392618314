// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/transfer.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"

namespace pamr::refine {

namespace {

using geometry::Vec3;

/// Straight position of a node of the refined mesh: old nodes where they were, new ones in the middle of their edge.
Vec3 straight_point(const mesh::DistMesh& old, const Numbering& numbering, LocalId node) {
  if (node < old.n_nodes()) return old.point(node);
  const auto [a, b] = numbering.ends[at(node - old.n_nodes())];
  return geometry::midpoint(old.point(a), old.point(b));
}

/// Smallest barycentric coordinate of a point in a cell, times six volumes, over six volumes.
double depth_in(const geometry::TetPoints& p, Vec3 x) {
  const double whole = geometry::volume(p);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 4; ++i) {
    auto q = p;
    q[i] = x;
    least = std::min(least, geometry::volume(q) / whole);
  }
  return least;
}

/// For each child of a rebuilt family, the member that holds its centroid. "Among equals" allows for rounding: the
/// first member in which the centroid lies no deeper outside than 2^-40.
LocalId member_of(const mesh::DistMesh& old, const Numbering& numbering, LocalId first, const mesh::CellNodes& child) {
  Vec3 centroid;
  for (const auto node : child) centroid = centroid + 0.25 * straight_point(old, numbering, node);
  LocalId best = first;
  double deepest = -std::numeric_limits<double>::infinity();
  for (LocalId member = first; member < first + old.lineage[at(first)].family_size(); ++member) {
    const double depth = depth_in(old.points(member), centroid);
    if (depth >= -0x1p-40) return member;
    if (depth > deepest) {
      deepest = depth;
      best = member;
    }
  }
  return best;
}

/// Old local cell of every child.
std::vector<LocalId> parents_of(const mesh::DistMesh& old, const Closure& closure, const Numbering& numbering,
                                const mesh::DistMesh& fine) {
  std::vector<LocalId> parent(at(fine.n_cells()));
  for (LocalId c = 0; c < old.n_cells(); ++c)
    for (auto child = numbering.first_child[at(c)]; child < numbering.first_child[at(c) + 1]; ++child)
      parent[at(child)] =
          closure.action[at(c)] == Action::split ? c : member_of(old, numbering, c, fine.cell_to_node[at(child)]);
  return parent;
}

mesh::NodeField to_nodes(const mesh::DistMesh& old, const Numbering& numbering, const mesh::NodeField& field) {
  mesh::NodeField result{field.name, field.unit, field.n_components, field.storage, {}};
  const auto n = at(field.n_components);
  if (field.holds_integers()) {
    auto values = field.integer();
    values.reserve(values.size() + n * numbering.n_new_nodes());
    for (const auto [a, b] : numbering.ends) {
      const auto from = geometry::lexicographically_less(old.point(a), old.point(b)) ? a : b;
      for (std::size_t k = 0; k < n; ++k) values.push_back(field.integer()[at(from) * n + k]);
    }
    result.value = std::move(values);
  } else {
    auto values = field.real();
    values.reserve(values.size() + n * numbering.n_new_nodes());
    for (const auto [a, b] : numbering.ends)
      for (std::size_t k = 0; k < n; ++k)
        values.push_back(0.5 * (field.real()[at(a) * n + k] + field.real()[at(b) * n + k]));
    result.value = std::move(values);
  }
  return result;
}

mesh::CellField to_cells(const mesh::DistMesh& old, const Closure& closure, const Numbering& numbering,
                         const std::vector<LocalId>& parent, const mesh::CellField& field) {
  mesh::CellField result{field.name, field.unit, field.n_components, field.storage, {}};
  const auto n = at(field.n_components);
  const auto inherit = [&](const auto& from) {
    std::remove_cvref_t<decltype(from)> values(parent.size() * n);
    for (std::size_t c = 0; c < parent.size(); ++c)
      std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(at(parent[c]) * n), n,
                  values.begin() + static_cast<std::ptrdiff_t>(c * n));
    return values;
  };
  if (field.holds_integers()) {
    result.value = inherit(field.integer());
    return result;
  }
  auto values = inherit(field.real());
  for (const auto& family : closure.rebuilt)
    for (std::size_t k = 0; k < n; ++k) {
      double weighted = 0, total = 0;
      for (LocalId m = family.first; m < family.first + old.lineage[at(family.first)].family_size(); ++m) {
        const double v = geometry::volume(old.points(m));
        weighted += v * field.real()[at(m) * n + k];
        total += v;
      }
      for (auto child = numbering.first_child[at(family.first)]; child < numbering.first_child[at(family.first) + 1];
           ++child)
        values[at(child) * n + k] = weighted / total;
    }
  result.value = std::move(values);
  return result;
}

}  // namespace

void transfer(const mesh::DistMesh& old, const Closure& closure, const Numbering& numbering,
              const Certificate& certificate, bool has_ledger, const Options& options, mesh::DistMesh& fine) {
  for (const auto& field : old.node_fields)
    if (field.name != ledger_field) fine.node_fields.push_back(to_nodes(old, numbering, field));
  if (has_ledger) {
    std::vector<double> off(at(fine.n_nodes()), 0.0);
    for (const auto& entry : certificate.ledger) off[at(entry.node)] = entry.distance;
    fine.node_fields.push_back({ledger_field, old.info.length_unit, 1, mesh::StorageType::float64, std::move(off)});
  }
  const bool needs_parents = options.parent_field || !old.cell_fields.empty();
  if (!needs_parents) return;
  const auto parent = parents_of(old, closure, numbering, fine);
  for (const auto& field : old.cell_fields)
    if (field.name != options.marks_field && field.name != options.origin_field &&
        !(field.name == "parent" && options.parent_field))
      fine.cell_fields.push_back(to_cells(old, closure, numbering, parent, field));
  if (options.parent_field) {
    const auto* origin = old.find_cell_field(options.origin_field);
    const auto& number = origin == nullptr ? old.cell_global : origin->integer();
    std::vector<std::int64_t> of_parent(parent.size());
    for (std::size_t c = 0; c < parent.size(); ++c) of_parent[c] = number[at(parent[c])];
    fine.cell_fields.push_back({"parent", "", 1, mesh::StorageType::int64, std::move(of_parent)});
  }
}

}  // namespace pamr::refine
