// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/foam/read_foam.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/io/elements/boundary_rows.hpp"
#include "pamr/io/elements/whole_mesh.hpp"
#include "pamr/io/export/write_foam.hpp"
#include "pamr/io/foam/foam_tokens.hpp"
#include "pamr/io/text.hpp"
#include "pamr/mesh/periodic_patches.hpp"

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
  throw Error("expected an OpenFOAM case with constant/polyMesh, found a folder without");
}

std::string kind_of_type(const std::string& type) {
  if (type == "wall" || type == "symmetry" || type == "symmetryPlane") return type;
  if (type.starts_with("cyclic")) return mesh::periodic_kind;
  return {};
}

class CaseReader {
 public:
  explicit CaseReader(fs::path folder) : folder_(std::move(folder)) {}

  WholeMesh read() {
    mesh_.point = FoamFile(folder_ / "points").points();
    faces_ = FoamFile(folder_ / "faces").faces();
    owner_ = FoamFile(folder_ / "owner").labels();
    neighbor_ = FoamFile(folder_ / "neighbour").labels();
    if (owner_.size() != faces_.size() || neighbor_.size() > owner_.size())
      throw Error(fmt::format("expected an owner for each of {} faces, and no more neighbor cells, found {} and {}",
                              faces_.size(), owner_.size(), neighbor_.size()));
    const auto n_points = std::ssize(mesh_.point);
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (const auto node : faces_[f])
        if (node < 0 || node >= n_points)
          throw Error(fmt::format("face {}: expected nodes from 0 to {}, found {}", f, n_points - 1, node));
    make_cells();
    read_boundary();
    if (is_present(folder_ / "cellZones")) read_zones();
    if (is_present(folder_ / "faceZones")) read_face_zones();
    tell_of_other_files();
    return std::move(mesh_);
  }

 private:
  /// Zones of points, sets, levels of OpenFOAM's own refinement, ...
  void tell_of_other_files() {
    constexpr std::array<std::string_view, 7> known{"points",   "faces",     "owner",    "neighbour",
                                                    "boundary", "cellZones", "faceZones"};
    std::set<std::string> others;
    for (const auto& file : fs::directory_iterator(folder_)) {
      const auto name = file.path().extension() == ".gz" ? file.path().stem() : file.path().filename();
      if (std::find(known.begin(), known.end(), name.string()) == known.end()) others.insert(shown_text(name.string()));
    }
    std::string names;
    for (const auto& name : others) names += (names.empty() ? "" : ", ") + name;
    if (!names.empty()) mesh_.remarks.push_back("left out was what else polyMesh has: " + names);
  }

  /// Faces of each cell; those of which it is not the owner are seen from inside.
  void make_cells() {
    std::int64_t n_cells = 0;
    const auto most = 2 * std::ssize(faces_);
    for (const auto* cells : {&owner_, &neighbor_})
      for (const auto cell : *cells) {
        if (cell < 0 || cell >= most)
          throw Error(fmt::format("expected numbers of cells from 0 to {}, found {}", most - 1, cell));
        n_cells = std::max(n_cells, cell + 1);
      }
    std::vector<std::vector<std::size_t>> faces_of(at(n_cells));
    for (std::size_t f = 0; f < owner_.size(); ++f) faces_of[at(owner_[f])].push_back(f);
    for (std::size_t f = 0; f < neighbor_.size(); ++f) faces_of[at(neighbor_[f])].push_back(f);
    for (std::size_t c = 0; c < faces_of.size(); ++c) make_cell(static_cast<std::int64_t>(c), faces_of[c]);
  }

  void make_cell(std::int64_t cell, const std::vector<std::size_t>& own) {
    const auto n_triangles =
        std::count_if(own.begin(), own.end(), [&](std::size_t f) { return faces_[f].size() == 3; });
    const auto n_quads = std::count_if(own.begin(), own.end(), [&](std::size_t f) { return faces_[f].size() == 4; });
    const bool is_all = n_triangles + n_quads == std::ssize(own);
    if (!is_all || n_triangles != 4 || n_quads != 0) {
      const int type = is_all && n_quads == 6 && n_triangles == 0   ? element_type::hexahedron
                       : is_all && n_quads == 3 && n_triangles == 2 ? element_type::prism
                       : is_all && n_quads == 1 && n_triangles == 4 ? element_type::pyramid
                                                                    : element_type::polygon;
      ++mesh_.refused[type];
      return;
    }
    const auto& base = faces_[own[0]];
    std::int64_t apex = -1;
    for (std::size_t k = 1; k < 4; ++k)
      for (const auto node : faces_[own[k]]) {
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

  void read_boundary() {
    FoamFile in(folder_ / "boundary");
    const auto n = in.count(8, "patches");
    in.require("(");
    for (std::int64_t p = 0; p < n; ++p) {
      const std::string name(in.word("the name of a patch"));
      std::array<std::int64_t, 2> range{-1, -1};
      const auto entries = in.dictionary([&](const std::string& key) {
        if (key != "nFaces" && key != "startFace") return false;
        range[key == "nFaces" ? 1 : 0] = in.integer(key);
        in.require(";");
        return true;
      });
      const auto type = entries.contains("type") ? entries.at("type") : "patch";
      const auto [start, size] = range;
      if (start < std::ssize(neighbor_) || size < 0 || start > std::ssize(faces_) || size > std::ssize(faces_) - start)
        in.fail(fmt::format("faces of patch '{}' within the boundary", name),
                fmt::format("{} from {} on", size, start));
      if (type == "processor" && size > 0)
        in.fail("the mesh of a whole case", "a part for one processor (reconstructParMesh joins them)");
      mesh_.patch_of_tag[p] = {name, kind_of_type(type)};
      if (size > 0 && type != "patch" && mesh_.patch_of_tag[p].kind.empty())
        mesh_.remarks.push_back(fmt::format("the type '{}' of the patch '{}' was left out", shown_text(type), name));
      for (auto f = at(start); f < at(start + size); ++f) {
        if (faces_[f].size() != 3) continue;  // of a cell that is counted
        mesh_.triangle.push_back({faces_[f][0], faces_[f][1], faces_[f][2]});
        mesh_.tag.push_back(p);
      }
    }
    in.require(")");
  }

  /// Zones of faces inside become patches, those of a patch's name a part of it. Faces of the boundary have their patch.
  void read_face_zones() {
    FoamFile in(folder_ / "faceZones");
    std::map<std::string, std::int64_t> tag_of;
    for (const auto& [tag, patch] : mesh_.patch_of_tag) tag_of[patch.name] = tag;
    const auto n = in.count(8, "zones");
    in.require("(");
    for (std::int64_t z = 0; z < n; ++z) {
      const std::string name(in.word("the name of a zone"));
      std::vector<std::int64_t> labels;
      (void)in.dictionary([&](const std::string& key) {
        if (key != "faceLabels" && key != "flipMap") return false;
        (void)(in.passes("List<label>") || in.passes("List<bool>"));
        if (key == "flipMap")
          in.pass_flags();
        else
          labels = in.labels();
        in.require(";");
        return true;
      });
      std::int64_t n_outside = 0;
      const auto [entry, is_new] = tag_of.try_emplace(name, std::ssize(mesh_.patch_of_tag));
      for (const auto label : labels) {
        if (label < 0 || label >= std::ssize(faces_))
          in.fail(fmt::format("faces of zone '{}' from 0 to {}", name, std::ssize(faces_) - 1),
                  fmt::format("{}", label));
        const auto& face = faces_[at(label)];
        if (label >= std::ssize(neighbor_)) ++n_outside;
        if (label >= std::ssize(neighbor_) || face.size() != 3) continue;
        mesh_.triangle.push_back({face[0], face[1], face[2]});
        mesh_.tag.push_back(entry->second);
      }
      if (is_new && n_outside < std::ssize(labels)) mesh_.patch_of_tag[entry->second] = {name, ""};
      if (n_outside > 0)
        mesh_.remarks.push_back(
            fmt::format("{} faces of the zone '{}' lie on the boundary: they stay in their patches", n_outside, name));
    }
  }

  /// Zones become regions: N where one is called `region_N`, else the lowest free numbers from 1 on. A cell of two
  /// zones stays in the first one.
  void read_zones() {
    FoamFile in(folder_ / "cellZones");
    std::vector<std::string> names;
    std::vector<std::vector<std::int64_t>> cells;
    const auto n = in.count(8, "zones");
    in.require("(");
    for (std::int64_t z = 0; z < n; ++z) {
      names.emplace_back(in.word("the name of a zone"));
      cells.emplace_back();
      (void)in.dictionary([&](const std::string& key) {
        if (key != "cellLabels") return false;
        (void)in.passes("List<label>");
        cells.back() = in.labels();
        in.require(";");
        return true;
      });
    }
    if (!mesh_.refused.empty()) return;
    mesh_.region.assign(mesh_.cell.size(), 0);
    const auto numbers = patch_numbers(names, "region_", 1);
    std::map<std::array<std::size_t, 2>, std::int64_t> n_in_both;
    std::vector<std::size_t> zone_of(mesh_.cell.size(), names.size());
    for (std::size_t z = 0; z < names.size(); ++z) {
      if (names[z] != fmt::format("region_{}", numbers[z])) mesh_.name_of_region[numbers[z]] = names[z];
      for (const auto cell : cells[z]) {
        if (cell < 0 || cell >= std::ssize(mesh_.cell))
          in.fail(fmt::format("cells of zone '{}' from 0 to {}", names[z], std::ssize(mesh_.cell) - 1),
                  fmt::format("{}", cell));
        auto& zone = zone_of[at(cell)];
        if (zone == names.size()) {
          zone = z;
          mesh_.region[at(cell)] = numbers[z];
        } else if (zone != z) {
          ++n_in_both[{zone, z}];
        }
      }
    }
    for (const auto& [zones, n_cells] : n_in_both)
      mesh_.overlaps.push_back({3, names[zones[0]], names[zones[1]], n_cells, "which comes first"});
  }

  fs::path folder_;
  WholeMesh mesh_;
  std::vector<std::vector<std::int64_t>> faces_;
  std::vector<std::int64_t> owner_, neighbor_;
};

}  // namespace

}  // namespace foam

ElementMesh read_foam(const par::Comm& comm, const std::filesystem::path& case_folder, const ElementOptions& options) {
  return mesh_of_whole(comm, case_folder, options,
                       [&] { return foam::CaseReader(foam::mesh_of_case(case_folder)).read(); });
}

}  // namespace pamr::io
