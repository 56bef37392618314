// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pamr/balance/rebalance.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/closure.hpp"

namespace pamr::adapt {

struct Options;

/// What a cell weighs when cells are spread over ranks before they are split.
enum class Weights : std::uint8_t {
  exact,         ///< the number of cells that it becomes, closure included
  eight_to_one,  ///< 8 where it is flagged, else 1: the paper's weights, which ignore the closure
  uniform,       ///< 1
  field,         ///< the values of a cell field
};

/// How to spread the cells before they are split.
struct Balancing {
  balance::Options how;
  Weights weights = Weights::exact;
  std::string field;  ///< of `Weights::field`
};

/// The named ones are `exact`, `8/1` and `uniform`; any other name is that of a cell field.
Balancing balancing_named(std::string_view method, std::string_view weights);

/// What balancing did. `before` and `after` are of the exact weights, that is of the refined mesh, whatever weights the
/// partition was made with; the edge cut counts faces between the parents.
struct BalanceReport : balance::Report {
  bool is_measured = false;  ///< false where cells had to stay
};

/// Integer weights of the cells as `balancing` says. Collective. Throws `Error` as `balance::weights_from_field` does.
std::vector<std::int64_t> cell_weights(const par::Comm& comm, const mesh::DistMesh& mesh,
                                       std::span<const std::uint8_t> requests, const refine::Closure& closure,
                                       const Balancing& balancing);

/// A mesh that is about to be split.
struct Parents {
  mesh::DistMesh mesh;
  mesh::Borders borders;
  refine::Closure closure;
};

struct Balanced {
  Parents parents;  ///< those that this rank has now, with borders found anew
  BalanceReport report;
};

/// Moves the parents to the ranks where their children shall be. Books its time as `balance` and `migrate`. Nothing
/// moves on one rank and with `Method::none`. Collective.
Balanced balance_parents(const par::Comm& comm, Parents parents, std::span<const std::uint8_t> requests,
                         const Options& options, StepTimer& timer);

}  // namespace pamr::adapt
