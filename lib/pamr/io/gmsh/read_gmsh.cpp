// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/gmsh/read_gmsh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pamr/io/elements/first_line.hpp"
#include "pamr/io/elements/read_shares.hpp"
#include "pamr/io/gmsh/gmsh_parts.hpp"
#include "pamr/io/gmsh/group_overlaps.hpp"
#include "pamr/io/gmsh/read_gmsh_2.hpp"
#include "pamr/io/gmsh/read_gmsh_4.hpp"
#include "pamr/mesh/periodic_patches.hpp"
#include "pamr/par/gather_few.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::io {

namespace {

using gmsh::Parts;

struct MshFormat {
  double version = 0;
  bool is_binary = false;
};

/// Passes empty lines and comments, which Gmsh allows before all sections, and the first line.
void read_beginning(TextCursor& in) {
  in.skip_byte_order_mark();
  for (;;) {
    const auto begin = in;
    const auto line = gmsh::without_blanks_behind(in.line());
    if (line == "$MeshFormat") return;
    if (line == "$Comments")
      in.skip_to_line("$EndComments");
    else if (!line.empty() || in.at_end())
      begin.fail("a Gmsh file that begins with $MeshFormat", what_begins(begin.rest()));
  }
}

MshFormat read_format(TextCursor& in) {
  read_beginning(in);
  const double version = in.real("the version of the format");
  const auto kind = in.integer("0 for text or 1 for binary"), size = in.integer("the size of a real");
  const bool is_older = version >= 2 && version < 2.2;  // as netgen writes it: cells and surfaces are those of 2.2
  if (!is_older && version != 2.2 && version != 4.1)
    in.fail("version 2.2 or 4.1 of the format",
            fmt::format("{} (gmsh OLD.msh -save -format msh41 -o NEW.msh)", version));
  if (kind != 0 && kind != 1) in.fail("0 for text or 1 for binary", fmt::format("{}", kind));
  if (size != 8) in.fail("reals of 8 bytes", fmt::format("{}", size));
  (void)in.line();
  if (kind == 1 && in.value<std::int32_t>("a one that shows the order of bytes") != 1)
    in.fail("binary numbers with the least byte first", "another order of bytes");
  auto end = gmsh::without_blanks_behind(in.line());
  if (end.empty()) end = gmsh::without_blanks_behind(in.line());
  if (end != "$EndMeshFormat") in.fail("$EndMeshFormat", "another line");
  return {version, kind == 1};
}

/// Collective.
Parts read_parts(const par::Comm& comm, const std::filesystem::path& file) {
  MshFormat format;
  return read_shares(
      comm, file,
      [&](TextCursor& in) {
        format = read_format(in);
        return !format.is_binary;
      },
      [&](TextCursor& in, Share share) {
        return format.version < 3 ? gmsh::read_parts_2(in, format.is_binary, share)
                                  : gmsh::read_parts_4(in, format.is_binary, share);
      });
}

/// Names without a dimension belong to all groups of their numbers, or else to a surface. Collective.
void place_names(const par::Comm& comm, Parts& parts) {
  std::map<std::int64_t, std::string> names;
  for (const auto& [group, name] : parts.group_name)
    if (group.first == gmsh::unknown_dimension) names[group.second] = name;
  if (names.empty()) return;
  std::set<std::array<std::int64_t, 2>> here;
  const auto add = [&](int dimension, std::int64_t group) {
    if (names.contains(group)) here.insert({dimension, group});
  };
  for (const auto& triangle : parts.triangle) add(2, triangle.group);
  for (const auto& cell : parts.tetrahedron) add(3, cell.group);
  for (const auto& [group, n] : parts.n_in_group) add(group.first, group.second);
  for (const auto& [joint, members] : parts.joint)
    for (const auto member : members) add(joint.first, member);
  std::set<std::int64_t> found;
  for (const auto& [dimension, group] : par::gather_distinct(comm, here)) {
    parts.group_name.emplace(std::pair(static_cast<int>(dimension), group), names[group]);
    found.insert(group);
  }
  for (const auto& [group, name] : names) {
    if (!found.contains(group)) parts.group_name.emplace(std::pair(2, group), name);
    parts.group_name.erase({gmsh::unknown_dimension, group});
  }
}

/// Physical volumes that `write_gmsh` made for regions 0 and below become these again. Local.
void restore_regions(Parts& parts) {
  std::map<std::int64_t, std::int64_t> region_of;
  for (const auto& [group, name] : parts.group_name) {
    if (group.first != 3 || !name.starts_with(gmsh::unnamed_region)) continue;
    std::int64_t number = 1;
    const auto* begin = name.data() + gmsh::unnamed_region.size();
    const auto* end = name.data() + name.size();
    const auto [rest, error] = std::from_chars(begin, end, number);
    if (error == std::errc() && rest == end && number <= 0) region_of[group.second] = number;
  }
  if (region_of.empty()) return;
  for (auto& cell : parts.tetrahedron) {
    const auto found = region_of.find(cell.group);
    cell.group = found != region_of.end() ? found->second : std::max<std::int64_t>(cell.group, 0);
  }
  for (const auto& [group, region] : region_of) parts.group_name.erase({3, group});
  parts.has_signed_regions = true;
}

/// Where no element has a group though groups have names, `Mesh.SaveAll` was set in format 2.2. Collective.
void look_for_lost_groups(const par::Comm& comm, Parts& parts) {
  const auto has_group = [](const auto& element) { return element.group > 0; };
  const bool is_any = !parts.n_in_group.empty() ||
                      std::any_of(parts.triangle.begin(), parts.triangle.end(), has_group) ||
                      std::any_of(parts.tetrahedron.begin(), parts.tetrahedron.end(), has_group);
  if (!comm.any(is_any)) parts.why_empty = "format 2.2 of Gmsh with Mesh.SaveAll leaves groups out, 4.1 keeps them";
}

/// Groups of surfaces that periodic links name. Collective.
std::set<std::int64_t> periodic_groups(const par::Comm& comm, const Parts& parts) {
  par::Mailbox<std::int64_t> box(comm);
  for (const auto surface : parts.linked_surfaces) {
    const auto known = parts.group_of_surface.find(surface);
    box.add(0, known == parts.group_of_surface.end() ? -surface : known->second);
  }
  const auto received = box.send().item;
  const auto all = comm.broadcast(std::vector<std::int64_t>(received.begin(), received.end()));
  return {all.begin(), all.end()};
}

}  // namespace

GmshMesh read_gmsh(const par::Comm& comm, const std::filesystem::path& file, const GmshOptions& options) {
  auto parts = read_parts(comm, file);
  gmsh::join_copies(comm, parts);
  place_names(comm, parts);
  look_for_lost_groups(comm, parts);
  restore_regions(parts);
  gmsh::name_joint_groups(parts);
  Parts known;
  known.group_name = parts.group_name;
  known.joint = parts.joint;
  const auto periodic = periodic_groups(comm, parts);
  const bool has_partitions = comm.any(parts.has_partitions);
  auto read = mesh_of_elements(comm, std::move(parts), source_of(file), options, [&](std::int64_t group) {
    return mesh::Patch{.name = gmsh::name_of_group(known.group_name, 2, group),
                       .kind = periodic.contains(group) ? mesh::periodic_kind : "",
                       .number = group > 0 && !known.joint.contains({2, group}) ? group : -1,
                       .groups = gmsh::members_of(known, 2, group)};
  });
  if (has_partitions) read.remarks.emplace_back("the partitions that elements are in were left out");
  for (auto& region : read.mesh.info.regions) region.groups = gmsh::members_of(known, 3, region.number);
  return read;
}

}  // namespace pamr::io
