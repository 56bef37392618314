// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

#include "pamr/check/match_nodes.hpp"
#include "pamr/check/pair_rows.hpp"
#include "pamr/mesh/inner_patches.hpp"

namespace pamr::check {

namespace {

std::uint64_t word(std::int64_t value) { return static_cast<std::uint64_t>(value); }

const mesh::Field* find(const std::vector<mesh::Field>& fields, const std::string& name) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f.name == name; });
  return found == fields.end() ? nullptr : &*found;
}

/// Fields that both meshes have, to be compared value by value, and what is to be said of the others.
struct FieldPlan {
  struct Pair {
    const mesh::Field* a = nullptr;
    const mesh::Field* b = nullptr;
    bool as_integers() const { return a->holds_integers() && b->holds_integers(); }
  };
  std::string on;  ///< "cell" or "node"
  std::vector<Pair> pairs;
  std::vector<Difference> missing;

  std::vector<Column> columns() const {
    std::vector<Column> result;
    for (const auto& pair : pairs)
      result.insert(result.end(), static_cast<std::size_t>(pair.a->n_components),
                    pair.as_integers() ? Column::integer : Column::real);
    return result;
  }
};

FieldPlan plan_fields(const std::string& on, const std::vector<mesh::Field>& a, const std::vector<mesh::Field>& b,
                      Comparison& result) {
  FieldPlan plan;
  plan.on = on;
  const auto differ = [&](const std::string& name, const std::string& how) {
    plan.missing.push_back({"field " + name, fmt::format("{} field \"{}\" {}", on, name, how), 1});
  };
  for (const auto& field : a) {
    if (mesh::is_inner_patch_field(field)) continue;  // compared as patches
    const auto* other = find(b, field.name);
    if (other == nullptr) {
      differ(field.name, "is in the first mesh only");
    } else if (other->n_components != field.n_components) {
      differ(field.name, fmt::format("has {} components in the first mesh and {} in the second", field.n_components,
                                     other->n_components));
    } else {
      plan.pairs.push_back({&field, other});
      result.fields.push_back(field.name);
      if (field.storage != other->storage)
        result.notes.push_back(fmt::format("{} field \"{}\" is stored in another type", on, field.name));
      if (field.unit != other->unit)
        result.notes.push_back(
            fmt::format("{} field \"{}\" has unit \"{}\" and \"{}\"", on, field.name, field.unit, other->unit));
    }
  }
  for (const auto& field : b)
    if (find(a, field.name) == nullptr && !mesh::is_inner_patch_field(field))
      differ(field.name, "is in the second mesh only");
  return plan;
}

/// Appends the values of element i to a row.
void append(std::vector<std::uint64_t>& row, const mesh::Field& field, bool as_integers, std::size_t i) {
  const auto n = static_cast<std::size_t>(field.n_components);
  for (std::size_t k = n * i; k < n * (i + 1); ++k) {
    if (as_integers)
      row.push_back(word(field.integer()[k]));
    else
      row.push_back(std::bit_cast<std::uint64_t>(
          (field.holds_integers() ? static_cast<double>(field.integer()[k]) : field.real()[k]) + 0.0));
  }
}

void compare_counts(const mesh::MeshInfo& a, const mesh::MeshInfo& b, Comparison& result) {
  const auto differ = [&](const std::string& what, GlobalId in_a, GlobalId in_b) {
    if (in_a != in_b)
      result.differences.push_back(
          {what, fmt::format("{} {} in the first mesh, {} in the second", in_a, what, in_b), std::abs(in_a - in_b)});
  };
  differ("cells", a.n_global_cells, b.n_global_cells);
  differ("nodes", a.n_global_nodes, b.n_global_nodes);
}

void take_notes(const mesh::MeshInfo& a, const mesh::MeshInfo& b, Comparison& result) {
  if (a.length_unit != b.length_unit)
    result.notes.push_back(fmt::format("length unit \"{}\" and \"{}\"", a.length_unit, b.length_unit));
  const auto same_patch = [&](const mesh::Patch& p, const mesh::Patch& q) {
    return p.name == q.name && p.kind == q.kind && a.surface_name(p) == b.surface_name(q);
  };
  if (!std::equal(a.patches.begin(), a.patches.end(), b.patches.begin(), b.patches.end(), same_patch))
    result.notes.emplace_back("another list of patches, or other kinds or surfaces of them");
  const auto same_origin = [](const mesh::Patch& p, const mesh::Patch& q) {
    return p.number == q.number && p.condition == q.condition && p.groups == q.groups;
  };
  if (!std::equal(a.patches.begin(), a.patches.end(), b.patches.begin(), b.patches.end(), same_origin))
    result.notes.emplace_back("other numbers, groups or conditions of patches");
  if (a.regions != b.regions) result.notes.emplace_back("other names or groups of regions");
  const auto same = [](const auto& x, const auto& y) { return *x == *y; };
  const auto &data_a = a.surfaces->triangulations, &data_b = b.surfaces->triangulations;
  if (!std::equal(data_a.begin(), data_a.end(), data_b.begin(), data_b.end(), same))
    result.notes.emplace_back("another list of triangulated surfaces");
  if (a.surfaces->toml != b.surfaces->toml) result.notes.emplace_back("another description of the surfaces");
}

/// Names of the patches of both meshes numbered together, from 1.
std::int64_t patch_word(const mesh::MeshInfo& a, const std::string& name, std::int64_t number_in_b) {
  const auto found = std::find_if(a.patches.begin(), a.patches.end(), [&](const auto& p) { return p.name == name; });
  return found != a.patches.end() ? found - a.patches.begin() + 1 : std::ssize(a.patches) + 1 + number_in_b;
}

NodeList nodes_of(const mesh::DistMesh& mesh) { return {mesh.node_global, mesh.node_position}; }

using FieldOf = const mesh::Field* FieldPlan::Pair::*;

Rows node_rows(const mesh::DistMesh& mesh, const std::vector<GlobalId>& match, const FieldPlan& plan, FieldOf side) {
  Rows rows{1, {}};
  for (std::size_t i = 0; i < match.size(); ++i) {
    rows.word.push_back(word(match[i]));
    rows.word.push_back(word(mesh.node_global[i]));
    for (const auto& pair : plan.pairs) append(rows.word, *(pair.*side), pair.as_integers(), i);
  }
  return rows;
}

/// Columns: the patch across from each corner, corners in the order of the keys (0: none); kind, level and state
/// of the family; fields.
Rows cell_rows(const mesh::DistMesh& mesh, const std::vector<GlobalId>& match,
               const std::vector<std::int64_t>& patch_words, const FieldPlan& plan, FieldOf side) {
  Rows rows{4, {}};
  const mesh::InnerPatches patches(mesh);
  for (std::size_t cell = 0; cell < mesh.cell_to_node.size(); ++cell) {
    std::array<GlobalId, 4> key{};
    for (std::size_t i = 0; i < 4; ++i) key[i] = match[static_cast<std::size_t>(mesh.cell_to_node[cell][i])];
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    std::sort(order.begin(), order.end(), [&](auto i, auto j) { return key[i] < key[j]; });
    for (const auto i : order) rows.word.push_back(word(key[i]));
    rows.word.push_back(word(mesh.cell_global[cell]));
    for (const auto i : order) {
      const int patch = patches.of_any({static_cast<LocalId>(cell), static_cast<int>(i)});
      rows.word.push_back(patch < 0 ? 0U : word(patch_words[static_cast<std::size_t>(patch)]));
    }
    const auto lineage = mesh.lineage[cell];
    rows.word.push_back(static_cast<std::uint64_t>(lineage.kind()) << 16U | word(lineage.level()) << 1U |
                        word(lineage.is_broken() ? 1 : 0));
    for (const auto& pair : plan.pairs) append(rows.word, *(pair.*side), pair.as_integers(), cell);
  }
  return rows;
}

void report_unpaired(const std::string& what, const Pairing& pairing, Comparison& result) {
  const auto differ = [&](const Tally& tally, const char* which) {
    if (tally.count > 0)
      result.differences.push_back({what,
                                    fmt::format("{} {} of the {} mesh have no counterpart, the first is {}",
                                                tally.count, what, which, tally.first),
                                    tally.count, tally.first});
  };
  differ(pairing.only_in_a, "first");
  differ(pairing.only_in_b, "second");
}

/// Tallies of several columns as one.
Tally joined(std::span<const Tally> tallies) {
  Tally result;
  for (const auto& tally : tallies) {
    if (tally.count == 0) continue;
    result.first = result.count == 0 ? tally.first : std::min(result.first, tally.first);
    result.count += tally.count;
    result.largest = std::max(result.largest, tally.largest);
  }
  return result;
}

void report_fields(const FieldPlan& plan, std::span<const Tally> tallies, Comparison& result) {
  result.differences.insert(result.differences.end(), plan.missing.begin(), plan.missing.end());
  for (const auto& pair : plan.pairs) {
    const auto n = static_cast<std::size_t>(pair.a->n_components);
    const auto tally = joined(tallies.first(n));
    tallies = tallies.subspan(n);
    if (tally.count > 0)
      result.differences.push_back(
          {"field " + pair.a->name,
           fmt::format("{} values of {} field \"{}\" differ by up to {:.6g}, the first on {} {}", tally.count, plan.on,
                       pair.a->name, tally.largest, plan.on, tally.first),
           tally.count, tally.first, tally.largest});
  }
}

}  // namespace

Comparison compare_meshes(const par::Comm& comm, const mesh::DistMesh& a, const mesh::DistMesh& b, double tolerance) {
  Comparison result;
  compare_counts(a.info, b.info, result);
  take_notes(a.info, b.info, result);
  const auto on_cells = plan_fields("cell", a.cell_fields, b.cell_fields, result);
  const auto on_nodes = plan_fields("node", a.node_fields, b.node_fields, result);

  const auto match_a = match_nodes(comm, nodes_of(a), nodes_of(a), 0);
  const auto match_b = match_nodes(comm, nodes_of(a), nodes_of(b), tolerance);
  const auto node_columns = on_nodes.columns();
  const auto nodes = pair_rows(comm, node_rows(a, match_a, on_nodes, &FieldPlan::Pair::a),
                               node_rows(b, match_b, on_nodes, &FieldPlan::Pair::b), node_columns, tolerance);
  report_unpaired("nodes", nodes, result);

  std::vector<std::int64_t> patches_a, patches_b;
  for (std::size_t i = 0; i < a.info.patches.size(); ++i) patches_a.push_back(static_cast<std::int64_t>(i) + 1);
  for (const auto& patch : b.info.patches) patches_b.push_back(patch_word(a.info, patch.name, std::ssize(patches_b)));
  std::vector<Column> cell_columns(5, Column::exact);
  const auto field_columns = on_cells.columns();
  cell_columns.insert(cell_columns.end(), field_columns.begin(), field_columns.end());
  const auto cells =
      pair_rows(comm, cell_rows(a, match_a, patches_a, on_cells, &FieldPlan::Pair::a),
                cell_rows(b, match_b, patches_b, on_cells, &FieldPlan::Pair::b), cell_columns, tolerance);
  report_unpaired("cells", cells, result);
  const std::span<const Tally> columns(cells.column);
  if (const auto faces = joined(columns.first(4)); faces.count > 0)
    result.differences.push_back(
        {"patches", fmt::format("{} faces lie on other patches, the first on cell {}", faces.count, faces.first),
         faces.count, faces.first});
  if (const auto& lineage = columns[4]; lineage.count > 0)
    result.differences.push_back(
        {"lineage", fmt::format("{} cells have another level or family, the first is {}", lineage.count, lineage.first),
         lineage.count, lineage.first});
  report_fields(on_cells, columns.subspan(5), result);
  report_fields(on_nodes, nodes.column, result);
  return result;
}

}  // namespace pamr::check
