// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/mesh_of_elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/tag_boundary.hpp"
#include "pamr/assemble/turn_inverted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/with_file_name.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/order/order_along_curve.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/gather_few.hpp"

namespace pamr::io {

namespace {

using Triangle = std::array<GlobalId, 3>;

/// What the file holds that cannot become a mesh of tetrahedra. Collective.
void refuse_what_does_not_fit(const par::Comm& comm, const ElementParts& parts, const std::string& file) {
  std::string found;
  for (int type = 1; type <= 125; ++type) {
    const auto here = parts.refused.find(type);
    const bool is_anywhere = n_nodes_of_type(type) > 0;
    const auto n = is_anywhere ? comm.sum(here == parts.refused.end() ? 0 : here->second) : 0;
    if (n > 0) found += fmt::format("{}{} {}", found.empty() ? "" : ", ", n, name_of_type(type));
  }
  if (!found.empty())
    throw Error("file '" + file +
                "': expected tetrahedra and triangles of first order (points and lines are left out), "
                "found " +
                found +
                (found.find("order") != std::string::npos && file.ends_with(".msh")
                     ? " (gmsh -order 1 makes a mesh of first order)"
                     : ""));
  if (comm.sum(static_cast<std::int64_t>(parts.tetrahedron.size())) == 0)
    throw Error("file '" + file + "': expected tetrahedra, found none");
}

/// From the numbers that the file gives its nodes to their place in the file. Collective.
class NodeTable {
 public:
  NodeTable(const par::Comm& comm, const ElementParts& parts, const std::string& file) : comm_(comm), file_(file) {
    std::int64_t least = std::numeric_limits<std::int64_t>::max(), greatest = 0;
    for (const auto tag : parts.node_tag) {
      least = std::min(least, tag);
      greatest = std::max(greatest, tag);
    }
    least = comm.min(least);
    greatest = comm.max(greatest);
    if (parts.n_nodes == 0) throw Error("file '" + file + "': expected nodes, found none");
    if (least < 0 || greatest - least >= 64 * parts.n_nodes + 1024)
      throw Error(fmt::format(
          "file '{}': expected node numbers from 0 on without wide gaps, found numbers from {} to {} for {} nodes",
          file, least, greatest, parts.n_nodes));
    tags_ = {greatest - least + 1, least};
    std::vector<GlobalId> place(parts.node_tag.size());
    const auto own = par::block_range(parts.n_nodes, comm.rank(), comm.size());
    for (std::size_t i = 0; i < place.size(); ++i) place[i] = own.begin + static_cast<GlobalId>(i) + 1;
    place_ = par::scatter_rows<GlobalId>(comm, tags_, place, 1, parts.node_tag);
    const auto back = par::fetch_rows<GlobalId>(comm, tags_, place_, 1, parts.node_tag);
    par::agree(comm, [&] {
      for (std::size_t i = 0; i < back.size(); ++i)
        if (back[i] != place[i])
          throw Error(
              fmt::format("file '{}': expected every node number once, found {} twice", file_, parts.node_tag[i]));
    });
  }

  /// Replaces numbers by places. Collective.
  void translate(std::vector<GlobalId>& tags) const {
    par::agree(comm_, [&] {
      for (const auto tag : tags)
        if (!tags_.contains(tag)) fail(tag);
    });
    auto place = par::fetch_rows<GlobalId>(comm_, tags_, place_, 1, tags);
    par::agree(comm_, [&] {
      for (std::size_t i = 0; i < tags.size(); ++i)
        if (place[i]-- == 0) fail(tags[i]);
    });
    tags = std::move(place);
  }

 private:
  [[noreturn]] void fail(GlobalId tag) const {
    throw Error(fmt::format("file '{}': expected elements of nodes that are there, found node number {}", file_, tag));
  }

  const par::Comm& comm_;
  const std::string& file_;
  IdRange tags_{0};
  std::vector<GlobalId> place_;
};

/// Cells and boundary triangles by the places of their nodes.
struct Numbered {
  std::vector<std::array<GlobalId, 4>> cell;
  std::vector<Triangle> triangle;
  GlobalId n_nodes = 0;
  std::vector<geometry::Vec3> position;      ///< canonical block
  std::vector<mesh::NodeField> node_fields;  ///< canonical block
  std::int64_t n_dropped = 0;
};

template <class Item>
std::vector<GlobalId> flatten(const std::vector<Item>& items) {
  std::vector<GlobalId> flat;
  flat.reserve(items.size() * std::tuple_size_v<decltype(Item::node)>);
  for (const auto& item : items) flat.insert(flat.end(), item.node.begin(), item.node.end());
  return flat;
}

/// Rows of this rank's block, sent to where their new numbers belong. Collective.
template <class T>
std::vector<T> chosen_rows(const par::Comm& comm, GlobalId n, const std::vector<T>& all, std::size_t width,
                           const std::vector<std::size_t>& rows, const std::vector<GlobalId>& new_number) {
  std::vector<T> chosen;
  chosen.reserve(rows.size() * width);
  for (const auto row : rows)
    for (std::size_t k = 0; k < width; ++k) chosen.push_back(all[row * width + k]);
  return par::scatter_rows<T>(comm, n, chosen, width, new_number);
}

/// Leaves out the nodes that no cell has and closes the gaps in the numbering. Collective.
Numbered number(const par::Comm& comm, const ElementParts& parts, const std::string& file) {
  const NodeTable table(comm, parts, file);
  auto corners = flatten(parts.tetrahedron), of_triangles = flatten(parts.triangle);
  table.translate(corners);
  table.translate(of_triangles);

  const std::vector<std::uint8_t> one(corners.size(), 1);
  const auto is_used = par::scatter_rows<std::uint8_t>(comm, parts.n_nodes, one, 1, corners);
  Numbered result;
  std::int64_t n_used = 0;
  for (const auto used : is_used) n_used += used;
  auto next = comm.exclusive_sum(n_used);
  result.n_nodes = comm.sum(n_used);
  result.n_dropped = parts.n_nodes - result.n_nodes;
  std::vector<GlobalId> new_number(is_used.size(), -1), kept;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < is_used.size(); ++i)
    if (is_used[i] != 0) {
      new_number[i] = next++;
      kept.push_back(new_number[i]);
      rows.push_back(i);
    }
  result.position = chosen_rows(comm, result.n_nodes, parts.position, 1, rows, kept);
  result.node_fields = parts.node_fields;
  for (auto& field : result.node_fields)
    std::visit(
        [&](auto& values) { values = chosen_rows(comm, result.n_nodes, values, at(field.n_components), rows, kept); },
        field.value);
  corners = par::fetch_rows<GlobalId>(comm, parts.n_nodes, new_number, 1, corners);
  of_triangles = par::fetch_rows<GlobalId>(comm, parts.n_nodes, new_number, 1, of_triangles);
  for (std::size_t i = 0; i < corners.size(); i += 4)
    result.cell.push_back({corners[i], corners[i + 1], corners[i + 2], corners[i + 3]});
  for (std::size_t i = 0; i < of_triangles.size(); i += 3)
    result.triangle.push_back({of_triangles[i], of_triangles[i + 1], of_triangles[i + 2]});
  return result;
}

/// All groups that triangles of any rank belong to, ascending. Collective.
std::vector<std::int64_t> all_groups(const par::Comm& comm, const ElementParts& parts) {
  std::set<std::int64_t> here;
  for (const auto& triangle : parts.triangle) here.insert(triangle.group);
  return par::gather_distinct(comm, here);
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
  const bool by_volume = greatest < 0 && least != greatest;
  std::vector<std::int64_t> region;
  for (const auto& cell : parts.tetrahedron)
    region.push_back(by_volume ? -cell.group : std::max<std::int64_t>(cell.group, 0));
  return region;
}

/// Physical volumes with a name, ascending.
std::vector<mesh::Region> named_regions(const ElementParts& parts) {
  std::vector<mesh::Region> regions;
  for (const auto& [group, name] : parts.group_name)
    if (group.first == 3 && !name.empty()) regions.push_back({group.second, name});
  return regions;
}

/// Gives boundary faces the patches of the triangles on them; faces without triangle get `untagged`. Collective.
assemble::BoundaryMatch tag_faces(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& boundary,
                                  int untagged, const std::string& file) {
  std::vector<mesh::CellFace> between;
  for (const auto& [face, regions] : mesh::faces_between_regions(comm, mesh)) between.push_back(face);
  const auto match = assemble::match_boundary(comm, mesh, boundary, untagged, between);
  if (match.n_not_on_boundary > 0)
    throw Error(
        fmt::format("file '{}': expected tagged triangles on the boundary of the tetrahedra or between two regions of "
                    "them (groups of volumes), found {} inside a region or apart from the cells: their surfaces have "
                    "to be left out of the file",
                    file, match.n_not_on_boundary));
  if (match.n_contradictions > 0)
    throw Error(fmt::format("file '{}': expected one tag for each boundary face, found {} faces in two surfaces", file,
                            match.n_contradictions));
  return match;
}

/// Leaves out the patches that have no face of the boundary: those of interfaces. Collective.
void drop_patches_without_faces(const par::Comm& comm, mesh::DistMesh& mesh) {
  std::vector<std::int64_t> n_faces(mesh.info.patches.size(), 0);
  for (const auto& neighbors : mesh.cell_to_cell)
    for (const auto neighbor : neighbors)
      if (neighbor < 0) ++n_faces[at(mesh::slot_to_patch(neighbor))];
  comm.sum_in_place(n_faces);
  std::vector<int> now(n_faces.size(), -1);
  std::vector<mesh::Patch> kept;
  for (std::size_t p = 0; p < n_faces.size(); ++p) {
    if (n_faces[p] == 0) continue;
    now[p] = static_cast<int>(kept.size());
    kept.push_back(mesh.info.patches[p]);
  }
  mesh.info.patches = std::move(kept);
  for (auto& neighbors : mesh.cell_to_cell)
    for (auto& neighbor : neighbors)
      if (neighbor < 0) neighbor = mesh::patch_to_slot(now[at(mesh::slot_to_patch(neighbor))]);
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
  std::vector<std::size_t> known;
  std::vector<GlobalId> ask;
  for (std::size_t i = 0; i < flat.size(); ++i)
    if (flat[i] >= 0) {
      known.push_back(i);
      ask.push_back(flat[i]);
    }
  const auto answer = par::fetch_rows<GlobalId>(comm, n_nodes, new_number, 1, ask);
  for (std::size_t k = 0; k < known.size(); ++k) flat[known[k]] = answer[k];
  for (std::size_t t = 0; t < triangle.size(); ++t) triangle[t] = {flat[3 * t], flat[3 * t + 1], flat[3 * t + 2]};
}

}  // namespace

ElementMesh mesh_of_elements(const par::Comm& comm, ElementParts parts, const std::string& file,
                             const ElementOptions& options,
                             const std::function<mesh::Patch(std::int64_t group)>& patch_of_group) {
  refuse_what_does_not_fit(comm, parts, file);
  auto numbered = number(comm, parts, file);

  ElementMesh result;
  result.n_dropped_nodes = numbered.n_dropped;
  result.n_periodic_links = parts.n_periodic_links;
  const auto groups = all_groups(comm, parts);
  mesh::BoundaryTriangles boundary;
  for (const auto& triangle : parts.triangle)
    boundary.patch.push_back(
        static_cast<int>(std::lower_bound(groups.begin(), groups.end(), triangle.group) - groups.begin()));

  mesh::BlockMesh block;
  block.info.n_global_nodes = numbered.n_nodes;
  block.info.n_global_cells = comm.sum(static_cast<std::int64_t>(numbered.cell.size()));
  block.first_cell = comm.exclusive_sum(static_cast<std::int64_t>(numbered.cell.size()));
  block.node_position = std::move(numbered.position);
  block.cell_to_node = std::move(numbered.cell);
  with_file_name(file, [&] {
    const auto [n_turned, n_flat] = assemble::orient(comm, block, options.repair);
    if (n_flat > 0) throw Error(fmt::format("expected cells with a volume, found {} flat ones", n_flat));
    result.n_turned = n_turned;
  });
  if (parts.has_regions)
    block.cell_fields.push_back({mesh::region_field, "", 1, mesh::StorageType::int32, regions_of(comm, parts)});
  for (auto& field : parts.cell_fields) block.cell_fields.push_back(std::move(field));
  block.node_fields = std::move(numbered.node_fields);
  parts.tetrahedron = {};

  with_file_name(file, [&] {
    auto ordered = order::order_along_curve(comm, std::move(block));
    renumber(comm, ordered, numbered.n_nodes, numbered.triangle);
    result.mesh = assemble::assemble(comm, std::move(ordered.block));
  });
  auto& patches = result.mesh.info.patches;
  patches.clear();
  for (const auto group : groups) patches.push_back(patch_of_group(group));
  result.mesh.info.regions = named_regions(parts);
  boundary.node = std::move(numbered.triangle);
  const auto match = tag_faces(comm, result.mesh, boundary, static_cast<int>(patches.size()), file);
  result.n_untagged_faces = match.n_untagged;
  for (std::size_t p = 0; p < match.n_inner.size(); ++p)
    if (match.n_inner[p] > 0) result.inner_faces[patches[p].name] = match.n_inner[p];
  if (result.n_untagged_faces > 0) patches.push_back({"boundary", ""});
  if (!result.inner_faces.empty()) drop_patches_without_faces(comm, result.mesh);
  return result;
}

}  // namespace pamr::io
