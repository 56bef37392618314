// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: SU2 documentation, "Mesh File".
#include "pamr/io/su2/write_su2.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/io/elements/boundary_rows.hpp"
#include "pamr/io/elements/numbers.hpp"
#include "pamr/io/rows_in_order.hpp"
#include "pamr/io/shared_output.hpp"

namespace pamr::io {

namespace {

std::vector<std::string> names_of_markers(const std::vector<std::string>& patches, const Remark& remark) {
  const NameRule rule{.format = "SU2",
                      .what = "patch",
                      .is_allowed = [](char c) { return std::string_view(" \t%=").find(c) == std::string_view::npos; },
                      .taken = {"SEND_RECEIVE"}};
  return written_names(rule, patches, remark);
}

}  // namespace

void write_su2(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
               const Remark& remark) {
  const auto rows = rows_in_order(comm, mesh);
  const auto names = names_of_markers(rows.group_name, remark);
  const auto boundary = boundary_rows(rows);
  SharedOutput out(comm, file);
  std::string text;
  for (const auto& nodes : rows.cell_to_node) {
    text += "10";
    for (const auto node : nodes) append_text(text, node);
    text += '\n';
  }
  out.append_once(fmt::format("NDIME= 3\nNELEM= {}\n", mesh.info.n_global_cells));
  out.append(text);
  text.clear();
  for (const auto p : rows.position) {
    for (const auto x : {p.x, p.y, p.z}) append_text(text, x);
    text += '\n';
  }
  out.append_once(fmt::format("NPOIN= {}\n", rows.n_nodes));
  out.append(text);
  std::vector<std::string> lines(names.size());
  std::vector<std::int64_t> n_faces(names.size());
  for (const auto& face : boundary) {
    auto& line = lines[at(face.patch)];
    line += '5';
    for (const auto node : face.node) append_text(line, node);
    line += '\n';
    ++n_faces[at(face.patch)];
  }
  comm.sum_in_place(n_faces);
  // Not all programs expect markers without elements.
  const auto n_empty = std::count(n_faces.begin(), n_faces.end(), 0);
  out.append_once(fmt::format("NMARK= {}\n", std::ssize(names) - n_empty));
  for (std::size_t p = 0; p < names.size(); ++p) {
    if (n_faces[p] == 0) continue;
    out.append_once(fmt::format("MARKER_TAG= {}\nMARKER_ELEMS= {}\n", names[p], n_faces[p]));
    out.append(lines[p]);
  }
  out.commit();
}

}  // namespace pamr::io
