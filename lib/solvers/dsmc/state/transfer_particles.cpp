// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/state/transfer_particles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

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
#include "solvers/dsmc/kernel/vibrate.hpp"
#include "solvers/dsmc/state/cell_row.hpp"
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

CellColumns columns_of(const OldFlow& old) { return {old.weights.size(), old.is_weighted, old.is_vibrating}; }

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

/// Particles of each old cell of this rank's block.
std::vector<std::int64_t> old_particles_of_cells(const OldFlow& old) {
  std::vector<std::int64_t> count;
  for (std::size_t w = 0; w < old.cells.block.size(); w += old.cells.width)
    count.push_back(integer(old.cells.block[w]));
  return count;
}

/// The old particles from a row on, whose places are given. Collective.
std::vector<Passenger> passengers_of(const par::Comm& comm, const OldFlow& old, const std::vector<Host>& hosts,
                                     GlobalId first_row, const std::vector<InOrderOfCells::Place>& places) {
  std::vector<GlobalId> rows(places.size());
  std::iota(rows.begin(), rows.end(), first_row);
  const auto words =
      par::fetch_rows<std::uint64_t>(comm, old.particles.rows, old.particles.block, old.particles.width, rows);
  std::vector<Passenger> passengers;
  passengers.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto* w = words.data() + i * old.particles.width;
    const auto cell = places[i].cell;
    const double fnum = real(old.cells.block[cell * old.cells.width + CellColumns::fnum]) * old.weights[species_of(w)];
    passengers.push_back({rows[i], hosts[cell].cell, {real(w[2]), real(w[3]), real(w[4])}, fnum, hosts[cell].rank});
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

/// A cell of this rank by its number from 0.
LocalId local_cell(const std::vector<GlobalId>& cell_global, GlobalId cell) {
  return static_cast<LocalId>(std::lower_bound(cell_global.begin(), cell_global.end(), cell) - cell_global.begin());
}

/// The new mesh as passengers fly through it to their places.
class Passage {
 public:
  /// Collective.
  Passage(const par::Comm& comm, const mesh::DistMesh& mesh, const Setup& setup)
      : comm_(&comm),
        mesh_(&mesh),
        setup_(&setup),
        domain_(with_halo(comm, make_gas_domain(mesh, setup.unit, 1, 1))),
        border_(domain_) {
    BoundaryCondition away;
    away.kind = BoundaryCondition::Kind::outflow;
    patch_.assign(mesh.info.patches.size(), away);
    tally_.face.resize(domain_.boundary.size());
  }

  /// Particles in any order whose id is the row of the old one, and whose rotation is its F_num. Collective.
  Particles fly(std::span<const Passenger> passengers) {
    std::vector<Flight> flights;
    for (const auto& passenger : passengers) {
      const auto cell = local_cell(domain_.cell_global, passenger.host);
      const auto corner = corners(*mesh_, setup_->unit, cell);
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
    move(*comm_, {&domain_, &setup_->gas, patch_}, placed, flights, {border_, tally_});
    return placed;
  }

 private:
  static GasDomain with_halo(const par::Comm& comm, GasDomain domain) {
    add_halo(comm, domain);
    return domain;
  }

  const par::Comm* comm_;
  const mesh::DistMesh* mesh_;
  const Setup* setup_;
  GasDomain domain_;
  BorderExchange border_;
  std::vector<BoundaryCondition> patch_;  ///< whoever meets the boundary is gone
  SurfaceTally tally_;
};

/// Of this rank's passengers those that did not arrive. Collective: one reduction if none is missing.
std::vector<Passenger> missing_of(const par::Comm& comm, std::span<const Passenger> passengers, std::int64_t n_all,
                                  const Particles& placed) {
  if (comm.sum(static_cast<std::int64_t>(passengers.size()) - static_cast<std::int64_t>(placed.size())) == 0) return {};
  std::vector<GlobalId> arrived, rows;
  for (const auto id : placed.id) arrived.push_back(static_cast<GlobalId>(id));
  for (const auto& passenger : passengers) rows.push_back(passenger.row);
  const std::vector<std::uint8_t> yes(arrived.size(), 1);
  const auto is_there = par::fetch_rows<std::uint8_t>(
      comm, n_all, par::scatter_rows<std::uint8_t>(comm, n_all, yes, 1, arrived), 1, rows);
  std::vector<Passenger> missing;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (is_there[i] == 0) missing.push_back(passengers[i]);
  return missing;
}

/// Looks for each in all cells of all ranks; those that one holds, as `Passage::fly` gives them. Collective.
Particles find_missing(const par::Comm& comm, const mesh::DistMesh& mesh, const Flow& flow,
                       std::vector<Passenger> missing) {
  Particles placed;
  if (comm.sum(static_cast<std::int64_t>(missing.size())) == 0) return placed;
  std::vector<Vec3> points;
  for (const auto& passenger : missing) points.push_back((1 / flow.setup().unit) * passenger.position);
  const auto found = locate::locate_points(comm, mesh, locate::Locator(mesh), points);
  for (std::size_t i = 0; i < missing.size(); ++i) {
    missing[i].host = found.rank[i] < 0 ? -1 : found.cell[i] - mesh.info.first_id;
    missing[i].rank = found.rank[i];
  }
  std::erase_if(missing, [](const auto& passenger) { return passenger.rank < 0; });
  for (const auto& passenger : send_to_hosts(comm, missing)) {
    Particle particle;
    particle.position = passenger.position;
    particle.id = static_cast<std::uint64_t>(passenger.row);
    particle.rotation = passenger.fnum;
    particle.cell = local_cell(flow.domain().cell_global, passenger.host);
    placed.append(particle);
  }
  return placed;
}

/// Makes whole particles from old ones of another F_num.
class Copies {
 public:
  Copies(const par::Comm& comm, const OldFlow& old, Flow& flow) : comm_(&comm), old_(&old), flow_(&flow) {}

  /// Of particles as `Passage::fly` gives them. The first copy of each keeps its id, and so remains the last partner of
  /// others; further ones have a provisional id from the row of the old particle. Collective. Throws `Error` on every
  /// rank for more than memory holds.
  void add(const Particles& placed) {
    std::vector<GlobalId> rows;
    for (const auto id : placed.id) rows.push_back(static_cast<GlobalId>(id));
    const auto words = par::fetch_rows<std::uint64_t>(*comm_, old_->particles.rows, old_->particles.block,
                                                      old_->particles.width, rows);
    const auto copies_of = [&](std::size_t i, const Particle& p) {
      return placed.rotation[i] / flow_->fnum_of(at(placed.cell[i]), p.species);
    };
    for (std::size_t i = 0; i < placed.size(); ++i) expected_ += copies_of(i, particle(words, i));
    require_room();
    for (std::size_t i = 0; i < placed.size(); ++i) {
      auto p = particle(words, i);
      Random random(flow_->setup().seed, Purpose::thinning, placed.id[i], flow_->steps_done);
      const auto copies = static_cast<std::int64_t>(copies_of(i, p) + random.uniform_fine());
      if (!old_->is_vibrating) p.levels = start_levels(p.species, random);
      p.cell = placed.cell[i];
      if (is_further_copy(p.id)) next_ = std::max(next_, p.id + 1);
      for (std::int64_t k = 0; k < copies; ++k) {
        flow_->particles.append(p);
        p.id = first_provisional | placed.id[i];
      }
    }
    n_old_ += static_cast<std::int64_t>(placed.size());
  }

  /// Gives further copies their numbers along the cells, in each in the order of the old particles. Collective.
  void number(GlobalId n_cells) {
    auto& particles = flow_->particles;
    particles.sort_by_cell(flow_->domain().n_cells());  // copies of one particle are equal, so their order is no matter
    std::vector<std::int64_t> count(at(flow_->domain().n_cells()), 0);
    for (std::size_t i = 0; i < particles.size(); ++i)
      if (is_provisional(particles.id[i])) ++count[at(particles.cell[i])];
    const auto base = static_cast<std::uint64_t>(comm_->max(static_cast<std::int64_t>(next_)));
    auto next = number_along_cells(*comm_, n_cells, flow_->domain().cell_global, count).first;
    for (std::size_t i = 0; i < particles.size(); ++i)
      if (auto& id = particles.id[i]; is_provisional(id))
        id = base + static_cast<std::uint64_t>(next[at(particles.cell[i])]++);
  }

  /// Old particles that were added. Local.
  std::int64_t n_old() const { return n_old_; }

 private:
  // Ids with bit 63 belong to particles that entered (inflow.cpp), small ones to those of the start. In between are
  // further copies, and above these such as wait for their number, so that the ids of a cell are always in order.
  static constexpr std::uint64_t first_copy = std::uint64_t{1} << 62U,
                                 first_provisional = first_copy | first_copy >> 1U;
  static bool is_further_copy(std::uint64_t id) { return id >> 62U == 1; }
  static bool is_provisional(std::uint64_t id) { return id >> 61U == 3; }

  Particle particle(const std::vector<std::uint64_t>& words, std::size_t i) const {
    return particle_from(words.data() + i * old_->particles.width, old_->is_vibrating);
  }
  std::uint32_t start_levels(std::uint32_t species, Random& random) const {
    const auto& setup = flow_->setup();
    return thermal_levels(setup.gas.species[species].vibration, setup.stream.front().vibrational_temperature, random);
  }
  void require_room() const {
    par::agree(*comm_, [&] {
      constexpr double most = 0x1p31, bytes = sizeof(Particle);
      if (!(expected_ <= most && expected_ * bytes <= static_cast<double>(memory_of_machine())))
        throw Error(fmt::format(
            "{}: expected at most {:.4g} particles on a rank, and memory for them, found {:.4g} of the new weight on "
            "rank {}: use a greater weight",
            old_->name, most, expected_, comm_->rank()));
    });
  }

  const par::Comm* comm_;
  const OldFlow* old_;
  Flow* flow_;
  double expected_ = 0;              ///< copies
  std::uint64_t next_ = first_copy;  ///< after the ids of all copies that were added
  std::int64_t n_old_ = 0;
};

/// What an old cell that is nobody's parent leaves to the new cell that has its place.
struct Inheritance {
  GlobalId old_cell = 0, cell = 0;
  double max_sigma_cr = 0;
  double energy = 0;  ///< deficit, J
};

/// What a new cell takes from the old cell that its centroid is in. `share`: its part of that cell's molecules, over
/// its F_num. `remainder`: a new one, for cells that have changed.
CellCollisions inherited(const CellRow& old, double share, double remainder, bool is_same_cell) {
  const auto& [max_sigma_cr, old_remainder, temperature, separation, n_collisions, energy_deficit] = old.collisions;
  (void)separation, (void)n_collisions;  // of the averages, which begin with the new mesh
  return {max_sigma_cr, is_same_cell ? old_remainder : remainder, temperature, 0, 0, share * energy_deficit};
}

/// Gives the new cells what the old ones remember of their collisions. Collective.
void inherit_collisions(const par::Comm& comm, const OldFlow& old, const std::vector<GlobalId>& parent,
                        const std::vector<Host>& hosts, Flow& flow) {
  constexpr double rounding = 1e-12;
  const auto n_old = old.cells.rows;
  const auto columns = columns_of(old);
  const auto& domain = flow.domain();
  const bool is_weighted = old.is_weighted && flow.setup().gas.is_weighted;
  const auto cells = par::fetch_rows<std::uint64_t>(comm, n_old, old.cells.block, columns.width(), parent);
  const auto host = par::fetch_rows<Host>(comm, n_old, hosts, 1, parent);
  const auto is_near = [](double a, double b) { return std::fabs(a - b) <= rounding * b; };
  for (std::size_t c = 0; c < flow.collisions.size(); ++c) {
    const auto row = cell_row(cells.data() + c * columns.width(), columns);
    const double v = domain.volume[c], fnum = domain.fnum[c];
    const bool is_same = is_near(host[c].volume, v) && is_near(row.volume, v) && is_near(row.fnum, fnum);
    auto cell = inherited(row, is_weighted ? v / host[c].volume * row.fnum / fnum : 0,
                          draw_remainder(flow.setup().seed, domain.cell_global[c], flow.steps_done), is_same);
    cell.max_sigma_cr = std::max(cell.max_sigma_cr, flow.collisions[c].max_sigma_cr);  // walls may be hotter now
    flow.collisions[c] = cell;
  }
  const auto first = par::block_range(n_old, comm.rank(), comm.size()).begin;
  std::vector<par::Outgoing<Inheritance>> messages(static_cast<std::size_t>(comm.size()));
  for (Rank r = 0; r < comm.size(); ++r) messages[at(r)].to = r;
  for (std::size_t c = 0; c < hosts.size(); ++c) {
    if (hosts[c].volume > 0) continue;
    const auto row = cell_row(old.cells.block.data() + c * columns.width(), columns);
    messages[at(hosts[c].rank)].item.push_back({first + static_cast<GlobalId>(c), hosts[c].cell,
                                                row.collisions.max_sigma_cr,
                                                is_weighted ? row.collisions.energy_deficit * row.fnum : 0});
  }
  std::erase_if(messages, [](const auto& m) { return m.item.empty(); });
  auto left = comm.sparse_exchange(messages).item;
  std::sort(left.begin(), left.end(), [](const auto& a, const auto& b) { return a.old_cell < b.old_cell; });
  for (const auto& one : left) {
    const auto c = at(local_cell(domain.cell_global, one.cell));
    flow.collisions[c].max_sigma_cr = std::max(flow.collisions[c].max_sigma_cr, one.max_sigma_cr);
    flow.collisions[c].energy_deficit += one.energy / domain.fnum[c];
  }
}

/// Puts all particles where they belong, when the parents of the cells and the hosts of the old ones are known.
/// Collective.
Transferred settle(const par::Comm& comm, const OldFlow& old, const std::vector<GlobalId>& parent,
                   std::vector<Host> hosts, const mesh::DistMesh& mesh, Flow& flow) {
  fill_gaps(comm, hosts);
  flow.steps_done = old.steps_done;
  InOrderOfCells order(old_particles_of_cells(old));
  const auto first_row = comm.exclusive_sum(order.size());
  Passage passage(comm, mesh, flow.setup());
  Copies copies(comm, old, flow);
  std::vector<Passenger> missing;
  par::in_rounds(comm, at(order.size()), particles_of_round, [&](std::size_t begin, std::size_t end) {
    const auto passengers =
        passengers_of(comm, old, hosts, first_row + static_cast<GlobalId>(begin), order.take(end - begin));
    const auto placed = passage.fly(send_to_hosts(comm, passengers));
    const auto lost = missing_of(comm, passengers, old.particles.rows, placed);
    missing.insert(missing.end(), lost.begin(), lost.end());
    copies.add(placed);
  });
  copies.add(find_missing(comm, mesh, flow, std::move(missing)));
  copies.number(mesh.info.n_global_cells);
  inherit_collisions(comm, old, parent, hosts, flow);
  const auto found = comm.sum(copies.n_old());
  return {old.particles.rows, flow.n_particles(), old.particles.rows - found, old.steps_done};
}

/// The modes of the species of a flow that vibrates: those of `gas`, if that vibrates too.
std::vector<Vibration> modes_in(const nlohmann::json& setup, const Gas& gas) {
  std::vector<Vibration> vibration;
  for (const auto& modes : array_of(member(setup, "vibration"), "vibration", gas.species.size())) {
    auto& mode = vibration.emplace_back().mode;
    for (const auto& theta : array_of(modes, "modes")) mode.push_back(number_of(theta, "the temperature of a mode"));
    const bool differs = gas.is_vibrating && mode != gas.species[vibration.size() - 1].vibration.mode;
    if (differs || mode.size() > max_modes)
      throw Error(fmt::format("expected a flow of species with the modes of this case, found modes of {} K of {}",
                              short_text(modes), gas.species[vibration.size() - 1].name));
  }
  return vibration;
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
    old.is_vibrating = setup.contains("vibration");
    if (old.is_vibrating) old.vibration = modes_in(setup, flow.setup().gas);
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

Transferred transfer_particles(const par::Comm& comm, const OldFlow& old, const mesh::DistMesh& mesh, Flow& flow) {
  const auto parent = themselves(mesh);
  return settle(comm, old, parent, find_hosts(comm, mesh, parent, old.cells.rows, flow.setup().unit), mesh, flow);
}

Transferred transfer_particles(const par::Comm& comm, const std::string& name, const mesh::DistMesh& mesh, Flow& flow) {
  const SectionFile file(comm, name);
  auto old = setup_in(file, name, flow);
  old.cells = file.read("cells", columns_of(old).width());
  old.particles = file.read("particles", particle_words(old.is_vibrating));
  auto range = sound_range(flow);
  range.is_weighted = old.is_weighted;
  range.is_vibrating = old.is_vibrating;
  range.vibration = old.vibration;
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
