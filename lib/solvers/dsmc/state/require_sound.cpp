// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/state/require_sound.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "solvers/dsmc/gas/gas_tables.hpp"
#include "solvers/dsmc/state/cell_row.hpp"
#include "solvers/dsmc/state/checkpoint_rows.hpp"
#include "solvers/dsmc/state/header_values.hpp"

namespace pamr::dsmc {

namespace {

constexpr double most = static_cast<double>(max_count);

/// One row of a table.
class Row {
 public:
  Row(const std::string& file, const Section& section, std::int64_t number, const std::uint64_t* words)
      : file_(&file), section_(&section), number_(number), words_(words) {}

  double real(std::size_t word, double low, double high, const char* name) const {
    const double value = pamr::dsmc::real(words_[word]);
    if (!(value >= low && value <= high))
      refuse(name, fmt::format("{:g} to {:g}", low, high), fmt::format("{:g}", value));
    return value;
  }
  std::int64_t integer(std::size_t word, std::int64_t low, std::int64_t high, const char* name) const {
    const auto value = pamr::dsmc::integer(words_[word]);
    if (value < low || value > high) refuse(name, fmt::format("{} to {}", low, high), fmt::format("{}", value));
    return value;
  }
  void vector(std::size_t word, double longest, const char* name) const {
    const Vec3 value{pamr::dsmc::real(words_[word]), pamr::dsmc::real(words_[word + 1]),
                     pamr::dsmc::real(words_[word + 2])};
    if (!(geometry::norm(value) <= longest))
      refuse(name, fmt::format("a length of at most {:g}", longest),
             fmt::format("({:g}, {:g}, {:g})", value.x, value.y, value.z));
  }
  /// Of a particle whose species is known.
  void levels(std::size_t word, const SoundRange& range) const {
    const auto& vibration = range.vibration[species_of(words_)];
    const auto value =
        static_cast<std::uint32_t>(integer(word, 0, std::numeric_limits<std::uint32_t>::max(), "levels"));
    const bool fits =
        vibration.mode.empty() ? value == 0 : boltzmann * vibrational_energy(vibration, value) <= range.max_rotation;
    if (!fits) refuse("levels", "those of its modes", fmt::format("{:x}", value));
  }
  void species(std::size_t n) const {
    const auto value = species_of(words_);
    if (value >= n) refuse("a species", fmt::format("0 to {}", n - 1), fmt::format("{}", value));
  }

 private:
  [[noreturn]] void refuse(const char* name, const std::string& expected, const std::string& found) const {
    throw Error(fmt::format("file '{}', {}, row {}: expected {} = {}, found {}", *file_, section_->name, number_, name,
                            expected, found));
  }

  const std::string* file_;
  const Section* section_;
  std::int64_t number_;
  const std::uint64_t* words_;
};

/// Calls `check` with each row of this rank's block; what it throws reaches every rank.
template <class Check>
void check_rows(const par::Comm& comm, const std::string& file, const Section& section, const Check& check) {
  const auto rows = par::block_range(section.rows, comm.rank(), comm.size());
  par::agree(comm, [&] {
    for (auto row = rows.begin; row < rows.end; ++row)
      check(Row(file, section, row, section.block.data() + at(row - rows.begin) * section.width));
  });
}

/// What has been summed over the particles of one species in a cell.
void check_sums(const Row& row, std::size_t first, const SoundRange& range) {
  constexpr double above = 1 + 1e-9;  // sums are rounded
  const double n = above * row.real(first, 0, most, "the sum of its particles");
  row.vector(first + 1, n * range.max_speed, "the sum of their velocities");
  row.real(first + 4, 0, n * range.max_speed * range.max_speed, "the sum of their squares");
  row.real(first + 5, 0, n * range.max_rotation, "the sum of their rotational energies");
}

void check_cell(const Row& row, const SoundRange& range) {
  constexpr double smallest = std::numeric_limits<double>::min();
  row.real(1, 0, range.max_sigma_cr, "(sigma c_r)_max");
  row.real(2, 0, 1, "the remainder of its candidate pairs");
  row.real(3, -1, 1e15, "its temperature");
  row.real(4, 0, max_place * most, "the sum of its separations");
  row.integer(5, 0, max_count, "its collisions");
  row.real(6, 0, most, "the sum of its block");
  row.real(7, 0, most * most, "the squares of its blocks");
  row.real(CellColumns::volume, smallest, max_place * max_place * max_place, "its volume");
  row.real(CellColumns::fnum, smallest, 1e80, "molecules a particle");
  const CellColumns columns{range.n_species, range.is_weighted, range.is_vibrating};
  for (std::size_t s = 0; s < range.n_species; ++s)
    check_sums(row, CellColumns::sums + s * CellColumns::words_of_sums, range);
  if (range.is_weighted)
    row.real(columns.deficit(), -most * range.max_rotation, most * range.max_rotation, "its energy deficit");
  for (std::size_t s = 0; range.is_vibrating && s < range.n_species; ++s)
    row.real(columns.vibration() + s, 0, most * (range.max_rotation / boltzmann), "the sum of vibrational energies");
}

void check_face(const Row& row) {
  constexpr auto full = std::int64_t{1} << 61U;
  for (const std::size_t first : {0, 5}) {
    row.integer(first, 0, full, "its hits");
    for (std::size_t k = 1; k < 5; ++k) row.integer(first + k, -full, full, "its sums");
  }
  for (const std::size_t k : {10, 11}) row.real(k, 0, most * most * most, "its squares");
}

}  // namespace

SoundRange sound_range(const Flow& flow) {
  const auto& gas = flow.setup().gas;
  SoundRange range{gas.species.size(), gas.is_weighted, gas.is_vibrating, {}, 0, 0, 0};
  range.max_speed = 1000 * (flow.surface.energy_unit / flow.surface.momentum_unit);
  for (const auto& species : gas.species) range.vibration.push_back(species.vibration);
  for (const auto& species : gas.species)
    range.max_rotation = std::max(range.max_rotation, species.mass * range.max_speed * range.max_speed);
  for (const auto& pair : gas.pairs)
    range.max_sigma_cr = std::max(range.max_sigma_cr, section_times_speed(pair, 4 * range.max_speed * range.max_speed));
  return range;
}

void require_sound_cells(const par::Comm& comm, const std::string& file, const Section& cells, std::int64_t n_particles,
                         const SoundRange& range) {
  std::int64_t n = 0;
  check_rows(comm, file, cells, [&](const Row& row) {
    n += row.integer(0, 0, n_particles - n, "particles, no more than the table of these has");
    check_cell(row, range);
  });
  const double about = comm.max(static_cast<double>(n));  // a sum of numbers each of which fits need not fit
  const auto all = about * comm.size() < most ? comm.sum(n) : max_count;
  if (all != n_particles)
    throw Error(fmt::format("file '{}': expected {} particles, as its cells have, found {}", file, all, n_particles));
}

void require_sound_particles(const par::Comm& comm, const std::string& file, const Section& particles,
                             const SoundRange& range) {
  check_rows(comm, file, particles, [&](const Row& row) {
    row.species(range.n_species);
    row.vector(2, 2 * max_place, "a position");
    row.vector(5, range.max_speed, "a velocity");
    row.real(8, 0, range.max_rotation, "a rotational energy");
    if (range.is_vibrating) row.levels(9, range);
  });
}

void require_sound(const par::Comm& comm, const std::string& file, const Snapshot& snapshot, const SoundRange& range) {
  require_sound_cells(comm, file, snapshot.cells, snapshot.particles.rows, range);
  require_sound_particles(comm, file, snapshot.particles, range);
  check_rows(comm, file, snapshot.faces, check_face);
}

void require_places(const par::Comm& comm, const std::string& file, const Flow& flow) {
  constexpr double part_of_size = 1e-3;
  const auto& domain = flow.domain();
  const auto& particles = flow.particles;
  par::agree(comm, [&] {
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const auto cell = particles.cell[i];
      const auto p = particles.position(i);
      if (is_inside(domain, cell, p, part_of_size * std::cbrt(domain.volume[at(cell)]))) continue;
      throw Error(
          fmt::format("file '{}': expected particles in their cells, found one at ({:g}, {:g}, {:g}), which is "
                      "outside of the cell {} places after the first",
                      file, p.x, p.y, p.z, domain.cell_global[at(cell)]));
    }
  });
}

}  // namespace pamr::dsmc
