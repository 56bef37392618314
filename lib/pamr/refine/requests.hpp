// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/number.hpp"

namespace pamr::refine {

/// What is asked of a cell when a mesh is closed.
enum class Request : std::uint8_t {
  none = 0,
  split = 1,   ///< into eight; of a closure cell under `removable`, its parent
  assess = 2,  ///< rule 4 of docs/closure.md is to be applied to its family, although no mark is new
};

constexpr bool asks_for(std::uint8_t request, Request what) { return static_cast<Request>(request) == what; }

/// `split` for each flag that is not 0.
std::vector<std::uint8_t> requests_of_flags(std::span<const std::uint8_t> flags);

/// The requests of a pass that splits only those of the plans that are early; `assess` stays. Local.
std::vector<std::uint8_t> requests_of_early(std::span<const std::uint8_t> requests,
                                            std::span<const RebuiltFamily> plans);

/// What is still asked of the cells that a pass makes: `requests` of the old mesh that it did not fulfill, and `assess`
/// for the closures inside early families. Local.
std::vector<std::uint8_t> remaining_requests(const NumberedMesh& old, std::span<const std::uint8_t> requests);

}  // namespace pamr::refine
