// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/gmsh/read_gmsh.hpp"

#include <fmt/format.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pamr/io/elements/read_shares.hpp"
#include "pamr/io/gmsh/gmsh_parts.hpp"
#include "pamr/io/gmsh/group_overlaps.hpp"
#include "pamr/io/gmsh/read_gmsh_2.hpp"
#include "pamr/io/gmsh/read_gmsh_4.hpp"
#include "pamr/mesh/periodic_patches.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::io {

namespace {

using gmsh::Parts;

struct Format {
  double version = 0;
  bool is_binary = false;
};

Format read_format(TextCursor& in) {
  if (in.line() != "$MeshFormat") in.fail("a Gmsh file that begins with $MeshFormat", "another beginning");
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
  auto end = in.line();
  if (end.empty()) end = in.line();
  if (end != "$EndMeshFormat") in.fail("$EndMeshFormat", "another line");
  return {version, kind == 1};
}

/// Collective.
Parts read_parts(const par::Comm& comm, const std::filesystem::path& file) {
  Format format;
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
  gmsh::leave_one_of_each(comm, parts);
  const auto names = parts.group_name;
  const auto periodic = periodic_groups(comm, parts);
  auto overlaps = gmsh::overlaps_of(comm, parts);
  auto read = mesh_of_elements(comm, std::move(parts), file.string(), options, [&](std::int64_t group) {
    return mesh::Patch{gmsh::name_of_group(names, 2, group), periodic.contains(group) ? mesh::periodic_kind : ""};
  });
  read.overlaps = std::move(overlaps);
  return read;
}

}  // namespace pamr::io
