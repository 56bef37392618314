// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/pass.hpp"

namespace pamr::adapt {

/// As `refine` with a mesh that is handed over, where its closure may be known: that of these flags, those of cells of
/// the deepest level left out. Collective; known on all ranks or on none.
RefineResult refine_closed(const par::Comm& comm, mesh::DistMesh&& mesh, std::span<const std::uint8_t> flags,
                           std::optional<KnownClosure> known, const Options& options);

}  // namespace pamr::adapt
