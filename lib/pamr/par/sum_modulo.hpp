// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pamr/base/exact.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::par {

/// Sum over the ranks modulo 2^64. Collective.
std::uint64_t sum_modulo(const Comm& comm, Exact<std::uint64_t> here);

}  // namespace pamr::par
