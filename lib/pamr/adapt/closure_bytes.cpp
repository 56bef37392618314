// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/closure_bytes.hpp"

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/refine/family.hpp"

namespace pamr::adapt {

namespace {

constexpr unsigned action_shift = 6;

}  // namespace

std::vector<std::uint8_t> closure_to_bytes(const refine::Closure& closure) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(closure.marks.size());
  for (std::size_t c = 0; c < closure.marks.size(); ++c)
    bytes.push_back(
        static_cast<std::uint8_t>(closure.marks[c] | static_cast<unsigned>(closure.action[c]) << action_shift));
  return bytes;
}

refine::Closure closure_from_bytes(const mesh::DistMesh& mesh, std::span<const std::uint8_t> bytes,
                                   const refine::Options& options, const refine::ClosureReport& report) {
  PAMR_EXPECTS(bytes.size() == at(mesh.n_cells()));
  refine::Closure closure;
  closure.report = report;
  closure.marks.reserve(bytes.size());
  closure.action.reserve(bytes.size());
  for (const auto byte : bytes) {
    closure.marks.push_back(static_cast<refine::EdgeMask>(byte & refine::all_edges));
    closure.action.push_back(static_cast<refine::Action>(byte >> action_shift));
  }
  for (std::size_t c = 0; c < bytes.size(); ++c)
    if (closure.action[c] == refine::Action::rebuild) {
      closure.rebuilt.push_back(
          refine::plan_family(mesh, refine::view_family(mesh, closure.marks, static_cast<LocalId>(c)), 0).family);
      PAMR_ENSURES(closure.rebuilt.back().state != 0);
    }
  refine::find_states(mesh, options, closure);
  return closure;
}

}  // namespace pamr::adapt
