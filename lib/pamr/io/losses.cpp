// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/losses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <string_view>

#include "pamr/base/counted.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/io/medit/write_medit.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/mesh/untagged_patch.hpp"

namespace pamr::io {

namespace {

std::string list(const std::vector<std::string>& items) { return listed(items, {.before_last = " and "}); }

std::string in_quotes(const std::string& name) { return "'" + name + "'"; }

/// Those that refining and projecting keep for themselves are no loss.
bool is_own(const mesh::Field& field) {
  constexpr std::array<std::string_view, 6> own{mesh::parent_field,      mesh::off_surface_field,
                                                mesh::off_facets_field,  mesh::level0_key_field,
                                                mesh::level0_cell_field, mesh::inner_patch_field};
  return std::find(own.begin(), own.end(), field.name) != own.end();
}

/// Fields that the format has no place for; empty if there are none.
std::string text_of_fields(const Format& format, const mesh::DistMesh& mesh,
                           const std::vector<const mesh::Field*>& kept) {
  std::vector<std::string> names;
  const auto* regions = mesh::find_regions(mesh);
  const auto add = [&](const mesh::Field& field, const char* on) {
    const bool has_place = &field == regions
                               ? format.has_regions
                               : format.has_fields || std::find(kept.begin(), kept.end(), &field) != kept.end();
    if (!has_place && !is_own(field)) names.push_back(fmt::format("{} on {}", in_quotes(field.name), on));
  };
  for (const auto& field : mesh.cell_fields) add(field, "cells");
  for (const auto& field : mesh.node_fields) add(field, "nodes");
  if (names.empty()) return {};
  const auto* place = format.has_solutions ? "fields of reals alone, in a file beside them (--sol-out, --sol-fields)"
                      : names.size() == 1  ? "no place for it"
                                           : "no place for them";
  return fmt::format("{} left out: {}: files of {} have {}", counted(std::ssize(names), "field is", "fields are"),
                     listed(names), format.name, place);
}

/// Faces of each patch, each side of those inside. Collective.
std::vector<std::int64_t> count_faces(const par::Comm& comm, const mesh::DistMesh& mesh) {
  const mesh::InnerPatches faces(mesh);
  std::vector<std::int64_t> n(mesh.info.patches.size(), 0);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot)
      if (const int patch = faces.of_any({c, slot}); patch >= 0) ++n[at(patch)];
  comm.sum_in_place(n);
  return n;
}

/// "the groups of 2 patches", of the regions likewise, where these have groups. `inside`: patches inside alone.
void add_groups(const Format& format, const mesh::MeshInfo& info, const std::vector<bool>& inside,
                std::vector<std::string>& lost) {
  std::int64_t n_patches = 0, n_regions = 0;
  for (std::size_t p = 0; p < inside.size(); ++p)
    if (!info.patches[p].groups.empty() && !(inside[p] ? format.has_groups_inside : format.has_groups)) ++n_patches;
  if (!format.has_groups_inside)
    n_regions = std::count_if(info.regions.begin(), info.regions.end(),
                              [](const mesh::Region& region) { return !region.groups.empty(); });
  if (n_patches > 0) lost.push_back("the groups of " + counted(n_patches, "patch", "patches"));
  if (n_regions > 0) lost.push_back("the groups of " + counted(n_regions, "region", "regions"));
}

/// "the kinds of 2 patches ('wall')"; empty for none. `inside`: patches inside alone, of which only native files keep
/// the kind.
std::string text_of_kinds(const Format& format, const mesh::MeshInfo& info, const std::vector<bool>& inside) {
  std::vector<std::string> kinds;
  std::int64_t n = 0;
  for (std::size_t p = 0; p < inside.size(); ++p) {
    const auto& kind = info.patches[p].kind;
    const bool has_place =
        !inside[p] && std::find(format.kinds.begin(), format.kinds.end(), kind) != format.kinds.end();
    if (has_place || kind.empty() || kind == "patch" || kind == mesh::untagged_kind) continue;  // which stand for none
    ++n;
    if (std::find(kinds.begin(), kinds.end(), in_quotes(kind)) == kinds.end()) kinds.push_back(in_quotes(kind));
  }
  return n == 0 ? "" : fmt::format("the kinds of {} ({})", counted(n, "patch", "patches"), list(kinds));
}

/// Names, kinds, groups and units; empty if the format has a place for all that there are. Collective.
std::string text_of_words(const par::Comm& comm, const Format& format, const mesh::DistMesh& mesh) {
  const auto& info = mesh.info;
  std::vector<std::string> lost, empty;
  const auto inside = mesh::patches_inside_alone(comm, mesh);
  if (auto kinds = text_of_kinds(format, info, inside); !kinds.empty()) lost.push_back(std::move(kinds));
  add_groups(format, info, inside, lost);
  if (format.has_regions && !format.has_region_names && !info.regions.empty())
    lost.push_back("the names of " + counted(std::ssize(info.regions), "region", "regions"));
  if (format.has_fields) {
    const auto has_unit = [](const mesh::Field& field) { return !field.unit.empty(); };
    const auto n = std::count_if(mesh.cell_fields.begin(), mesh.cell_fields.end(), has_unit) +
                   std::count_if(mesh.node_fields.begin(), mesh.node_fields.end(), has_unit);
    if (n > 0) lost.push_back("the units of " + counted(n, "field", "fields"));
  }
  if (!format.has_empty_patches) {
    const auto n_faces = count_faces(comm, mesh);
    for (std::size_t p = 0; p < n_faces.size(); ++p)
      if (n_faces[p] == 0 && !mesh::is_untagged(info.patches[p])) empty.push_back(in_quotes(info.patches[p].name));
    if (!empty.empty())
      lost.push_back(fmt::format("{} ({})", counted(std::ssize(empty), "patch without faces", "patches without faces"),
                                 list(empty)));
  }
  if (lost.empty()) return {};
  return fmt::format("left out: {}: files of {} have no place for {}", list(lost), format.name,
                     lost.size() == 1 ? "that" : "them");
}

/// Names that became numbers alone; empty if there are none.
std::string text_of_references(const mesh::MeshInfo& info) {
  std::vector<std::string> names, changed;
  std::vector<std::int64_t> numbers;
  for (const auto& patch : info.patches) {
    names.push_back(patch.name);
    numbers.push_back(patch.number);
  }
  const auto reference = medit_references(info, names, numbers);
  for (std::size_t p = 0; p < names.size(); ++p)
    if (reference[p] >= 0 && names[p] != fmt::format("ref_{}", reference[p]))
      changed.push_back(fmt::format("{} for {}", reference[p], in_quotes(names[p])));
  if (changed.empty()) return {};
  return fmt::format("{}: {}{}",
                     counted(std::ssize(changed), "patch has a reference instead of its name",
                             "patches have references instead of their names"),
                     list(changed),
                     changed.size() > Listing().most ? " (all are in the report, --json, as references)" : "");
}

std::string text_of_conditions(const Format& format, const mesh::MeshInfo& info) {
  const auto n = std::count_if(info.patches.begin(), info.patches.end(),
                               [](const mesh::Patch& patch) { return patch.condition != 0; });
  if (n == 0) return {};
  return fmt::format("the {} left out: files of {} have no place for {}",
                     n == 1 ? "boundary condition (.mapbc) of 1 patch is"
                            : fmt::format("boundary conditions (.mapbc) of {} patches are", n),
                     format.name, n == 1 ? "it" : "them");
}

}  // namespace

std::vector<std::string> texts_of_losses(const par::Comm& comm, const Format& format, const mesh::DistMesh& mesh,
                                         const MeshWriteOptions& options) {
  std::vector<std::string> texts;
  if (!options.remark || format.is_surface || format.is_native) return texts;
  const auto add = [&](std::string text) {
    if (!text.empty()) texts.push_back(std::move(text));
  };
  if (format.file_beside == nullptr) add(text_of_conditions(format, mesh.info));
  add(text_of_fields(format, mesh, options.kept));
  add(text_of_words(comm, format, mesh));
  if (!format.has_names) add(text_of_references(mesh.info));
  if (format.has_inner_patches) return texts;
  const auto n_faces = mesh::count_inner_faces(comm, mesh);
  for (std::size_t p = 0; p < n_faces.size(); ++p)
    if (const auto n = n_faces[p]; n > 0)
      texts.push_back(fmt::format("{} {} inside of '{}' {} left out: files of {} have no place for {}", n,
                                  n == 1 ? "face" : "faces", mesh.info.patches[p].name, n == 1 ? "is" : "are",
                                  format.name, n == 1 ? "it" : "them"));
  return texts;
}

std::string text_of_named_faces(const par::Comm& comm, const Format& format, const mesh::DistMesh& mesh) {
  if (!format.wants_every_face) return {};
  const auto n = mesh::count_untagged_faces(comm, mesh);
  if (n == 0) return {};
  return fmt::format("{} the patch '{}', because files of {} want every face of the boundary in one",
                     counted(n, "boundary face without tag became", "boundary faces without tag became"),
                     mesh.info.patches[mesh::find_untagged(mesh.info.patches)].name, format.name);
}

std::string text_of_lost_history(const par::Comm& comm, const Format& format, const mesh::DistMesh& mesh) {
  if (format.is_native) return {};
  const auto& patches = mesh.info.patches;
  std::vector<std::string> lost;
  const auto n_refined = comm.sum(std::count_if(mesh.lineage.begin(), mesh.lineage.end(),
                                                [](mesh::Lineage lineage) { return lineage != mesh::Lineage{}; }));
  if (n_refined > 0) lost.push_back("levels and families of " + counted(n_refined, "refined cell", "refined cells"));
  if (const auto untagged = mesh::find_untagged(patches);
      untagged < patches.size() && !format.has_untagged_name && mesh::count_untagged_faces(comm, mesh) == 0)
    lost.push_back(
        fmt::format("the patch {} for faces without a tag, which has none", in_quotes(patches[untagged].name)));
  const auto n_on_surfaces =
      std::count_if(patches.begin(), patches.end(), [](const mesh::Patch& patch) { return patch.surface >= 0; });
  if (n_on_surfaces > 0) lost.push_back("surfaces of " + counted(n_on_surfaces, "patch", "patches"));
  const auto n_numbers = std::count_if(patches.begin(), patches.end(), [](const mesh::Patch& patch) {
    return patch.number >= 0 && !patch.name.ends_with(fmt::format("_{}", patch.number));
  });
  if (n_numbers > 0 && !format.has_numbers) lost.push_back("numbers of " + counted(n_numbers, "patch", "patches"));
  if (const auto& unit = mesh.info.length_unit; !unit.empty() && unit != "1")
    lost.push_back("the unit of lengths (" + mesh.info.length_unit + ")");
  if (lost.empty()) return {};
  return fmt::format("left out, which a native file (.hdf) keeps: {}", list(lost));
}

}  // namespace pamr::io
