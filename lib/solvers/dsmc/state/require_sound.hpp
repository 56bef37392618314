// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "pamr/par/comm.hpp"
#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/state/checkpoint.hpp"
#include "solvers/dsmc/state/section_file.hpp"

/// What a checkpoint holds, compared with what a computation could have written: a table whose checksum is right may
/// still hold anything.
namespace pamr::dsmc {

/// What values can be at most in a gas.
struct SoundRange {
  std::size_t n_species = 0;
  bool is_weighted = false;
  bool is_vibrating = false;
  std::vector<Vibration> vibration;  ///< of each species
  double max_speed = 0;              ///< m/s: a thousand times what hits on walls are measured by
  double max_rotation = 0;           ///< J, of vibration too
  double max_sigma_cr = 0;           ///< m3/s: of two particles of that speed
};
SoundRange sound_range(const Flow& flow);

/// Throw the same `Error`, with file, table and row, on every rank unless every value is finite and in its range, and
/// all cells together have `n_particles`. Collective: two reductions.
void require_sound_cells(const par::Comm& comm, const std::string& file, const Section& cells, std::int64_t n_particles,
                         const SoundRange& range);
void require_sound_particles(const par::Comm& comm, const std::string& file, const Section& particles,
                             const SoundRange& range);
/// Of all tables.
void require_sound(const par::Comm& comm, const std::string& file, const Snapshot& snapshot, const SoundRange& range);

/// Throws the same `Error` on every rank unless every particle of the flow is in its cell, to within a thousandth of
/// the cell's size. Collective: one reduction.
void require_places(const par::Comm& comm, const std::string& file, const Flow& flow);

}  // namespace pamr::dsmc
