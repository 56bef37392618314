// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/mesh_of_elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/tag_boundary.hpp"
#include "pamr/assemble/turn_inverted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/io/elements/cut_elements.hpp"
#include "pamr/io/elements/number_elements.hpp"
#include "pamr/io/text.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/order/order_along_curve.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/gather_few.hpp"
#include "pamr/validate/validate_cells.hpp"

namespace pamr::io {

namespace {

using Triangle = std::array<GlobalId, 3>;

/// The counts of all ranks that are not 0. Collective.
std::map<int, std::int64_t> sum_of_counts(const par::Comm& comm, const std::map<int, std::int64_t>& here) {
  std::set<int> types;
  for (const auto& [type, n] : here) types.insert(type);
  std::map<int, std::int64_t> all;
  for (const int type : par::gather_distinct(comm, types)) {
    const auto own = here.find(type);
    if (const auto n = comm.sum(own == here.end() ? 0 : own->second); n > 0) all[type] = n;
  }
  return all;
}

/// Refuses a file with elements that cannot become a mesh of tetrahedra; `cut`: elements of all ranks that were cut.
/// Collective.
void refuse_what_does_not_fit(const par::Comm& comm, const ElementParts& parts, const std::string& source,
                              const std::map<int, std::int64_t>& cut, Exact<bool> split_prisms) {
  auto refused = sum_of_counts(comm, parts.refused);
  const bool helps = refused.empty();
  if (!split_prisms) refused.insert(cut.begin(), cut.end());
  const auto found = listed(refused, {.most = all_items},
                            [](const auto& one) { return fmt::format("{} {}", one.second, name_of_type(one.first)); });
  const bool is_gmsh = source.ends_with(".msh'");
  if (!found.empty())
    throw Error(fmt::format(
        "{}: expected tetrahedra and triangles of first order (points and lines are left out), found {}{}", source,
        found,
        helps ? " (--split-prisms, in Python split_prisms=True, cuts prisms and pyramids into tetrahedra)"
        : found.find("order") != std::string::npos && is_gmsh ? " (gmsh -order 1 makes a mesh of first order)"
                                                              : ""));
  if (comm.sum(std::ssize(parts.tetrahedron)) > 0) return;
  const auto n_triangles = comm.sum(std::ssize(parts.triangle));
  const bool has_groups = comm.any(std::any_of(parts.triangle.begin(), parts.triangle.end(),
                                               [](const TaggedTriangle& triangle) { return triangle.group > 0; }));
  throw Error(fmt::format("{}: expected tetrahedra, found {}{}", source,
                          n_triangles > 0 ? fmt::format("{} triangles alone", n_triangles) : "none",
                          is_gmsh && has_groups
                              ? ": where there are groups Gmsh saves only these, and a Physical Volume is missing (or "
                                "Mesh.SaveAll = 1)"
                              : ""));
}

/// Dimension and number of the groups that elements of any rank belong to, ascending: all of triangles, those of
/// tetrahedra that have a name. Collective.
std::vector<std::array<std::int64_t, 2>> all_groups(const par::Comm& comm, const ElementParts& parts) {
  std::set<std::array<std::int64_t, 2>> here;
  std::optional<std::int64_t> last;  // long runs are in one group
  for (const auto& triangle : parts.triangle) {
    if (last != triangle.group) here.insert({2, triangle.group});
    last = triangle.group;
  }
  last.reset();
  const auto add_region = [&](std::int64_t group) {
    if (last == group) return;
    last = group;
    if (parts.group_name.contains({3, group})) here.insert({3, group});
  };
  for (const auto& cell : parts.tetrahedron) add_region(cell.group);
  for (const auto& field : parts.cell_fields)
    if (field.name == mesh::region_field && field.holds_integers())
      for (const auto region : field.integer()) add_region(region);
  return par::gather_distinct(comm, here);
}

/// Collective.
std::vector<UnusedGroup> unused_groups(const par::Comm& comm, const ElementParts& parts,
                                       const std::vector<std::array<std::int64_t, 2>>& groups) {
  struct Count {
    int dimension;
    std::int64_t group, n;
  };
  std::vector<Count> here;
  for (const auto& [group, n] : parts.n_in_group) here.push_back({group.first, group.second, n});
  std::map<std::pair<int, std::int64_t>, std::int64_t> n_elements;
  for (const auto& [group, name] : parts.group_name)
    if (!name.empty()) n_elements[group] = 0;
  for (const auto& [dimension, group] : groups) n_elements.erase({static_cast<int>(dimension), group});
  for (const auto& [joint, members] : parts.joint) {
    n_elements.erase(joint);
    for (const auto member : members) n_elements.erase({joint.first, member});
  }
  for (const auto& [dimension, group, n] : par::gather_few(comm, std::move(here))) n_elements[{dimension, group}] += n;
  std::vector<UnusedGroup> unused;
  for (const auto& [group, n] : n_elements) {
    const auto named = parts.group_name.find(group);
    unused.push_back({group.first,
                      named != parts.group_name.end() && !named->second.empty()
                          ? named->second
                          : fmt::format("physical_{}", group.second),
                      n});
  }
  return unused;
}

/// The region of each cell of this rank: its group, 0 without one. Where no cell has a group, several volumes of the
/// geometry are regions by their numbers. Collective.
std::vector<std::int64_t> regions_of(const par::Comm& comm, const ElementParts& parts) {
  std::int64_t least = std::numeric_limits<std::int64_t>::max(), greatest = std::numeric_limits<std::int64_t>::min();
  for (const auto& cell : parts.tetrahedron) {
    least = std::min(least, cell.group);
    greatest = std::max(greatest, cell.group);
  }
  least = comm.min(least);
  greatest = comm.max(greatest);
  const bool by_volume = greatest < 0 && least != greatest && !parts.has_signed_regions;
  std::vector<std::int64_t> region;
  reserve_array(region, parts.tetrahedron.size());
  for (const auto& cell : parts.tetrahedron)
    region.push_back(parts.has_signed_regions ? cell.group
                     : by_volume              ? -cell.group
                                              : std::max<std::int64_t>(cell.group, 0));
  using Stored = std::numeric_limits<std::int32_t>;
  par::agree(comm, [&] {
    for (const auto number : region)
      if (number < Stored::min() || number > Stored::max())
        throw Error(fmt::format("expected regions with numbers of 32 bits, found {}", number));
  });
  return region;
}

/// Physical volumes with a name, ascending.
std::vector<mesh::Region> named_regions(const ElementParts& parts) {
  std::vector<mesh::Region> regions;
  for (const auto& [group, name] : parts.group_name)
    if (group.first == 3 && !name.empty()) regions.push_back({group.second, name});
  return regions;
}

/// The triangle that cannot be used, by the numbers that it was given with, and its patch. Collective.
std::string first_misfit(const par::Comm& comm, const ElementParts& parts, const assemble::BoundaryMatch& match,
                         const std::function<std::string(std::int64_t group)>& name_of_group) {
  std::vector<TaggedTriangle> found;
  if (match.first_misfit && match.first_misfit->rank == comm.rank())
    found.push_back(parts.triangle[static_cast<std::size_t>(match.first_misfit->row)]);
  found = par::gather_few(comm, std::move(found));
  if (found.empty()) return {};
  const auto& [a, b, c] = found.front().node;
  return fmt::format(", the first with nodes {}, {} and {} in '{}'", a, b, c, name_of_group(found.front().group));
}

/// Local.
void require_fitting_triangles(const assemble::BoundaryMatch& match, const std::string& source,
                               const std::string& first) {
  if (match.n_apart > 0)
    throw Error(
        fmt::format("{}: expected tagged triangles that are faces of the tetrahedra, found {} apart from the "
                    "cells{}: their surfaces have to be left out",
                    source, match.n_apart, first));
  if (match.n_contradictions > 0)
    throw Error(fmt::format("{}: expected one tag for each face, found {} faces in two surfaces{}", source,
                            match.n_contradictions, first));
}

/// Leaves out the patches that have no face: all of theirs are in another one. Collective.
void drop_patches_without_faces(const par::Comm& comm, mesh::DistMesh& mesh) {
  const mesh::InnerPatches faces(mesh);
  std::vector<std::int64_t> n_faces(mesh.info.patches.size(), 0);
  const auto for_each = [&](auto&& visit) {
    for (LocalId c = 0; c < mesh.n_cells(); ++c)
      for (int slot = 0; slot < 4; ++slot)
        if (const int patch = faces.of_any({c, slot}); patch >= 0) visit(c, slot, at(patch));
  };
  for_each([&](LocalId, int, std::size_t patch) { ++n_faces[patch]; });
  comm.sum_in_place(n_faces);
  std::vector<int> now(n_faces.size(), -1);
  std::vector<mesh::Patch> kept;
  for (std::size_t p = 0; p < n_faces.size(); ++p) {
    if (n_faces[p] == 0) continue;
    now[p] = static_cast<int>(kept.size());
    kept.push_back(mesh.info.patches[p]);
  }
  mesh.info.patches = std::move(kept);
  auto* word = mesh.find_cell_field(mesh::inner_patch_field);
  for_each([&](LocalId c, int slot, std::size_t patch) {
    auto& next = mesh.cell_to_cell[at(c)][at(slot)];
    if (next < 0)
      next = mesh::patch_to_slot(now[patch]);
    else
      word->integer()[at(c)] = mesh::with_inner_patch(word->integer()[at(c)], slot, now[patch]);
  });
}

/// Faces whose two cells lie on the same side, which have positive volumes. Collective.
std::int64_t count_folds(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::int64_t n = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      const auto next = mesh.cell_to_cell[at(c)][at(slot)];
      if (!mesh.is_own(next) || next < c) continue;
      const auto& back = mesh.cell_to_cell[at(next)];
      const auto there = static_cast<int>(std::find(back.begin(), back.end(), c) - back.begin());
      if (validate::face_sign(mesh, {c, slot}) == validate::face_sign(mesh, {next, there})) ++n;
    }
  par::Pattern border{mesh.border_rank, mesh.border_offset, {}};
  std::vector<int> sign;
  for (const auto& face : mesh.border_face) {
    border.item.push_back(static_cast<LocalId>(sign.size()));
    sign.push_back(validate::face_sign(mesh, face));
  }
  const par::Exchange exchange(comm, border);
  par::fold_shared(
      exchange, [&](LocalId k) { return sign[at(k)]; },
      [&](LocalId k, int theirs) {
        const auto own = mesh.cell_global[at(mesh.border_face[at(k)].cell)];
        if (theirs == sign[at(k)] && own < mesh.ghost_global[at(k)]) ++n;
      });
  return comm.sum(n);
}

/// Where the ordered mesh has put the nodes: triangles in its numbers. Collective.
void renumber(const par::Comm& comm, const order::Ordered& ordered, GlobalId n_nodes, std::vector<Triangle>& triangle) {
  const auto own = par::block_range(n_nodes, comm.rank(), comm.size());
  std::vector<GlobalId> now(ordered.node_origin.size());
  for (std::size_t i = 0; i < now.size(); ++i) now[i] = own.begin + static_cast<GlobalId>(i);
  const auto new_number = par::scatter_rows<GlobalId>(comm, n_nodes, now, 1, ordered.node_origin);
  std::vector<GlobalId> flat;
  for (const auto& face : triangle) flat.insert(flat.end(), face.begin(), face.end());
  // a node that only triangles have was left out: such a triangle is apart from the cells
  std::vector<GlobalId> known;
  std::copy_if(flat.begin(), flat.end(), std::back_inserter(known), [](GlobalId node) { return node >= 0; });
  const auto answer = par::fetch_rows<GlobalId>(comm, n_nodes, new_number, 1, known);
  auto next = answer.begin();
  for (auto& node : flat)
    if (node >= 0) node = *next++;
  for (std::size_t t = 0; t < triangle.size(); ++t) triangle[t] = {flat[3 * t], flat[3 * t + 1], flat[3 * t + 2]};
}

/// What `work()` does; an `Error` that it throws gets the source in front. `work` may communicate.
template <class Work>
void with_source(const std::string& source, Work&& work) {
  try {
    work();
  } catch (const Error& error) {  // reaches every rank
    throw Error(source + ": " + error.what());
  }
}

/// The cells with their fields. Takes what it can of `numbered`. Collective.
mesh::BlockMesh block_of(const par::Comm& comm, ElementParts& parts, Numbered& numbered) {
  mesh::BlockMesh block;
  const auto n_cells = std::ssize(numbered.cell);
  block.info.n_global_nodes = numbered.n_nodes;
  block.info.n_global_cells = comm.sum(n_cells);
  block.first_cell = comm.exclusive_sum(n_cells);
  block.node_position = std::move(numbered.position);
  block.cell_to_node = std::move(numbered.cell);
  if (parts.has_regions)
    block.cell_fields.push_back({mesh::region_field, "", 1, mesh::StorageType::int32, regions_of(comm, parts)});
  for (auto& field : parts.cell_fields) block.cell_fields.push_back(std::move(field));
  block.node_fields = std::move(numbered.node_fields);
  return block;
}

/// Patches of one name become `NAME`, `NAME_2`, `NAME_3`, ..., which is said once.
void tell_apart(std::vector<mesh::Patch>& patches, std::vector<std::string>& remarks) {
  std::set<std::string> taken, seen;
  for (const auto& patch : patches) taken.insert(patch.name);
  std::map<std::string, int> last;
  std::string remark;
  std::int64_t n_changed = 0;
  for (auto& patch : patches) {
    if (seen.insert(patch.name).second) continue;
    auto& number = last.try_emplace(patch.name, 1).first->second;
    std::string name;
    do name = fmt::format("{}_{}", patch.name, ++number);
    while (!taken.insert(name).second);
    if (++n_changed == 1)
      remark = fmt::format("two patches have the name '{}': the later one is called '{}'", shown_text(patch.name),
                           shown_text(name));
    patch.name = name;
  }
  if (n_changed > 1) remark += fmt::format(", and {} more get other names, too", n_changed - 1);
  if (n_changed > 0) remarks.push_back(remark);
}

struct InOrder {
  ElementMesh& result;
  std::vector<Triangle>& triangle;  ///< by the numbers of nodes, which change
};

/// Puts the cells in order where that is asked for, and makes a mesh of them. Collective.
void assemble_in_order(const par::Comm& comm, mesh::BlockMesh block, Numbered& numbered, const ElementOptions& options,
                       const InOrder& to) {
  auto origin = std::move(numbered.origin);
  if (options.order == CellOrder::curve || (options.order == CellOrder::automatic && !order::is_ordered(comm, block))) {
    auto ordered = order::order_along_curve(comm, std::move(block));
    renumber(comm, ordered, numbered.n_nodes, to.triangle);
    block = std::move(ordered.block);
    if (options.with_origin) {
      block.cell_origin = std::move(ordered.cell_origin);
      origin = par::fetch_rows<GlobalId>(comm, numbered.n_nodes, origin, 1, ordered.node_origin);
    }
  }
  to.result.mesh = assemble::assemble(comm, std::move(block));
  to.result.mesh.info.patches.clear();
  if (options.with_origin)
    to.result.node_origin =
        par::fetch_rows<GlobalId>(comm, to.result.mesh.info.node_ids(), origin, 1, to.result.mesh.node_global);
}

}  // namespace

std::string source_of(const std::filesystem::path& file) { return fmt::format("file '{}'", file.string()); }

ElementMesh mesh_of_elements(const par::Comm& comm, ElementParts parts, const std::string& source,
                             const ElementOptions& options,
                             const std::function<mesh::Patch(std::int64_t group)>& patch_of_group) {
  const auto cut = sum_of_counts(comm, parts.cut);
  refuse_what_does_not_fit(comm, parts, source, cut, options.split_prisms);
  auto numbered = number_elements(comm, parts, source, options.with_origin);

  ElementMesh result;
  result.n_dropped_nodes = numbered.n_dropped;
  result.n_periodic_links = parts.n_periodic_links;
  result.n_untagged_triangles = comm.sum(parts.n_untagged_triangles);
  result.why_empty = parts.why_empty;
  result.cut = cut;
  if (auto text = text_of_cut(cut); !text.empty()) result.notes.push_back(std::move(text));
  if (!parts.left_out.empty()) result.remarks.push_back(text_of_left_out(parts.left_out));
  const auto of_all = all_groups(comm, parts);
  result.unused_groups = unused_groups(comm, parts, of_all);
  std::vector<std::int64_t> groups;
  for (const auto& [dimension, group] : of_all)
    if (dimension == 2) groups.push_back(group);
  const auto place_of = [&](std::int64_t group) {
    return static_cast<std::size_t>(std::lower_bound(groups.begin(), groups.end(), group) - groups.begin());
  };
  mesh::BoundaryTriangles boundary;
  for (const auto& triangle : parts.triangle) boundary.patch.push_back(static_cast<int>(place_of(triangle.group)));

  boundary.node = std::move(numbered.triangle);
  const auto* const of_cut = result.notes.empty() ? "" : " (a prism or pyramid that was cut may be flat or twisted)";
  with_source(source, [&] {
    auto block = block_of(comm, parts, numbered);
    free_array(parts.tetrahedron);
    par::agree(comm, [&] {
      for (const auto p : block.node_position)
        if (!geometry::is_in_range(p))
          throw Error(fmt::format("expected coordinates below {}, found {:g}, {:g}, {:g}",
                                  geometry::max_coordinate_text, p.x, p.y, p.z));
      for (const auto& field : block.cell_fields) mesh::require_inner_patches(field, 0);  // it is no field of ours
    });
    const auto [n_turned, n_flat] = assemble::orient(comm, block, options.repair);
    if (n_flat > 0) throw Error(fmt::format("expected cells with a volume, found {} flat ones{}", n_flat, of_cut));
    result.n_turned = n_turned;
    assemble_in_order(comm, std::move(block), numbered, options, {result, boundary.node});
    if (const auto n_folds = count_folds(comm, result.mesh); n_folds > 0)
      throw Error(
          fmt::format("expected cells on either side of a face, found {} faces with two on one side: cells are "
                      "folded over their neighbors{}",
                      n_folds, of_cut));
  });
  auto& patches = result.mesh.info.patches;
  for (const auto group : groups) patches.push_back(patch_of_group(group));
  tell_apart(patches, result.remarks);
  result.mesh.info.regions = named_regions(parts);
  with_source(source, [&] {
    for (std::size_t p = 0; p < patches.size(); ++p)
      require_clean_name(fmt::format("patch {}", groups[p]), patches[p].name);
    for (const auto& region : result.mesh.info.regions)
      require_clean_name(fmt::format("region {}", region.number), region.name);
  });
  const auto untagged = mesh::find_untagged(patches);
  const auto match = assemble::match_boundary(comm, result.mesh, boundary, static_cast<int>(untagged));
  require_fitting_triangles(match, source, first_misfit(comm, parts, match, [&](std::int64_t group) {
                              return patches[place_of(group)].name;
                            }));
  result.n_untagged_faces = mesh::count_faces_of(comm, result.mesh, static_cast<int>(untagged));
  for (std::size_t p = 0; p < match.n_inner.size(); ++p)
    if (match.n_inner[p] > 0) result.inner_faces[patches[p].name] = match.n_inner[p];
  for (const auto& [pair, n] : match.in_two_patches)
    result.overlaps.push_back({2, patches[at(pair.first)].name, patches[at(pair.second)].name, n});
  if (result.n_untagged_faces > 0 && untagged == patches.size()) patches.push_back(mesh::untagged_patch(patches));
  if (!match.in_two_patches.empty()) drop_patches_without_faces(comm, result.mesh);
  return result;
}

}  // namespace pamr::io
