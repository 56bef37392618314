// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/foam/foam_zones.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/io/elements/boundary_rows.hpp"
#include "pamr/io/foam/foam_tokens.hpp"

namespace pamr::io::foam {

namespace {

struct CellZone {
  std::string name;
  std::vector<std::int64_t> cells;
};

/// A zone without cells is kept: it is a named group without elements.
std::vector<CellZone> zones_of(FoamFile& in) {
  std::vector<CellZone> zones;
  const auto n = in.count(8, "zones");
  in.require("(");
  for (std::int64_t z = 0; z < n; ++z) {
    auto& zone = zones.emplace_back();
    zone.name = in.word("the name of a zone");
    (void)in.dictionary([&](const std::string& key) {
      if (key != "cellLabels") return false;
      (void)in.passes("List<label>");
      zone.cells = in.labels();
      in.require(";");
      return true;
    });
  }
  return zones;
}

struct FaceZone {
  std::string name;
  std::vector<std::int64_t> faces;
  std::int64_t n_flipped = 0;  ///< faces that look to their owner
};

FaceZone read_face_zone(FoamFile& in) {
  FaceZone zone;
  zone.name = in.word("the name of a zone");
  (void)in.dictionary([&](const std::string& key) {
    if (key != "faceLabels" && key != "flipMap") return false;
    (void)(in.passes("List<label>") || in.passes("List<bool>"));
    if (key == "flipMap")
      zone.n_flipped = in.count_flags();
    else
      zone.faces = in.labels();
    in.require(";");
    return true;
  });
  return zone;
}

}  // namespace

void read_cell_zones(const std::filesystem::path& folder, const std::vector<std::size_t>& first_of_cell,
                     WholeMesh& mesh) {
  const auto n_cells = std::ssize(first_of_cell) - 1;
  FoamFile in(folder / "cellZones");
  const auto zones = zones_of(in);
  mesh.region.assign(mesh.cell.size(), 0);
  std::vector<std::string> names;
  for (const auto& zone : zones) names.push_back(zone.name);
  const auto numbers = patch_numbers(names, "region_", 1);
  std::map<std::array<std::size_t, 2>, std::int64_t> n_in_both;
  std::vector<std::size_t> zone_of(at(n_cells), zones.size());
  for (std::size_t z = 0; z < zones.size(); ++z) {
    if (names[z] != fmt::format("region_{}", numbers[z])) mesh.name_of_region[numbers[z]] = names[z];
    for (const auto cell : zones[z].cells) {
      if (cell < 0 || cell >= n_cells)
        in.fail(fmt::format("cells of zone '{}' from 0 to {}", names[z], n_cells - 1), fmt::format("{}", cell));
      auto& zone = zone_of[at(cell)];
      if (zone == zones.size()) {
        zone = z;
        for (auto c = first_of_cell[at(cell)]; c < first_of_cell[at(cell) + 1]; ++c) mesh.region[c] = numbers[z];
      } else if (zone != z) {
        ++n_in_both[{zone, z}];
      }
    }
  }
  for (const auto& [both, n] : n_in_both)
    mesh.overlaps.push_back({3, names[both[0]], names[both[1]], n, "which comes first"});
}

void read_face_zones(const std::filesystem::path& folder, const CaseFaces& faces, WholeMesh& mesh) {
  FoamFile in(folder / "faceZones");
  std::map<std::string, std::int64_t> tag_of;
  for (const auto& [tag, patch] : mesh.patch_of_tag) tag_of[patch.name] = tag;
  const auto n = in.count(8, "zones"), n_faces = static_cast<std::int64_t>(faces.nodes.size());
  in.require("(");
  for (std::int64_t z = 0; z < n; ++z) {
    const auto zone = read_face_zone(in);
    std::int64_t n_outside = 0;
    const auto [entry, is_new] = tag_of.try_emplace(zone.name, std::ssize(mesh.patch_of_tag));
    for (const auto label : zone.faces) {
      if (label < 0 || label >= n_faces)
        in.fail(fmt::format("faces of zone '{}' from 0 to {}", zone.name, n_faces - 1), fmt::format("{}", label));
      const auto node = faces.nodes[at(label)];
      if (label >= faces.n_inner) ++n_outside;
      if (label < faces.n_inner) add_face(node, entry->second, mesh);
    }
    if (is_new && (zone.faces.empty() || n_outside < std::ssize(zone.faces)))
      mesh.patch_of_tag[entry->second] = {zone.name, ""};
    if (n_outside > 0)
      mesh.remarks.push_back(fmt::format("{} faces of the zone '{}' lie on the boundary: they stay in their patches",
                                         n_outside, zone.name));
    if (zone.n_flipped > 0)
      mesh.remarks.push_back(
          fmt::format("left out was which way the faces of the zone '{}' look: {} of them {} turned "
                      "(flipMap)",
                      zone.name, zone.n_flipped, zone.n_flipped == 1 ? "is" : "are"));
  }
}

}  // namespace pamr::io::foam
