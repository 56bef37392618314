// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/transfer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/mesh/undescribed_patches.hpp"

namespace pamr::refine {

namespace {

using geometry::Vec3;

/// Straight position of a node of the refined mesh: old nodes where they were, new ones in the middle of their edge.
Vec3 straight_point(const NumberedMesh& old, LocalId node) {
  if (node < old.mesh.n_nodes()) return old.mesh.point(node);
  const auto [a, b] = old.numbering.ends[at(node - old.mesh.n_nodes())];
  return geometry::midpoint(old.mesh.point(a), old.mesh.point(b));
}

/// Smallest barycentric coordinate of a point in a cell, times six volumes, over six volumes; of several below `least`
/// any.
double depth_in(const geometry::TetPoints& p, Vec3 x, double least) {
  const double whole = geometry::volume(p);
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 4 && !(smallest < least); ++i) {
    auto q = p;
    q[i] = x;
    smallest = std::min(smallest, geometry::volume(q) / whole);
  }
  return smallest;
}

/// The mean of two finite values, finite also where their sum is not.
double mean_of(double a, double b) {
  const double mean = 0.5 * (a + b);
  return std::isfinite(mean) ? mean : 0.5 * a + 0.5 * b;
}

mesh::NodeField to_nodes(const NumberedMesh& old, const mesh::NodeField& field) {
  const auto& [mesh, closure, numbering] = old;
  mesh::NodeField result{field.name, field.unit, field.n_components, field.storage, {}};
  const auto n = at(field.n_components);
  const auto n_values = n * (at(mesh.n_nodes()) + numbering.n_new_nodes());
  if (field.holds_integers()) {
    auto values = copy_array(field.integer(), n_values);
    for (const auto [a, b] : numbering.ends) {
      const auto from = geometry::lexicographically_less(mesh.point(a), mesh.point(b)) ? a : b;
      for (std::size_t k = 0; k < n; ++k) values.push_back(field.integer()[at(from) * n + k]);
    }
    result.value = std::move(values);
  } else {
    auto values = copy_array(field.real(), n_values);
    for (const auto [a, b] : numbering.ends)
      for (std::size_t k = 0; k < n; ++k)
        values.push_back(mean_of(field.real()[at(a) * n + k], field.real()[at(b) * n + k]));
    result.value = std::move(values);
  }
  return result;
}

/// A new node lies in the middle of its edge in level 0.
mesh::NodeField keys_of(const NumberedMesh& old, const mesh::NodeField& before) {
  auto keys = mesh::empty_key_field();
  keys.value = copy_array(before.integer(), before.integer().size() + mesh::n_key_words * old.numbering.n_new_nodes());
  for (const auto [a, b] : old.numbering.ends)
    mesh::append_key(keys, mesh::middle(mesh::key_of(&before, a), mesh::key_of(&before, b)));
  return keys;
}

/// The mean of a value over the members of a family, by volume; finite where the values are.
template <class Value>
double family_mean(const mesh::DistMesh& mesh, LocalId first, const Value& value) {
  const auto last = first + mesh.lineage[at(first)].family_size();
  const double of_first = value(first);  // one value of all stays what it is, whatever rounding says
  bool is_one = true;
  for (LocalId m = first + 1; m < last; ++m) is_one = is_one && value(m) == of_first;
  if (is_one) return of_first;
  double weighted = 0, total = 0;
  for (LocalId m = first; m < last; ++m) {
    const double v = geometry::volume(mesh.points(m));
    weighted += v * value(m);
    total += v;
  }
  if (std::isfinite(weighted)) return weighted / total;
  double mean = 0, largest = 0;
  for (LocalId m = first; m < last; ++m) {
    mean += geometry::volume(mesh.points(m)) / total * value(m);
    largest = std::max(largest, std::abs(value(m)));
  }
  return std::clamp(mean, -largest, largest);  // a mean is no larger than its values, whatever rounding says
}

mesh::CellField to_cells(const NumberedMesh& old, const std::vector<LocalId>& parent, const mesh::CellField& field) {
  const auto& [mesh, closure, numbering] = old;
  mesh::CellField result{field.name, field.unit, field.n_components, field.storage, {}};
  const auto n = at(field.n_components);
  const auto inherit = [&](const auto& from) {
    std::remove_cvref_t<decltype(from)> values;
    assign_array(values, parent.size() * n, {});
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
      const double mean = family_mean(mesh, family.first, [&](LocalId m) { return field.real()[at(m) * n + k]; });
      for (auto child = numbering.first_child[at(family.first)]; child < numbering.first_child[at(family.first) + 1];
           ++child)
        values[at(child) * n + k] = mean;
    }
  result.value = std::move(values);
  return result;
}

mesh::NodeField distances(const NumberedMesh& old, const char* name, std::vector<double> distance,
                          const std::vector<OffSurface>& nodes) {
  distance.resize(at(old.mesh.n_nodes()) + old.numbering.n_new_nodes(), 0.0);
  for (const auto& entry : nodes) distance[at(entry.node)] = entry.distance;
  return {name, old.mesh.info.length_unit, 1, mesh::StorageType::float64, std::move(distance)};
}

/// The distances that old nodes have, and those of the nodes that left the faces of their patch now.
mesh::NodeField off_facets_of(const NumberedMesh& old, const mesh::NodeField* before,
                              const std::vector<OffSurface>& nodes) {
  return distances(old, mesh::off_facets_field,
                   before == nullptr ? std::vector<double>(at(old.mesh.n_nodes()), 0.0) : before->real(), nodes);
}

mesh::CellField numbers_of(const std::vector<LocalId>& parent, const mesh::DistMesh& old) {
  const auto& number = old.cell_origin.empty() ? old.cell_global : old.cell_origin;
  std::vector<std::int64_t> of_parent;
  reserve_array(of_parent, parent.size());
  for (const auto c : parent) of_parent.push_back(number[at(c)]);
  return {mesh::parent_field, "", 1, mesh::StorageType::int64, std::move(of_parent)};
}

}  // namespace

Vec3 straight_centroid(const NumberedMesh& old, const mesh::CellNodes& child) {
  Vec3 centroid;
  for (const auto node : child) centroid = centroid + 0.25 * straight_point(old, node);
  return centroid;
}

LocalId cell_that_holds(const mesh::DistMesh& mesh, LocalId first, LocalId end, Vec3 point) {
  constexpr double enough = -0x1p-40, any = -std::numeric_limits<double>::infinity();
  for (LocalId cell = first; cell < end; ++cell)
    if (depth_in(mesh.points(cell), point, enough) >= enough) return cell;
  LocalId best = first;
  double deepest = any;
  for (LocalId cell = first; cell < end; ++cell) {
    const double depth = depth_in(mesh.points(cell), point, any);
    if (depth > deepest) {
      deepest = depth;
      best = cell;
    }
  }
  return best;
}

LocalId member_that_holds(const mesh::DistMesh& mesh, LocalId first, Vec3 point) {
  return cell_that_holds(mesh, first, first + mesh.lineage[at(first)].family_size(), point);
}

std::vector<LocalId> parents_of(const NumberedMesh& old, const std::vector<mesh::CellNodes>& cell_to_node) {
  const auto& first_child = old.numbering.first_child;
  std::vector<LocalId> parent;
  assign_array(parent, cell_to_node.size(), 0);
  for (LocalId c = 0; c < old.mesh.n_cells(); ++c)
    for (auto child = first_child[at(c)]; child < first_child[at(c) + 1]; ++child)
      parent[at(child)] = old.closure.action[at(c)] == Action::split
                              ? c
                              : member_that_holds(old.mesh, c, straight_centroid(old, cell_to_node[at(child)]));
  return parent;
}

bool is_inherited(const mesh::CellField& field, const Options& options) {
  return field.name != options.marks_field && !(field.name == mesh::parent_field && options.parent_field);
}

std::vector<mesh::NodeField> transfer_to_nodes(const NumberedMesh& old, const Certificate& certificate,
                                               const ReleaseField& release) {
  std::vector<mesh::NodeField> fields;
  const mesh::NodeField* off_facets = nullptr;
  for (const auto& field : old.mesh.node_fields) {
    if (field.name == mesh::off_facets_field && !field.holds_integers() && field.n_components == 1) {
      off_facets = &field;
      continue;
    }
    if (field.name == mesh::level0_key_field)
      fields.push_back(keys_of(old, field));
    else if (field.name != mesh::off_surface_field)
      fields.push_back(to_nodes(old, field));
    release(field);
  }
  if (certificate.n_off_surface > 0)
    fields.push_back(distances(old, mesh::off_surface_field, {}, certificate.off_surface));
  if (off_facets != nullptr || certificate.n_off_facets > 0)
    fields.push_back(off_facets_of(old, off_facets, certificate.off_facets));
  return fields;
}

Fields transfer(const NumberedMesh& old, const std::vector<mesh::CellNodes>& cell_to_node,
                const Certificate& certificate, const Options& options, const ReleaseField& release) {
  Fields fields;
  fields.of_nodes = transfer_to_nodes(old, certificate, release);
  const auto goes_to_children = [&options](const mesh::CellField& field) {
    return is_inherited(field, options) && !mesh::is_inner_patch_field(field);
  };
  std::vector<LocalId> parent;
  if (options.parent_field || std::any_of(old.mesh.cell_fields.begin(), old.mesh.cell_fields.end(), goes_to_children))
    parent = parents_of(old, cell_to_node);
  for (const auto& field : old.mesh.cell_fields) {
    if (goes_to_children(field)) fields.of_cells.push_back(to_cells(old, parent, field));
    release(field);
  }
  if (options.parent_field) fields.of_cells.push_back(numbers_of(parent, old.mesh));
  return fields;
}

}  // namespace pamr::refine
