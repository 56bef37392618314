// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: OpenFOAM user guide, "Mesh description", and the source of primitiveMesh for the order of
// faces.
#include "pamr/io/export/write_foam.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/io/complete_outputs.hpp"
#include "pamr/io/partial_folder.hpp"
#include "pamr/io/rows_in_order.hpp"
#include "pamr/io/shared_output.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::io {

namespace {

namespace fs = std::filesystem;
using Nodes = std::array<GlobalId, 3>;

/// A face of a cell of this rank's block: its nodes, seen counter-clockwise from outside, and the cells at it.
struct Face {
  GlobalId owner = 0, neighbor = -1;
  Nodes node{};
  int zone = -1;  ///< of a face inside: its patch
};

template <class T>
void append_number(std::string& text, T value) {
  std::array<char, 40> digits{};
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

std::string header(const std::string& kind, const std::string& name, const std::string& note = {}) {
  return "FoamFile\n{\n    version     2.0;\n    format      ascii;\n    class       " + kind + ";\n" +
         (note.empty() ? "" : "    note        \"" + note + "\";\n") +
         "    location    \"constant/polyMesh\";\n    object      " + name + ";\n}\n\n";
}

/// Neighbor cells of this rank's canonical block, numbered from 0; negative at the boundary.
std::vector<std::array<GlobalId, 4>> neighbors_in_order(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::vector<std::array<GlobalId, 4>> rows(mesh.cell_to_cell.size());
  for (std::size_t c = 0; c < rows.size(); ++c)
    for (std::size_t i = 0; i < 4; ++i) {
      const auto next = mesh.cell_to_cell[c][i];
      const auto global = [&] {
        if (next < 0) return GlobalId{-1};
        const auto id = mesh.is_ghost(next) ? mesh.ghost_global[static_cast<std::size_t>(next - mesh.n_cells())]
                                            : mesh.cell_global[static_cast<std::size_t>(next)];
        return id - mesh.info.first_id;
      };
      rows[c][i] = global();
    }
  return par::scatter_rows<std::array<GlobalId, 4>>(comm, mesh.info.cell_ids(), rows, 1, mesh.cell_global);
}

/// The faces of this rank's cells in the order of the file: first the inner ones, then a list for each patch.
std::vector<std::vector<Face>> faces_of(const par::Comm& comm, const mesh::DistMesh& mesh, const RowsInOrder& rows) {
  const auto neighbors = neighbors_in_order(comm, mesh);
  std::vector<std::vector<Face>> parts(1 + mesh.info.patches.size());
  for (std::size_t c = 0; c < rows.cell_to_node.size(); ++c) {
    const auto cell = rows.first_cell + static_cast<GlobalId>(c);
    const auto first_inner = static_cast<std::ptrdiff_t>(parts[0].size());
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const auto next = neighbors[c][slot];
      if (next >= 0 && next < cell) continue;
      Face face{cell, next, {}, next < 0 ? -1 : rows.group[c][slot]};
      for (std::size_t i = 0; i < 3; ++i)
        face.node[i] = rows.cell_to_node[c][static_cast<std::size_t>(mesh::tet::face_to_corner[slot][i])];
      parts[next >= 0 ? 0 : 1 + static_cast<std::size_t>(rows.group[c][slot])].push_back(face);
    }
    std::sort(parts[0].begin() + first_inner, parts[0].end(),
              [](const Face& a, const Face& b) { return a.neighbor < b.neighbor; });
  }
  return parts;
}

/// Names as words of OpenFOAM.
std::vector<std::string> words(const char* what, const std::vector<std::string>& names, const Remark& remark) {
  const auto is_allowed = [](char c) {
    return c > ' ' && c <= '~' && std::string_view("\"'/;{}()[]$#\\").find(c) == std::string_view::npos;
  };
  return written_names({.format = "OpenFOAM", .what = what, .is_allowed = is_allowed}, names, remark);
}

std::vector<std::string> words_of_patches(const mesh::MeshInfo& info, const Remark& remark) {
  std::vector<std::string> names;
  for (const auto& patch : info.patches) names.push_back(patch.name);
  return words("patch", names, remark);
}

/// The groups of each patch as words, but for one of its own name.
std::vector<std::vector<std::string>> words_of_groups(const mesh::MeshInfo& info, const Remark& remark) {
  std::vector<std::string> names;
  for (const auto& patch : info.patches)
    for (const auto& group : patch.groups)
      if (std::find(names.begin(), names.end(), group.name) == names.end()) names.push_back(group.name);
  const auto written = words("group", names, remark);
  std::vector<std::vector<std::string>> groups(info.patches.size());
  for (std::size_t p = 0; p < groups.size(); ++p)
    for (const auto& group : info.patches[p].groups) {
      if (group.name == info.patches[p].name) continue;
      const auto place = std::find(names.begin(), names.end(), group.name) - names.begin();
      groups[p].push_back(written[static_cast<std::size_t>(place)]);
    }
  return groups;
}

/// Names of the zones of the given regions.
std::vector<std::string> words_of_regions(const mesh::MeshInfo& info, const std::vector<std::int64_t>& numbers,
                                          const Remark& remark) {
  std::vector<std::string> names;
  for (const auto number : numbers) {
    const auto name = mesh::name_of_region(info, number);
    names.push_back(name.empty() ? fmt::format("region_{}", number) : name);
  }
  return words("region", names, remark);
}

class Writer {
 public:
  Writer(const par::Comm& comm, fs::path folder, const mesh::DistMesh& mesh, const Remark& remark)
      : comm_(comm),
        remark_(remark),
        folder_(std::move(folder)),
        mesh_(mesh),
        rows_(rows_in_order(comm, mesh, nullptr, Interfaces::patches)),
        parts_(faces_of(comm, mesh, rows_)) {
    for (const auto& part : parts_) {
      n_faces_.push_back(comm.sum(static_cast<std::int64_t>(part.size())));
      n_all_ += n_faces_.back();
    }
  }

  void write() {
    std::string points;
    for (const auto p : rows_.position) {
      points += '(';
      append_number(points, p.x);
      append_number(points += ' ', p.y);
      append_number(points += ' ', p.z);
      points += ")\n";
    }
    write_list("vectorField", "points", mesh_.info.n_global_nodes, {points});
    write_list("faceList", "faces", n_all_, texts(parts_.size(), [](std::string& text, const Face& face) {
                 append_number(text += "3(", face.node[0]);
                 append_number(text += ' ', face.node[1]);
                 append_number(text += ' ', face.node[2]);
                 text += ")\n";
               }));
    write_list("labelList", "owner", n_all_, texts(parts_.size(), [](std::string& text, const Face& face) {
                 append_number(text, face.owner);
                 text += '\n';
               }));
    write_list("labelList", "neighbour", n_faces_[0], texts(1, [](std::string& text, const Face& face) {
                 append_number(text, face.neighbor);
                 text += '\n';
               }));
    write_boundary();
    write_zones();
    write_face_zones();
  }

 private:
  template <class Line>
  std::vector<std::string> texts(std::size_t n_parts, const Line& line) const {
    std::vector<std::string> result(n_parts);
    for (std::size_t part = 0; part < n_parts; ++part)
      for (const auto& face : parts_[part]) line(result[part], face);
    return result;
  }

  /// A list of `n` items: of each part the ranks' texts one after another.
  void write_list(const std::string& kind, const std::string& name, std::int64_t n,
                  const std::vector<std::string>& parts) {
    // OpenFOAM's tools take the sizes from this note before they read anything else.
    const std::string note =
        name == "owner" || name == "neighbour"
            ? fmt::format("nPoints:{}  nCells:{}  nFaces:{}  nInternalFaces:{}", mesh_.info.n_global_nodes,
                          mesh_.info.n_global_cells, n_all_, n_faces_[0])
            : "";
    SharedOutput out(comm_, folder_ / name);
    out.append_once(fmt::format("{}{}\n(\n", header(kind, name, note), n));
    for (const auto& part : parts) out.append(part);
    out.append_once(")\n");
    out.commit();
  }

  void write_boundary() {
    const auto& patches = mesh_.info.patches;
    const auto names = words_of_patches(mesh_.info, {});
    const auto groups = words_of_groups(mesh_.info, remark_);
    const auto inside = mesh::patches_inside_alone(comm_, mesh_);
    const auto n_inside = std::count(inside.begin(), inside.end(), true);
    std::string text = fmt::format("{}{}\n(\n", header("polyBoundaryMesh", "boundary"), std::ssize(patches) - n_inside);
    auto start = n_faces_[0];
    for (std::size_t p = 0; p < patches.size(); ++p) {
      if (inside[p]) continue;
      const auto& kind = patches[p].kind;
      const bool is_type = kind == "wall" || kind == "symmetry" || kind == "symmetryPlane";
      text += fmt::format("    {}\n    {{\n        type            {};\n", names[p], is_type ? kind : "patch");
      std::string list;
      for (const auto& group : groups[p]) list += (list.empty() ? "" : " ") + group;
      if (!list.empty()) text += fmt::format("        inGroups        {}({});\n", groups[p].size(), list);
      text += fmt::format("        nFaces          {};\n        startFace       {};\n    }}\n", n_faces_[1 + p], start);
      start += n_faces_[1 + p];
    }
    SharedOutput out(comm_, folder_ / "boundary");
    out.append_once(text + ")\n");
    out.commit();
  }

  /// The faces inside of each patch that has some, seen from their owner.
  void write_face_zones() {
    const auto n_patches = mesh_.info.patches.size();
    std::vector<std::string> labels(n_patches), flips(n_patches);
    std::vector<std::int64_t> n(n_patches, 0);
    auto label = comm_.exclusive_sum(std::ssize(parts_[0]));
    for (const auto& face : parts_[0]) {
      if (face.zone >= 0) {
        append_number(labels[static_cast<std::size_t>(face.zone)], label);
        labels[static_cast<std::size_t>(face.zone)] += '\n';
        flips[static_cast<std::size_t>(face.zone)] += "0\n";
        ++n[static_cast<std::size_t>(face.zone)];
      }
      ++label;
    }
    comm_.sum_in_place(n);
    const auto n_zones = std::count_if(n.begin(), n.end(), [](std::int64_t count) { return count > 0; });
    if (n_zones == 0) return;
    const auto names = words_of_patches(mesh_.info, {});
    SharedOutput out(comm_, folder_ / "faceZones");
    out.append_once(fmt::format("{}{}\n(\n", header("regIOobject", "faceZones"), n_zones));
    for (std::size_t p = 0; p < n_patches; ++p) {
      if (n[p] == 0) continue;
      out.append_once(
          fmt::format("    {}\n    {{\n        type            faceZone;\n        faceLabels      List<label>\n{}\n(\n",
                      names[p], n[p]));
      out.append(labels[p]);
      out.append_once(fmt::format(")\n;\n        flipMap         List<bool>\n{}\n(\n", n[p]));
      out.append(flips[p]);
      out.append_once(")\n;\n    }\n");
    }
    out.append_once(")\n");
    out.commit();
  }

  /// The cells of each region but 0, which stands for none.
  void write_zones() {
    auto regions = regions_in_order(comm_, mesh_);
    std::erase(regions.all, 0);
    if (regions.all.empty()) return;
    const auto names = words_of_regions(mesh_.info, regions.all, remark_);
    const auto rows_of_region = regions.rows_of_each();
    SharedOutput out(comm_, folder_ / "cellZones");
    out.append_once(fmt::format("{}{}\n(\n", header("regIOobject", "cellZones"), names.size()));
    for (std::size_t r = 0; r < names.size(); ++r) {
      std::string cells;
      for (const auto c : rows_of_region[r]) {
        append_number(cells, rows_.first_cell + static_cast<GlobalId>(c));
        cells += '\n';
      }
      out.append_once(
          fmt::format("    {}\n    {{\n        type            cellZone;\n        cellLabels      List<label>\n{}\n(\n",
                      names[r], comm_.sum(std::ssize(rows_of_region[r]))));
      out.append(cells);
      out.append_once(")\n;\n    }\n");
    }
    out.append_once(")\n");
    out.commit();
  }

  const par::Comm& comm_;
  const Remark& remark_;
  fs::path folder_;
  const mesh::DistMesh& mesh_;
  RowsInOrder rows_;
  std::vector<std::vector<Face>> parts_;
  std::vector<std::int64_t> n_faces_;  ///< of each part, all ranks
  std::int64_t n_all_ = 0;
};

}  // namespace

fs::path foam_folder(const fs::path& case_folder) { return case_folder / "constant" / "polyMesh"; }

void write_foam(const par::Comm& comm, const fs::path& case_folder, const mesh::DistMesh& mesh, const Remark& remark) {
  (void)words_of_patches(mesh.info, remark);
  PartialFolder folder(foam_folder(case_folder));
  par::agree(comm, [&] {
    if (comm.is_first()) folder.make();
  });
  folder.share(comm);
  folder.hold({"points", "faces", "owner", "neighbour", "boundary", "cellZones", "faceZones"});
  try {
    Writer(comm, folder.path(), mesh, remark).write();
  } catch (const Error& error) {  // reaches every rank
    auto text = std::string(error.what());
    const auto partial = folder.path().string();
    if (const auto place = text.find(partial); place != std::string::npos)
      text.replace(place, partial.size(), foam_folder(case_folder).string());
    throw Error(text);
  }
  par::agree(comm, [&] {
    if (comm.is_first()) folder.commit();
  });
  add_complete_output(foam_folder(case_folder));
}

}  // namespace pamr::io
