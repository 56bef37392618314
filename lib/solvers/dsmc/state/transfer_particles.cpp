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
#include "pamr/locate/locate_points.hpp"
#include "pamr/locate/locator.hpp"
#include "pamr/mesh/require_field.hpp"
#include "pamr/par/exchange.hpp"
#include "solvers/dsmc/kernel/halo.hpp"
#include "solvers/dsmc/kernel/move.hpp"
#include "solvers/dsmc/kernel/numbering.hpp"
#include "solvers/dsmc/state/checkpoint.hpp"
#include "solvers/dsmc/state/checkpoint_rows.hpp"
#include "solvers/dsmc/state/header_values.hpp"
#include "solvers/dsmc/state/require_sound.hpp"
#include "solvers/dsmc/state/section_file.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

/// A particle on its way to the rank of the cell from which the search for its place starts.
struct Passenger {
  GlobalId row = 0;   ///< of the old particles
  GlobalId host = 0;  ///< new cell
  Vec3 position;
  double fnum = 0;  ///< real molecules that it stands for
  Rank rank = 0;    ///< that holds the host
};

/// The old cells of this rank's cells, both counted from the meshes' first.
std::vector<GlobalId> parents_of(const mesh::DistMesh& mesh, const std::string& name, GlobalId n_old) {
  const auto used_for = fmt::format("{}: particles go to the cells refined from theirs", name);
  const auto& field = mesh::require_cell_field(mesh, {mesh::parent_field, mesh::FieldValues::integer, 1, used_for});
  const IdRange old{n_old, mesh.info.first_id};
  std::vector<GlobalId> parents;
  for (const auto parent : field.integer()) {
    if (!old.contains(parent))
      throw Error(
          fmt::format("{}: expected a checkpoint on the mesh that this one was refined from, found one of {} cells "
                      "where the field parent names cell {}",
                      name, n_old, parent));
    parents.push_back(parent - old.first);
  }
  return parents;
}

/// The same where the old cells are the cells.
std::vector<GlobalId> themselves(const mesh::DistMesh& mesh) {
  auto cells = mesh.cell_global;
  for (auto& cell : cells) cell -= mesh.info.first_id;
  return cells;
}

/// Every old particle of this rank's block of old cells. Collective.
std::vector<Passenger> passengers_of(const par::Comm& comm, const OldFlow& old, const std::vector<Host>& hosts) {
  std::vector<std::int64_t> count;
  std::int64_t here = 0;
  for (std::size_t c = 0; c < hosts.size(); ++c) {
    count.push_back(integer(old.cells.block[c * old.cells.width]));
    here += count.back();
  }
  std::vector<std::int64_t> first;
  auto next = comm.exclusive_sum(here);
  for (const auto n : count) {
    first.push_back(next);
    next += n;
  }
  const auto rows = consecutive(first, count);
  const auto words =
      par::fetch_rows<std::uint64_t>(comm, old.particles.rows, old.particles.block, particle_words, rows);
  std::vector<Passenger> passengers;
  passengers.reserve(rows.size());
  for (std::size_t c = 0; c < hosts.size(); ++c)
    for (std::int64_t i = 0; i < count[c]; ++i) {
      const auto row = passengers.size();
      const auto* w = words.data() + row * particle_words;
      const double fnum = real(old.cells.block[c * old.cells.width + fnum_word]) * old.weights[species_of(w)];
      passengers.push_back({rows[row], hosts[c].cell, {real(w[2]), real(w[3]), real(w[4])}, fnum, hosts[c].rank});
    }
  return passengers;
}

/// Sends each to the rank of its host. Collective.
std::vector<Passenger> send_to_hosts(const par::Comm& comm, std::span<const Passenger> passengers) {
  std::vector<par::Outgoing<Passenger>> messages(static_cast<std::size_t>(comm.size()));
  for (Rank r = 0; r < comm.size(); ++r) messages[at(r)].to = r;
  for (const auto& passenger : passengers) messages[at(passenger.rank)].item.push_back(passenger);
  std::erase_if(messages, [](const auto& m) { return m.item.empty(); });
  return comm.sparse_exchange(messages).item;
}

/// Moves them to their places: particles whose id is the row of the old one, and whose rotation is its F_num.
Particles fly_to_places(const par::Comm& comm, const mesh::DistMesh& mesh, const Flow& flow,
                        const std::vector<Passenger>& passengers) {
  const double unit = flow.setup().unit;
  auto domain = make_gas_domain(mesh, unit, 1, 1);
  add_halo(comm, domain);
  BoundaryCondition away;
  away.kind = BoundaryCondition::Kind::outflow;
  const std::vector<BoundaryCondition> patch(mesh.info.patches.size(), away);
  const auto& global = domain.cell_global;
  std::vector<Flight> flights;
  for (const auto& passenger : passengers) {
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

/// Of this rank's passengers those that did not arrive: each is looked for in all cells of all ranks, and appended to
/// `placed` if one holds it. Collective: one reduction if none is missing.
void find_missing(const par::Comm& comm, const mesh::DistMesh& mesh, const Flow& flow,
                  std::span<const Passenger> passengers, std::int64_t n_all, Particles& placed) {
  if (comm.sum(static_cast<std::int64_t>(placed.size())) == n_all) return;
  std::vector<GlobalId> arrived, rows;
  for (const auto id : placed.id) arrived.push_back(static_cast<GlobalId>(id));
  for (const auto& passenger : passengers) rows.push_back(passenger.row);
  const std::vector<std::uint8_t> yes(arrived.size(), 1);
  const auto is_there = par::fetch_rows<std::uint8_t>(
      comm, n_all, par::scatter_rows<std::uint8_t>(comm, n_all, yes, 1, arrived), 1, rows);
  std::vector<Passenger> missing;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (is_there[i] != 0) continue;
    missing.push_back(passengers[i]);
    points.push_back((1 / flow.setup().unit) * passengers[i].position);
  }
  const auto found = locate::locate_points(comm, mesh, locate::Locator(mesh), points);
  for (std::size_t i = 0; i < missing.size(); ++i) {
    missing[i].host = found.rank[i] < 0 ? -1 : found.cell[i] - mesh.info.first_id;
    missing[i].rank = found.rank[i];
  }
  std::erase_if(missing, [](const auto& passenger) { return passenger.rank < 0; });
  const auto& global = flow.domain().cell_global;
  for (const auto& passenger : send_to_hosts(comm, missing)) {
    Particle particle;
    particle.position = passenger.position;
    particle.id = static_cast<std::uint64_t>(passenger.row);
    particle.rotation = passenger.fnum;
    particle.cell =
        static_cast<LocalId>(std::lower_bound(global.begin(), global.end(), passenger.host) - global.begin());
    placed.append(particle);
  }
  placed.sort_by_cell(mesh.n_cells());
}

/// Makes whole particles from old ones of another F_num, and numbers them.
void copy_particles(const par::Comm& comm, const std::string& name, const mesh::DistMesh& mesh, const Particles& placed,
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
          "{}: expected at most {:.4g} particles on a rank, and memory for them, found {:.4g} of the new weight on "
          "rank {}: use a greater weight",
          name, most, expected, comm.rank()));
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

/// What an old cell that is nobody's parent leaves to the new cell that has its place.
struct Inheritance {
  GlobalId old_cell = 0, cell = 0;
  double energy = 0;  ///< deficit, J
};

/// Gives the new cells what the old ones remember of their collisions. Collective.
void inherit_collisions(const par::Comm& comm, const OldFlow& old, const std::vector<GlobalId>& parent,
                        const std::vector<Host>& hosts, Flow& flow) {
  const auto n_old = old.cells.rows;
  const auto width = old.cells.width;
  const auto& domain = flow.domain();
  const bool is_weighted = old.is_weighted && flow.setup().gas.is_weighted;
  const auto cells = par::fetch_rows<std::uint64_t>(comm, n_old, old.cells.block, width, parent);
  const auto host = par::fetch_rows<Host>(comm, n_old, hosts, 1, parent);
  for (std::size_t c = 0; c < flow.collisions.size(); ++c) {
    const auto* w = cells.data() + c * width;
    const double part = domain.volume[c] / host[c].volume * real(w[fnum_word]) / domain.fnum[c];
    flow.collisions[c] = {real(w[1]), 0, real(w[3]), 0, 0, is_weighted ? part * real(w[width - 1]) : 0};
  }
  if (!is_weighted) return;
  const auto first = par::block_range(n_old, comm.rank(), comm.size()).begin;
  std::vector<par::Outgoing<Inheritance>> messages(static_cast<std::size_t>(comm.size()));
  for (Rank r = 0; r < comm.size(); ++r) messages[at(r)].to = r;
  for (std::size_t c = 0; c < hosts.size(); ++c) {
    const auto* w = old.cells.block.data() + c * width;
    if (hosts[c].volume > 0 || real(w[width - 1]) == 0) continue;
    messages[at(hosts[c].rank)].item.push_back(
        {first + static_cast<GlobalId>(c), hosts[c].cell, real(w[width - 1]) * real(w[fnum_word])});
  }
  std::erase_if(messages, [](const auto& m) { return m.item.empty(); });
  auto left = comm.sparse_exchange(messages).item;
  std::sort(left.begin(), left.end(), [](const auto& a, const auto& b) { return a.old_cell < b.old_cell; });
  for (const auto& one : left) {
    const auto& global = domain.cell_global;
    const auto c = static_cast<std::size_t>(std::lower_bound(global.begin(), global.end(), one.cell) - global.begin());
    flow.collisions[c].energy_deficit += one.energy / domain.fnum[c];
  }
}

/// Puts all particles where they belong, when the parents of the cells and the hosts of the old ones are known.
/// Collective.
Transferred settle(const par::Comm& comm, const OldFlow& old, const std::vector<GlobalId>& parent,
                   std::vector<Host> hosts, const mesh::DistMesh& mesh, Flow& flow) {
  fill_gaps(comm, hosts);
  flow.steps_done = old.steps_done;
  const auto passengers = passengers_of(comm, old, hosts);
  auto placed = fly_to_places(comm, mesh, flow, send_to_hosts(comm, passengers));
  find_missing(comm, mesh, flow, passengers, old.particles.rows, placed);
  std::vector<GlobalId> rows;
  for (const auto id : placed.id) rows.push_back(static_cast<GlobalId>(id));
  const auto words =
      par::fetch_rows<std::uint64_t>(comm, old.particles.rows, old.particles.block, particle_words, rows);
  copy_particles(comm, old.name, mesh, placed, words, flow);
  inherit_collisions(comm, old, parent, hosts, flow);
  const auto found = comm.sum(static_cast<std::int64_t>(placed.size()));
  return {old.particles.rows, flow.n_particles(), old.particles.rows - found, old.steps_done};
}

/// What the computation that wrote the file was like, its tables apart. Throws `Error` unless it had the same species
/// and the same unit of length.
OldFlow setup_in(const SectionFile& file, const std::string& name, const Flow& flow) {
  constexpr std::int64_t max_steps = std::int64_t{1} << 40U;
  const auto shown = [](const nlohmann::json& json) {
    return json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  };
  return with_file_name(name, [&] {
    OldFlow old;
    old.name = fmt::format("file '{}'", name);
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

Transferred transfer_particles(const par::Comm& comm, const OldFlow& old, std::span<const GoneCell> gone,
                               const mesh::DistMesh& mesh, Flow& flow) {
  std::vector<GlobalId> parent;
  par::agree(comm, [&] { parent = parents_of(mesh, old.name, old.cells.rows); });
  auto hosts = find_hosts(comm, mesh, parent, old.cells.rows, flow.setup().unit);
  add_hosts_of_gone(comm, gone, old.cells.rows, hosts);
  return settle(comm, old, parent, std::move(hosts), mesh, flow);
}

Transferred transfer_particles(const par::Comm& comm, const std::string& name, const mesh::DistMesh& mesh, Flow& flow) {
  const SectionFile file(comm, name);
  auto old = setup_in(file, name, flow);
  old.cells = file.read("cells", cell_words(old.weights.size(), old.is_weighted));
  old.particles = file.read("particles", particle_words);
  auto range = sound_range(flow);
  range.is_weighted = old.is_weighted;
  require_sound_cells(comm, name, old.cells, old.particles.rows, range);
  require_sound_particles(comm, name, old.particles, range);
  const auto key = key_of(comm, mesh);
  const bool is_same = with_file_name(name, [&] { return is_of_mesh(file.header(), key); });
  std::vector<GlobalId> parent;
  par::agree(comm, [&] { parent = is_same ? themselves(mesh) : parents_of(mesh, old.name, old.cells.rows); });
  auto hosts = find_hosts(comm, mesh, parent, old.cells.rows, flow.setup().unit);
  require_old_volumes(comm, name, old.cells, hosts);
  return settle(comm, old, parent, std::move(hosts), mesh, flow);
}

}  // namespace pamr::dsmc
