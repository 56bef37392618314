// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/state/transfer_particles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/machine.hpp"
#include "pamr/base/with_file_name.hpp"
#include "pamr/mesh/require_field.hpp"
#include "pamr/par/exchange.hpp"
#include "solvers/dsmc/kernel/move.hpp"
#include "solvers/dsmc/kernel/numbering.hpp"
#include "solvers/dsmc/state/checkpoint_rows.hpp"
#include "solvers/dsmc/state/header_values.hpp"
#include "solvers/dsmc/state/require_sound.hpp"
#include "solvers/dsmc/state/section_file.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

/// A new cell that could take the particles of its parent.
struct Candidate {
  GlobalId parent = 0, cell = 0;
  double volume = 0;
  Rank rank = 0;
};

/// A particle on its way to the rank of the cell from which the search for its place starts.
struct Passenger {
  GlobalId row = 0;   ///< of the old particles
  GlobalId host = 0;  ///< new cell
  Vec3 position;
  double fnum = 0;  ///< real molecules that it stands for
};

/// The old cells of this rank's cells, both counted from the meshes' first.
std::vector<GlobalId> parents_of(const mesh::DistMesh& mesh, const std::string& file, GlobalId n_old) {
  const auto used_for = fmt::format("file '{}': particles go to the cells refined from theirs", file);
  const auto& field = mesh::require_cell_field(mesh, {mesh::parent_field, mesh::FieldValues::integer, 1, used_for});
  const IdRange old{n_old, mesh.info.first_id};
  std::vector<GlobalId> parents;
  for (const auto parent : field.integer()) {
    if (!old.contains(parent))
      throw Error(
          fmt::format("file '{}': expected a checkpoint on the mesh that this one was refined from, found one of "
                      "{} cells where the field parent names cell {}",
                      file, n_old, parent));
    parents.push_back(parent - old.first);
  }
  return parents;
}

/// The new cell that takes the particles of each old cell of this rank's block: the one with the smallest number.
std::vector<Candidate> find_hosts(const par::Comm& comm, const std::string& file, const mesh::DistMesh& mesh,
                                  const std::vector<GlobalId>& parent, const Section& old_cells, double unit) {
  const auto number = cells_from_0(mesh);
  std::vector<par::Outgoing<Candidate>> messages(static_cast<std::size_t>(comm.size()));
  for (Rank r = 0; r < comm.size(); ++r) messages[at(r)].to = r;
  for (std::size_t c = 0; c < parent.size(); ++c) {
    const auto cell = static_cast<LocalId>(c);
    auto points = mesh.points(cell);
    for (auto& p : points) p = unit * p;
    const auto to = par::block_of(parent[c], old_cells.rows, comm.size());
    messages[at(to)].item.push_back({parent[c], number[c], volume(points), comm.rank()});
  }
  std::erase_if(messages, [](const auto& m) { return m.item.empty(); });
  const auto first = par::block_range(old_cells.rows, comm.rank(), comm.size()).begin;
  const auto n = old_cells.block.size() / old_cells.width;
  std::vector<Candidate> host(n, Candidate{-1, -1, 0, 0});
  for (const auto& candidate : comm.sparse_exchange(messages).item) {
    auto& best = host[at(candidate.parent - first)];
    const double total = best.volume + candidate.volume;
    if (best.cell < 0 || candidate.cell < best.cell) best = candidate;
    best.volume = total;
  }

  // In a mesh that was not refined from the old one the same numbers belong to other volumes.
  constexpr double scale = 1e6;
  std::int64_t wrong[2] = {0, 0};
  for (std::size_t c = 0; c < n; ++c) {
    const double old = real(old_cells.block[c * old_cells.width + volume_word]);
    if (!(old > 0)) continue;
    wrong[0] += static_cast<std::int64_t>(scale * std::min(1.0, std::fabs(host[c].volume - old) / old));
    wrong[1] += static_cast<std::int64_t>(scale);
  }
  comm.sum_in_place(wrong);
  if (2 * wrong[0] > wrong[1])
    throw Error(
        fmt::format("file '{}': expected a checkpoint on the mesh that this one was refined from, found cells of "
                    "other volumes",
                    file));
  // An old cell that contains no centroid takes the host of the cell before or after it.
  for (std::size_t c = 1; c < n; ++c)
    if (host[c].cell < 0) host[c] = host[c - 1];
  for (std::size_t c = n; c-- > 1;)
    if (host[c - 1].cell < 0) host[c - 1] = host[c];
  return host;
}

/// Sends every old particle to the rank of its host. Collective.
std::vector<Passenger> send_to_hosts(const par::Comm& comm, const Section& old_cells, const Section& old_particles,
                                     const std::vector<double>& weights, const std::vector<Candidate>& host) {
  std::vector<std::int64_t> count;
  std::int64_t here = 0;
  for (std::size_t c = 0; c < host.size(); ++c) {
    count.push_back(host[c].cell < 0 ? 0 : integer(old_cells.block[c * old_cells.width]));
    here += integer(old_cells.block[c * old_cells.width]);
  }
  std::vector<std::int64_t> first;
  auto next = comm.exclusive_sum(here);
  for (std::size_t c = 0; c < host.size(); ++c) {
    first.push_back(next);
    next += integer(old_cells.block[c * old_cells.width]);
  }
  const auto rows = consecutive(first, count);
  const auto words =
      par::fetch_rows<std::uint64_t>(comm, old_particles.rows, old_particles.block, particle_words, rows);
  std::vector<par::Outgoing<Passenger>> messages(static_cast<std::size_t>(comm.size()));
  for (Rank r = 0; r < comm.size(); ++r) messages[at(r)].to = r;
  std::size_t row = 0;
  for (std::size_t c = 0; c < host.size(); ++c)
    for (std::int64_t i = 0; i < count[c]; ++i, ++row) {
      const auto* w = words.data() + row * particle_words;
      messages[at(host[c].rank)].item.push_back(
          {rows[row],
           host[c].cell,
           {real(w[2]), real(w[3]), real(w[4])},
           real(old_cells.block[c * old_cells.width + fnum_word]) * weights[species_of(w)]});
    }
  std::erase_if(messages, [](const auto& m) { return m.item.empty(); });
  return comm.sparse_exchange(messages).item;
}

/// Moves them to their places: particles whose id is the row of the old one, and whose rotation is its F_num.
Particles locate(const par::Comm& comm, const mesh::DistMesh& mesh, const Flow& flow,
                 const std::vector<Passenger>& passengers) {
  const double unit = flow.setup().unit;
  const auto domain = make_gas_domain(mesh, unit, 1, 1);
  BoundaryCondition away;
  away.kind = BoundaryCondition::Kind::outflow;
  const std::vector<BoundaryCondition> patch(mesh.info.patches.size(), away);
  std::vector<Flight> flights;
  for (const auto& passenger : passengers) {
    const auto& global = domain.cell_global;
    const auto cell =
        static_cast<LocalId>(std::lower_bound(global.begin(), global.end(), passenger.host) - global.begin());
    const auto corner = corners(mesh, unit, cell);
    Flight flight;
    flight.particle.position = 0.25 * (corner[0] + corner[1] + corner[2] + corner[3]);
    flight.particle.velocity = passenger.position - flight.particle.position;
    flight.particle.id = static_cast<std::uint64_t>(passenger.row);
    flight.particle.rotation = passenger.fnum;
    flight.particle.cell = cell;
    flight.time = 1;
    flights.push_back(flight);
  }
  Particles placed;
  SurfaceTally tally;
  tally.face.resize(domain.boundary.size());
  BorderExchange border(domain);
  move(comm, {&domain, &flow.setup().gas, patch, 0}, 0, placed, flights, border, tally);
  placed.sort_by_cell(domain.n_cells());
  return placed;
}

/// Makes whole particles from old ones of another F_num, and numbers them.
void copy_particles(const par::Comm& comm, const std::string& file, const mesh::DistMesh& mesh, const Particles& placed,
                    const std::vector<std::uint64_t>& words, Flow& flow) {
  std::vector<std::int64_t> count(static_cast<std::size_t>(mesh.n_cells()), 0);
  const auto copies_of = [&](std::size_t i, const Particle& p) {
    return placed.rotation[i] / flow.fnum_of(at(placed.cell[i]), p.species);
  };
  par::agree(comm, [&] {
    double expected = 0;
    for (std::size_t i = 0; i < placed.size(); ++i)
      expected += copies_of(i, particle_from(words.data() + i * particle_words));
    constexpr double most = 0x1p31, bytes = sizeof(Particle);
    if (!(expected <= most && expected * bytes <= static_cast<double>(memory_of_machine())))
      throw Error(fmt::format(
          "file '{}': expected at most {:.4g} particles on a rank, and memory for them, found {:.4g} of the new "
          "weight on rank {}: use a greater weight",
          file, most, expected, comm.rank()));
  });
  for (std::size_t i = 0; i < placed.size(); ++i) {
    auto p = particle_from(words.data() + i * particle_words);
    const auto c = at(placed.cell[i]);
    Random random(flow.setup().seed, Purpose::thinning, placed.id[i], flow.steps_done);
    const auto copies = static_cast<std::int64_t>(copies_of(i, p) + random.uniform_fine());
    p.cell = placed.cell[i];
    p.partner = 0;  // the old numbers mean nothing any more
    for (std::int64_t k = 0; k < copies; ++k) flow.particles.append(p);
    count[c] += copies;
  }
  const auto first = number_along_cells(comm, mesh.info.n_global_cells, flow.domain().cell_global, count).first;
  std::size_t next = 0;
  for (std::size_t c = 0; c < count.size(); ++c)
    for (std::int64_t k = 0; k < count[c]; ++k) flow.particles.id[next++] = static_cast<std::uint64_t>(first[c] + k);
  flow.particles.sort_by_cell(flow.domain().n_cells());
}

/// What the computation that wrote the file was like.
struct OldSetup {
  std::uint64_t steps_done = 0;
  std::vector<double> weights;  ///< of the species
  bool is_weighted = false;
};

/// Throws `Error` unless it had the same species and the same unit of length.
OldSetup setup_in(const SectionFile& file, const std::string& name, const Flow& flow) {
  constexpr std::int64_t max_steps = std::int64_t{1} << 40U;
  const auto shown = [](const nlohmann::json& json) {
    return json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  };
  return with_file_name(name, [&] {
    OldSetup old;
    old.steps_done = static_cast<std::uint64_t>(count_of(member(file.header(), "steps_done"), "steps_done", max_steps));
    nlohmann::json species = nlohmann::json::array();
    for (const auto& s : flow.setup().gas.species) species.push_back(s.name);
    const auto& setup = member(file.header(), "setup");
    if (member(setup, "species") != species || member(setup, "unit") != flow.setup().unit)
      throw Error(fmt::format("expected a flow of the species {}, found {}", species.dump(), shown(setup)));
    old.is_weighted = setup.contains("weights");
    old.weights.assign(species.size(), 1);
    if (!old.is_weighted) return old;
    const auto& weights = array_of(setup["weights"], "weights", species.size());
    for (std::size_t s = 0; s < species.size(); ++s) {
      old.weights[s] = number_of(weights[s], "the weight of a species");
      if (!(old.weights[s] > 0 && old.weights[s] <= 1))
        throw Error(fmt::format("expected weights above 0 and at most 1, found {}", shown(weights)));
    }
    return old;
  });
}

}  // namespace

Transferred transfer_particles(const par::Comm& comm, const std::string& name, const mesh::DistMesh& mesh, Flow& flow) {
  const SectionFile file(comm, name);
  const auto old = setup_in(file, name, flow);
  const auto width = cell_words(old.weights.size(), old.is_weighted);
  const auto old_cells = file.read("cells", width), old_particles = file.read("particles", particle_words);
  auto range = sound_range(flow);
  range.is_weighted = old.is_weighted;
  require_sound_cells(comm, name, old_cells, old_particles.rows, range);
  require_sound_particles(comm, name, old_particles, range);
  std::vector<GlobalId> parent;
  par::agree(comm, [&] { parent = parents_of(mesh, name, old_cells.rows); });
  flow.steps_done = old.steps_done;

  const auto host = find_hosts(comm, name, mesh, parent, old_cells, flow.setup().unit);
  const auto placed = locate(comm, mesh, flow, send_to_hosts(comm, old_cells, old_particles, old.weights, host));

  std::vector<GlobalId> rows;
  for (const auto id : placed.id) rows.push_back(static_cast<GlobalId>(id));
  const auto words =
      par::fetch_rows<std::uint64_t>(comm, old_particles.rows, old_particles.block, particle_words, rows);
  const auto cells = par::fetch_rows<std::uint64_t>(comm, old_cells.rows, old_cells.block, width, parent);
  copy_particles(comm, name, mesh, placed, words, flow);
  for (std::size_t c = 0; c < flow.collisions.size(); ++c) {
    const auto* w = cells.data() + c * width;
    const auto& domain = flow.domain();
    const double part = domain.volume[c] / real(w[volume_word]) * real(w[fnum_word]) / domain.fnum[c];
    const double energy_deficit = old.is_weighted && flow.setup().gas.is_weighted ? part * real(w[width - 1]) : 0;
    flow.collisions[c] = {real(w[1]), 0, real(w[3]), 0, 0, energy_deficit};
  }
  const auto found = comm.sum(static_cast<std::int64_t>(placed.size()));
  return {old_particles.rows, flow.n_particles(), old_particles.rows - found, flow.steps_done};
}

}  // namespace pamr::dsmc
