// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/element_remarks.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "pamr/base/counted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/mesh/periodic_patches.hpp"
#include "pamr/mesh/untagged_patch.hpp"

namespace pamr::io {

namespace {

constexpr std::array<std::string_view, 4> element_of{"point", "line", "triangle", "tetrahedron"};
constexpr std::array<std::string_view, 4> elements_of{"points", "lines", "triangles", "tetrahedra"};

/// "1 triangle", "2 triangles".
std::string counted_elements(std::int64_t n, int dimension) {
  return counted(n, element_of.at(static_cast<std::size_t>(dimension)),
                 elements_of.at(static_cast<std::size_t>(dimension)));
}

/// Named groups without elements in one remark, those of points and lines in one each.
void add_unused_groups(const ElementMesh& read, std::vector<std::string>& remarks) {
  std::vector<std::string> names;
  for (const auto& group : read.unused_groups) {
    const auto elements = elements_of.at(static_cast<std::size_t>(group.dimension));
    if (group.n_elements > 0) {
      remarks.push_back(fmt::format("{} of the group '{}' {} left out: a mesh has groups of triangles and tetrahedra",
                                    counted_elements(group.n_elements, group.dimension), group.name,
                                    group.n_elements == 1 ? "was" : "were"));
      continue;
    }
    names.push_back(fmt::format("'{}' ({})", group.name, elements));
  }
  if (names.empty()) return;
  remarks.push_back(fmt::format("{} no element: {}{}",
                                counted(std::ssize(names), "named group has", "named groups have"), listed(names),
                                read.why_empty.empty() ? "" : ": " + read.why_empty));
}

}  // namespace

std::string remark_on_untagged(const ElementMesh& read) {
  if (read.n_untagged_faces == 0) return {};
  return fmt::format("{} in the patch '{}'",
                     counted(read.n_untagged_faces, "boundary face without tag is", "boundary faces without tag are"),
                     read.mesh.info.patches.at(mesh::find_untagged(read.mesh.info.patches)).name);
}

std::vector<std::string> remarks_of(const ElementMesh& read) {
  std::vector<std::string> remarks;
  for (const auto& overlap : read.overlaps)
    remarks.push_back(fmt::format("{} {} in the group '{}' and in '{}': {} in '{}', {}",
                                  counted_elements(overlap.n_elements, overlap.dimension),
                                  overlap.n_elements == 1 ? "is" : "are", overlap.kept, overlap.other,
                                  overlap.n_elements == 1 ? "it stays" : "they stay", overlap.kept, overlap.why_kept));
  remarks.insert(remarks.end(), read.remarks.begin(), read.remarks.end());
  add_unused_groups(read, remarks);
  if (read.n_turned > 0)
    remarks.push_back(counted(read.n_turned, "inverted cell was", "inverted cells were") + " turned over");
  if (read.n_dropped_nodes > 0)
    remarks.push_back(counted(read.n_dropped_nodes, "node of no cell was", "nodes of no cell were") + " left out");
  if (read.n_untagged_triangles > 0)
    remarks.push_back(counted(read.n_untagged_triangles, "triangle without tag was", "triangles without tag were") +
                      " left out");
  if (auto remark = remark_on_untagged(read); !remark.empty()) remarks.push_back(std::move(remark));
  if (auto warning = mesh::warning_of_periodic(read.mesh.info.patches); !warning.empty())
    remarks.push_back(std::move(warning));
  return remarks;
}

void refuse_changes(const ElementMesh& read, const std::string& source) {
  const auto refuse = [&](std::int64_t n, const char* text) {
    if (n > 0) throw Error(source + ": expected " + fmt::format(fmt::runtime(text), n));
  };
  for (const auto& one : read.overlaps)
    throw Error(fmt::format("{}: expected elements in one group each, found {} {} in '{}' and in '{}'", source,
                            one.n_elements, elements_of.at(static_cast<std::size_t>(one.dimension)), one.kept,
                            one.other));
  for (const auto& group : read.unused_groups)
    throw Error(
        group.n_elements > 0
            ? fmt::format("{}: expected groups of triangles and tetrahedra, found '{}' with {} {}", source, group.name,
                          group.n_elements, elements_of.at(static_cast<std::size_t>(group.dimension)))
            : fmt::format("{}: expected elements in every named group, found none in '{}'", source, group.name));
  refuse(read.n_untagged_triangles, "a tag on every triangle, found {} without");
  refuse(read.n_turned, "cells of positive volume, found {} inverted ones");
  refuse(read.n_periodic_links, "no periodic links, found {}");
  refuse(read.n_dropped_nodes, "nodes that belong to cells, found {} others");
  refuse(read.n_untagged_faces, "a tag on every boundary face, found {} faces without");
  for (const auto& remark : read.remarks) throw Error(source + ": " + remark);
}

}  // namespace pamr::io
