// SPDX-License-Identifier: GPL-3.0-or-later
#include "convert/torn_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "meshing/repair/weld.hpp"
#include "pamr/base/counted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/check/tears.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::convert {

namespace {

void require_level0(const par::Comm& comm, const mesh::DistMesh& mesh) {
  if (comm.any(std::any_of(mesh.lineage.begin(), mesh.lineage.end(), [](auto l) { return l != mesh::Lineage{}; })))
    throw Error("--weld: expected a mesh of level 0, found cells that were refined (--as-level-0 forgets that)");
}

}  // namespace

void treat_tears(cli::Session& session, const Options& options, mesh::DistMesh& mesh, nlohmann::json& report) {
  const auto& comm = session.comm();
  if (options.from->is_native && !options.weld) return;
  auto tears = check::find_tears(comm, mesh);
  if (options.weld) {
    require_level0(comm, mesh);
    const auto n_nodes = mesh.info.n_global_nodes;
    if (tears.coincident_nodes.count > 0) {
      mesh = meshing::weld(comm, std::move(mesh));
      validate::require_valid(comm, mesh, options.input);
      mesh.info.provenance += "; welded";
      tears = check::find_tears(comm, mesh);
    }
    report["welded_nodes"] = n_nodes - mesh.info.n_global_nodes;
    session.warn(counted(n_nodes - mesh.info.n_global_nodes, "node was", "nodes were") +
                 " joined with others in the same place");
  }
  report["pieces"] = tears.n_pieces;
  report["coincident_nodes"] = tears.coincident_nodes.count;
  report["coincident_faces"] = tears.coincident_faces.count;
  report["overlaps"] = tears.overlaps.count;
  const bool can_be_welded = tears.coincident_nodes.count > 0 && !options.weld;
  for (const auto& remark : check::remarks_of(tears)) {
    if (options.strict) throw Error(fmt::format("file '{}': {}", options.input, remark));
    session.warn(remark);
  }
  if (can_be_welded)
    session.warn("--weld joins nodes that lie in one place, and the faces between them become inner ones");
}

}  // namespace pamr::convert
