// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: SU2 documentation, "Mesh File".
#include "pamr/io/su2/write_su2.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/io/elements/boundary_rows.hpp"
#include "pamr/io/elements/numbers.hpp"
#include "pamr/io/rows_in_order.hpp"
#include "pamr/io/shared_output.hpp"

namespace pamr::io {

namespace {

std::vector<std::string> names_of_markers(const mesh::MeshInfo& info, const Remark& remark) {
  std::vector<std::string> names, given;
  std::set<std::string> seen;
  for (const auto& patch : info.patches) {
    auto name = patch.name;
    for (auto& c : name)
      if (c == ' ' || c == '\t' || c == '%' || c == '=') c = '_';
    if (!seen.insert(name).second || name == "SEND_RECEIVE")
      throw Error(fmt::format("SU2: expected patches whose names stay different and free without blanks, found '{}'",
                              patch.name));
    names.push_back(name);
    given.push_back(patch.name);
  }
  check_written_names("SU2", "patch", given, names, remark);
  return names;
}

}  // namespace

void write_su2(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
               const Remark& remark) {
  const auto names = names_of_markers(mesh.info, remark);
  const auto rows = rows_in_order(comm, mesh);
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
