// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/coarsen/coarse_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pamr/base/memory.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/refine/inner_faces.hpp"
#include "pamr/refine/transfer.hpp"

namespace pamr::coarsen {

namespace {

bool is_one_of(const std::string& name, const std::vector<std::string>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The same rows of values at the nodes that stay.
template <class Values>
Values restrict_rows(const Values& old, std::span<const LocalId> old_node, std::size_t n) {
  Values values;
  reserve_array(values, n * old_node.size());
  for (const auto node : old_node) {
    const auto from = old.begin() + static_cast<std::ptrdiff_t>(n * at(node));
    values.insert(values.end(), from, from + static_cast<std::ptrdiff_t>(n));
  }
  return values;
}

void carry_node_fields(const par::Comm& comm, const mesh::DistMesh& old, std::span<const LocalId> old_node,
                       mesh::DistMesh& coarse) {
  for (const auto& field : old.node_fields) {
    if (field.name == mesh::level0_key_field) continue;
    mesh::NodeField carried{field.name, field.unit, field.n_components, field.storage, {}};
    std::visit([&](const auto& values) { carried.value = restrict_rows(values, old_node, at(field.n_components)); },
               field.value);
    if (!carried.holds_integers() && (field.name == mesh::off_surface_field || field.name == mesh::off_facets_field)) {
      const auto& values = carried.real();
      if (!comm.any(std::any_of(values.begin(), values.end(), [](double v) { return v != 0; }))) continue;
    }
    coarse.node_fields.push_back(std::move(carried));
  }
}

/// Volumes of the cells of a group before, and after all together.
struct Volumes {
  std::vector<double> of_cell;
  double before = 0;
  double after = 0;
};

LocalId n_cells_now(const Group& group) { return refine::split_pattern[group.now].n_children; }

void measure(const mesh::DistMesh& old, const mesh::DistMesh& coarse, const Group& group, LocalId first_now,
             Volumes& volumes) {
  volumes.of_cell.clear();
  volumes.before = volumes.after = 0;
  for (auto c = group.first; c < group.end; ++c) {
    volumes.of_cell.push_back(geometry::volume(old.points(c)));
    volumes.before += volumes.of_cell.back();
  }
  for (auto c = first_now; c < first_now + n_cells_now(group); ++c) volumes.after += geometry::volume(coarse.points(c));
}

/// Of values `stride` apart. Differences from the first one are averaged, so that equal values stay what they are.
double mean_of(const double* value, std::size_t stride, const Volumes& volumes) {
  const double first = value[0];
  double sum = 0, largest = std::abs(first);
  for (std::size_t i = 0; i < volumes.of_cell.size(); ++i) {
    const double v = value[i * stride];
    largest = std::max(largest, std::abs(v));
    if (v != first) sum += volumes.of_cell[i] / volumes.before * (v - first);
  }
  if (std::isfinite(sum)) return std::clamp(first + sum, -largest, largest);
  double mean = 0;  // differences of large values may be too large; values that are no numbers stay none
  for (std::size_t i = 0; i < volumes.of_cell.size(); ++i)
    mean += volumes.of_cell[i] / volumes.before * value[i * stride];
  return mean;
}

double integral_of(const double* value, std::size_t stride, const Volumes& volumes) {
  double sum = 0;
  for (std::size_t i = 0; i < volumes.of_cell.size(); ++i) sum += volumes.of_cell[i] * value[i * stride];
  return sum / volumes.after;
}

std::int64_t largest_share(const std::int64_t* value, std::size_t stride, const Volumes& volumes) {
  const auto n = volumes.of_cell.size();
  std::int64_t best = value[0];
  if (std::all_of(&volumes.of_cell[0], &volumes.of_cell[0] + n,
                  [&, i = std::size_t{0}](double) mutable { return value[stride * i++] == best; }))
    return best;
  double most = -1;
  for (std::size_t i = 0; i < n; ++i) {
    const auto candidate = value[i * stride];
    double share = 0;
    for (std::size_t j = 0; j < n; ++j) share += value[j * stride] == candidate ? volumes.of_cell[j] : 0;
    const bool is_tied = std::abs(share - most) <= 0x1p-40 * volumes.before;
    if (is_tied ? candidate < best : share > most) {
      best = candidate;
      most = share;
    }
  }
  return best;
}

/// Values of the cells that stay; room for the others.
template <class Values>
Values copy_rows(const Values& old, const NewPlaces& places, std::size_t n_coarse, std::size_t n) {
  Values values;
  assign_array(values, n_coarse * n, typename Values::value_type{});
  for (std::size_t c = 0; c < places.cell.size(); ++c)
    if (places.cell[c] >= 0)
      std::copy_n(old.begin() + static_cast<std::ptrdiff_t>(c * n), n,
                  values.begin() + static_cast<std::ptrdiff_t>(at(places.cell[c]) * n));
  return values;
}

/// Writes one value into all cells of a group.
template <class Values, class Value>
void fill_group(Values& values, const Group& group, LocalId first_now, std::size_t n, std::size_t k, Value value) {
  for (auto c = first_now; c < first_now + n_cells_now(group); ++c) values[at(c) * n + k] = value;
}

mesh::CellField carry_cell_field(const mesh::DistMesh& old, std::span<const Group> groups, const NewPlaces& places,
                                 const mesh::DistMesh& coarse, const mesh::CellField& field, bool is_integral) {
  const auto n = at(field.n_components);
  mesh::CellField carried{field.name, field.unit, field.n_components, field.storage, {}};
  std::visit([&](const auto& values) { carried.value = copy_rows(values, places, coarse.cell_to_node.size(), n); },
             field.value);
  Volumes volumes;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto& group = groups[g];
    const auto first = places.first_of_group[g];
    measure(old, coarse, group, first, volumes);
    for (std::size_t k = 0; k < n; ++k) {
      const auto begin = at(group.first) * n + k;
      if (field.holds_integers())
        fill_group(carried.integer(), group, first, n, k, largest_share(&field.integer()[begin], n, volumes));
      else
        fill_group(
            carried.real(), group, first, n, k,
            is_integral ? integral_of(&field.real()[begin], n, volumes) : mean_of(&field.real()[begin], n, volumes));
    }
  }
  return carried;
}

/// Patches of inner faces: a parent has those that its cells show on its faces. `field`: `mesh::inner_patch_field`.
mesh::CellField carry_inner_patches(const mesh::DistMesh& old, std::span<const Group> groups, const NewPlaces& places,
                                    const mesh::DistMesh& coarse, const mesh::CellField& field) {
  auto word = copy_rows(field.integer(), places, coarse.cell_to_node.size(), 1);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::int64_t parent = 0;
    for_each_outer_face(old, groups[g], [&](LocalId cell, int slot, int face) {
      if (const int patch = mesh::inner_patch(field.integer()[at(cell)], slot); patch >= 0)
        parent = mesh::with_inner_patch(parent, face, patch);
    });
    const auto now = refine::inner_patches_of_children(parent, refine::split_pattern[groups[g].now]);
    std::copy_n(now.begin(), n_cells_now(groups[g]), word.begin() + places.first_of_group[g]);
  }
  return {field.name, "", 1, mesh::StorageType::int64, std::move(word)};
}

geometry::Vec3 centroid(const mesh::DistMesh& mesh, LocalId cell) {
  geometry::Vec3 sum;
  for (const auto p : mesh.points(cell)) sum = sum + 0.25 * p;
  return sum;
}

const std::vector<GlobalId>& numbers_of(const mesh::DistMesh& mesh) {
  return mesh.cell_origin.empty() ? mesh.cell_global : mesh.cell_origin;
}

}  // namespace

void carry_level0(const mesh::DistMesh& old, std::span<const Group> groups, Coarsened& coarsened) {
  auto& coarse = coarsened.mesh;
  const auto* keys = old.find_node_field(mesh::level0_key_field);
  const auto* rows = old.find_cell_field(mesh::level0_cell_field);
  if (keys == nullptr || rows == nullptr) return;
  coarse.node_fields.push_back(mesh::empty_key_field());
  coarse.node_fields.back().value = restrict_rows(keys->integer(), coarsened.old_node, at(keys->n_components));
  auto carried = copy_rows(rows->integer(), coarsened.places, coarse.cell_to_node.size(), 1);
  for (std::size_t g = 0; g < groups.size(); ++g)
    fill_group(carried, groups[g], coarsened.places.first_of_group[g], 1, 0, rows->integer()[at(groups[g].first)]);
  coarse.cell_fields.push_back({mesh::level0_cell_field, "", 1, mesh::StorageType::int64, std::move(carried)});
}

void carry_fields(const par::Comm& comm, const mesh::DistMesh& old, std::span<const Group> groups,
                  const FieldRules& rules, Coarsened& coarsened) {
  auto& coarse = coarsened.mesh;
  const auto& places = coarsened.places;
  carry_node_fields(comm, old, coarsened.old_node, coarse);
  for (const auto& field : old.cell_fields)
    if (!is_one_of(field.name, rules.left_out) && field.name != mesh::level0_cell_field)
      coarse.cell_fields.push_back(
          mesh::is_inner_patch_field(field)
              ? carry_inner_patches(old, groups, places, coarse, field)
              : carry_cell_field(old, groups, places, coarse, field, is_one_of(field.name, rules.integrals)));
  const auto& number = numbers_of(old);
  coarse.cell_origin = copy_rows(number, places, coarse.cell_to_node.size(), 1);
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (auto c = places.first_of_group[g]; c < places.first_of_group[g] + n_cells_now(groups[g]); ++c)
      coarse.cell_origin[at(c)] =
          number[at(refine::cell_that_holds(old, groups[g].first, groups[g].end, centroid(coarse, c)))];
}

std::vector<Merged> find_merged(const mesh::DistMesh& old, std::span<const Group> groups, const Coarsened& coarsened) {
  const auto& coarse = coarsened.mesh;
  const auto& number = numbers_of(old);
  std::vector<Merged> merged;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto first = coarsened.places.first_of_group[g], end = first + n_cells_now(groups[g]);
    const auto begin = coarse.cell_origin.begin();
    for (auto c = groups[g].first; c < groups[g].end; ++c) {
      if (std::find(begin + first, begin + end, number[at(c)]) != begin + end) continue;
      const auto holder = end - first == 1 ? first : refine::cell_that_holds(coarse, first, end, centroid(old, c));
      merged.push_back({number[at(c)], coarse.cell_origin[at(holder)]});
    }
  }
  return merged;
}

}  // namespace pamr::coarsen
