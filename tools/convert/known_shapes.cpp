// SPDX-License-Identifier: GPL-3.0-or-later
#include "convert/known_shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "meshing/associate/recognize_shapes.hpp"
#include "pamr/geometry/described_surface.hpp"

namespace pamr::convert {

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

}  // namespace

KnownShapes find_known_shapes(const par::Comm& comm, const mesh::DistMesh& mesh,
                              const std::vector<std::string>& described, bool binds, nlohmann::json& report) {
  std::vector<bool> is_wanted;
  for (const auto& patch : mesh.info.patches)
    is_wanted.push_back(patch.surface < 0 && mesh.info.surfaces->index_of(patch.name) < 0 &&
                        std::find(described.begin(), described.end(), patch.name) == described.end());
  KnownShapes shapes;
  for (const auto& found : meshing::recognize_shapes(comm, mesh, is_wanted)) {
    const auto& patch = mesh.info.patches[static_cast<std::size_t>(found.patch)].name;
    const bool is_bound = binds && found.is_certain;
    report["shapes"][patch] = {{"kind", geometry::name_of(found.shape.kind)},
                               {"surface", found.surface.toml},
                               {"worst_distance", found.worst_distance},
                               {"worst_turn", found.worst_turn},
                               {"is_certain", found.is_certain},
                               {"is_bound", is_bound}};
    if (is_bound) par::agree(comm, [&] { shapes.bound.append(geometry::set_of({&found.surface, 1}, "--recognize")); });
    const auto* what_to_do =
        is_bound           ? ""
        : found.is_certain ? "; to refine onto it give --recognize, or for --surfaces a file with"
                           : "; that is too far for --recognize; to refine onto it give for --surfaces a file with";
    shapes.remarks.push_back(fmt::format(
        "patch '{}' {} a {}: its nodes lie within {:.2g} of it, which turns by up to {:.0f} degrees along an edge{}",
        patch, is_bound ? "is put on" : "fits", geometry::name_of(found.shape.kind), found.worst_distance,
        found.worst_turn, what_to_do));
    shapes.texts.push_back(found.surface.toml);
  }
  return shapes;
}

void tell_known_shapes(const cli::Session& session, const KnownShapes& shapes) {
  for (std::size_t i = 0; i < shapes.remarks.size(); ++i) session.note(shapes.remarks[i], lines_of(shapes.texts[i]));
}

}  // namespace pamr::convert
