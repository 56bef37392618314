// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/foam/read_foam.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/io/elements/cut_elements.hpp"
#include "pamr/io/elements/whole_mesh.hpp"
#include "pamr/io/export/write_foam.hpp"
#include "pamr/io/foam/foam_case.hpp"
#include "pamr/io/foam/foam_patches.hpp"
#include "pamr/io/foam/foam_tokens.hpp"
#include "pamr/io/foam/foam_zones.hpp"

namespace pamr::io {

namespace foam {

namespace {

namespace fs = std::filesystem;

fs::path mesh_of_case(const fs::path& case_folder) {
  std::error_code none;
  if (!fs::is_directory(case_folder, none))
    throw Error(fmt::format("expected the folder of an OpenFOAM case, found {}",
                            fs::exists(case_folder, none) ? "a file whose name does not say its format" : "none"));
  auto folder = foam_folder(case_folder);
  if (is_present(folder / "owner")) return folder;
  if (fs::exists(foam_folder(case_folder / "processor0"), none))
    throw Error("expected constant/polyMesh, found parts for several processors: reconstructParMesh makes one of them");
  const auto regions = regions_of_case(case_folder);
  throw Error(regions.empty()
                  ? "expected an OpenFOAM case with constant/polyMesh, found a folder without"
                  : fmt::format("expected an OpenFOAM case with constant/polyMesh, found the meshes of its "
                                "regions alone (constant/REGION/polyMesh): {}: one is read where it lies in "
                                "constant/polyMesh",
                                listed(regions)));
}

class CaseReader {
 public:
  explicit CaseReader(fs::path folder) : folder_(std::move(folder)) {}

  WholeMesh read() {
    mesh_.point = FoamFile(folder_ / "points").points();
    auto& faces = faces_.nodes;
    faces = FoamFile(folder_ / "faces").faces();
    owner_ = FoamFile(folder_ / "owner").labels();
    neighbor_ = FoamFile(folder_ / "neighbour").labels();
    faces_.n_inner = std::ssize(neighbor_);
    if (owner_.size() != faces.size() || neighbor_.size() > owner_.size())
      throw Error(fmt::format("expected an owner for each of {} faces, and no more neighbor cells, found {} and {}",
                              faces.size(), owner_.size(), neighbor_.size()));
    const auto n_points = std::ssize(mesh_.point);
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (const auto node : faces[f])
        if (node < 0 || node >= n_points)
          throw Error(fmt::format("face {}: expected nodes from 0 to {}, found {}", f, n_points - 1, node));
    make_cells();
    read_patches(folder_, faces_, mesh_);
    if (is_present(folder_ / "cellZones") && mesh_.refused.empty()) read_cell_zones(folder_, first_of_cell_, mesh_);
    if (is_present(folder_ / "faceZones")) read_face_zones(folder_, faces_, mesh_);
    return std::move(mesh_);
  }

 private:
  /// Faces of each cell; those of which it is not the owner are seen from inside.
  void make_cells() {
    std::int64_t n_cells = 0;
    const auto most = 2 * std::ssize(owner_);
    for (const auto* cells : {&owner_, &neighbor_})
      for (const auto cell : *cells) {
        if (cell < 0 || cell >= most)
          throw Error(fmt::format("expected numbers of cells from 0 to {}, found {}", most - 1, cell));
        n_cells = std::max(n_cells, cell + 1);
      }
    std::vector<std::size_t> end, face;  // of each cell: where its faces end, those of which it is the owner first
    assign_array(end, at(n_cells) + 1, std::size_t{0});
    assign_array(face, owner_.size() + neighbor_.size(), std::size_t{0});
    for (const auto* cells : {&owner_, &neighbor_})
      for (const auto cell : *cells) ++end[at(cell) + 1];
    std::partial_sum(end.begin(), end.end(), end.begin());
    for (const auto* cells : {&owner_, &neighbor_})
      for (std::size_t f = 0; f < cells->size(); ++f) face[end[at((*cells)[f])]++] = f;
    reserve_array(mesh_.cell, at(n_cells));
    reserve_array(first_of_cell_, at(n_cells) + 1);
    for (std::size_t c = 0, begin = 0; c < at(n_cells); begin = end[c++]) {
      first_of_cell_.push_back(mesh_.cell.size());
      make_cell(static_cast<std::int64_t>(c), std::span(face).subspan(begin, end[c] - begin));
    }
    first_of_cell_.push_back(mesh_.cell.size());
  }

  void make_cell(std::int64_t cell, std::span<const std::size_t> own) {
    const auto n_triangles =
        std::count_if(own.begin(), own.end(), [&](std::size_t f) { return faces_.nodes[f].size() == 3; });
    const auto n_quads =
        std::count_if(own.begin(), own.end(), [&](std::size_t f) { return faces_.nodes[f].size() == 4; });
    const bool is_all = n_triangles + n_quads == std::ssize(own);
    if (!is_all || n_triangles != 4 || n_quads != 0) {
      const int type = is_all && n_quads == 6 && n_triangles == 0   ? element_type::hexahedron
                       : is_all && n_quads == 3 && n_triangles == 2 ? element_type::prism
                       : is_all && n_quads == 1 && n_triangles == 4 ? element_type::pyramid
                                                                    : element_type::polygon;
      if (is_cut(type))
        cut_cell(cell, type, own);
      else
        ++mesh_.refused[type];
      return;
    }
    const auto base = faces_.nodes[own[0]];
    std::int64_t apex = -1;
    for (std::size_t k = 1; k < 4; ++k)
      for (const auto node : faces_.nodes[own[k]]) {
        if (std::find(base.begin(), base.end(), node) != base.end()) continue;
        if (apex >= 0 && apex != node)
          throw Error(fmt::format("cell {}: expected four nodes of a tetrahedron, found more", cell));
        apex = node;
      }
    if (apex < 0) throw Error(fmt::format("cell {}: expected four nodes of a tetrahedron, found three", cell));
    const bool is_owner = owner_[own[0]] == cell;
    mesh_.cell.push_back(is_owner ? std::array{base[0], base[2], base[1], apex}
                                  : std::array{base[0], base[1], base[2], apex});
  }

  /// A prism or a pyramid: over a triangle, or over the quadrangle, stand the nodes that the base does not have.
  void cut_cell(std::int64_t cell, int type, std::span<const std::size_t> own) {
    const std::size_t n_base = type == element_type::prism ? 3 : 4;
    const auto at_base =
        *std::find_if(own.begin(), own.end(), [&](std::size_t f) { return faces_.nodes[f].size() == n_base; });
    const auto at_bottom = faces_.nodes[at_base];
    std::vector<std::int64_t> nodes(at_bottom.begin(), at_bottom.end());
    if (owner_[at_base] == cell) std::reverse(nodes.begin(), nodes.end());
    const auto base = nodes;
    const auto is_in_base = [&](std::int64_t node) { return std::find(base.begin(), base.end(), node) != base.end(); };
    for (std::size_t corner = 0; corner < (n_base == 3 ? n_base : 1); ++corner) {
      std::set<std::int64_t> above;  // neighbors of the corner in the other faces
      for (const auto f : own) {
        const auto face = faces_.nodes[f];
        const auto found = std::find(face.begin(), face.end(), base[corner]);
        if (f == at_base || found == face.end()) continue;
        const auto place = static_cast<std::size_t>(found - face.begin());
        for (const auto step : {std::size_t{1}, face.size() - 1})
          if (const auto node = face[(place + step) % face.size()]; !is_in_base(node)) above.insert(node);
      }
      nodes.insert(nodes.end(), above.begin(), above.end());
    }
    const std::set<std::int64_t> all(nodes.begin(), nodes.end());
    const bool fits = std::all_of(own.begin(), own.end(), [&](std::size_t f) {
      return std::all_of(faces_.nodes[f].begin(), faces_.nodes[f].end(), [&](auto node) { return all.contains(node); });
    });
    if (!fits || std::ssize(nodes) != n_nodes_of_type(type) || all.size() != nodes.size())
      throw Error(fmt::format("cell {}: expected the faces of {}, found others", cell,
                              type == element_type::prism ? "a prism" : "a pyramid"));
    ++mesh_.cut[type];
    for (const auto& piece : tetrahedra_of(type, nodes)) mesh_.cell.push_back(piece);
  }

  fs::path folder_;
  WholeMesh mesh_;
  CaseFaces faces_;
  std::vector<std::int64_t> owner_, neighbor_;
  std::vector<std::size_t> first_of_cell_;  ///< of each cell its first tetrahedron; at the end their number
};

}  // namespace

}  // namespace foam

ElementMesh read_foam(const par::Comm& comm, const std::filesystem::path& case_folder, const ElementOptions& options) {
  return mesh_of_whole(comm, case_folder, options, [&] {
    const auto folder = foam::mesh_of_case(case_folder);
    auto mesh = foam::CaseReader(folder).read();
    foam::tell_of_other_data(case_folder, folder, mesh);
    return mesh;
  });
}

}  // namespace pamr::io
