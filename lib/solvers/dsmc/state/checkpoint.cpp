// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/state/checkpoint.hpp"

#include <fmt/format.h>

#include <bit>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/with_file_name.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/par/exchange.hpp"
#include "solvers/dsmc/flow/gas_contents.hpp"
#include "solvers/dsmc/kernel/numbering.hpp"
#include "solvers/dsmc/state/cell_row.hpp"
#include "solvers/dsmc/state/checkpoint_rows.hpp"
#include "solvers/dsmc/state/header_values.hpp"
#include "solvers/dsmc/state/run_state.hpp"
#include "solvers/dsmc/state/section_file.hpp"

namespace pamr::dsmc {

namespace {

using Words = std::vector<std::uint64_t>;

constexpr std::size_t face_words = 12;

/// Numbers of the boundary faces of this rank along the global order of the cells.
struct FaceNumbers {
  std::vector<GlobalId> of;
  std::int64_t total = 0;
};
FaceNumbers number_faces(const par::Comm& comm, GlobalId n_cells, const GasDomain& domain) {
  std::vector<GlobalId> cell;
  std::vector<std::int64_t> count;
  for (const auto& face : domain.boundary) {
    const auto global = domain.cell_global[at(face.cell)];
    if (cell.empty() || cell.back() != global) {
      cell.push_back(global);
      count.push_back(0);
    }
    ++count.back();
  }
  const auto numbering = number_along_cells(comm, n_cells, cell, count);
  FaceNumbers numbers{{}, numbering.total};
  for (std::size_t i = 0; i < cell.size(); ++i)
    for (std::int64_t k = 0; k < count[i]; ++k) numbers.of.push_back(numbering.first[i] + k);
  return numbers;
}

Section particle_section(const par::Comm& comm, GlobalId n_cells, const Flow& flow) {
  const auto numbering =
      number_along_cells(comm, n_cells, flow.domain().cell_global, particles_of_cells(flow.particles));
  const auto& p = flow.particles;
  Section section{"particles", numbering.total, particle_words(p.vibrate()), {}};
  const auto mine = par::block_range(numbering.total, comm.rank(), comm.size());
  section.block.resize(static_cast<std::size_t>(mine.count()) * section.width);
  par::in_rounds(comm, p.size(), particles_of_round, [&](std::size_t begin, std::size_t end) {
    Words words;
    words.reserve(section.width * (end - begin));
    std::vector<GlobalId> rows;
    rows.reserve(end - begin);
    for (auto i = begin; i < end; ++i) {
      words.insert(words.end(), {p.id[i], p.species[i] | std::uint64_t{p.partner[i]} << 32U, word(p.x[i]), word(p.y[i]),
                                 word(p.z[i]), word(p.u[i]), word(p.v[i]), word(p.w[i]), word(p.rotation[i])});
      if (p.vibrate()) words.push_back(p.levels[i]);
      const auto cell = at(p.cell[i]);
      rows.push_back(numbering.first[cell] + static_cast<GlobalId>(i - p.begin()[cell]));
    }
    par::scatter_rows_into<std::uint64_t>(comm, numbering.total, words, rows, section.block);
  });
  return section;
}

Section cell_section(const par::Comm& comm, GlobalId n_cells, const Flow& flow) {
  const auto columns = columns_of(flow.setup().gas);
  const auto n = at(flow.domain().n_cells());
  Words words;
  words.reserve(columns.width() * n);
  for (std::size_t c = 0; c < n; ++c) append(row_of(flow, c), columns, words);
  return {"cells", n_cells, columns.width(),
          par::scatter_rows<std::uint64_t>(comm, n_cells, words, columns.width(), flow.domain().cell_global)};
}

Section face_section(const par::Comm& comm, GlobalId n_cells, const RunState& run, const Flow& flow) {
  const auto numbers = number_faces(comm, n_cells, flow.domain());
  Words words;
  const auto add = [&](const SurfaceTally::Sums& s) {
    words.insert(words.end(),
                 {word(s.hits), word(s.momentum[0]), word(s.momentum[1]), word(s.momentum[2]), word(s.energy)});
  };
  for (std::size_t f = 0; f < numbers.of.size(); ++f) {
    add(flow.surface.face[f]);
    add(run.face[f].sums);
    words.push_back(word(run.face[f].heat_squares));
    words.push_back(word(run.face[f].pressure_squares));
  }
  return {"faces", numbers.total, face_words,
          par::scatter_rows<std::uint64_t>(comm, numbers.total, words, face_words, numbers.of)};
}

nlohmann::json species_list(const Flow& flow) {
  nlohmann::json names = nlohmann::json::array();
  for (const auto& s : flow.setup().gas.species) names.push_back(s.name);
  return names;
}

/// What `--carry` has to know of the tables.
nlohmann::json setup_of(const Flow& flow) {
  const auto& setup = flow.setup();
  nlohmann::json shown{
      {"species", species_list(flow)}, {"dt", setup.dt}, {"molecules", setup.fnum}, {"unit", setup.unit}};
  if (setup.gas.is_weighted)
    for (const auto& s : setup.gas.species) shown["weights"].push_back(s.weight);
  if (setup.gas.is_vibrating)
    for (const auto& s : setup.gas.species) shown["vibration"].push_back(s.vibration.mode);
  return shown;
}

void restore_cells(const par::Comm& comm, const Section& section, GlobalId n_cells, Flow& flow,
                   std::vector<std::int64_t>& count) {
  const auto columns = columns_of(flow.setup().gas);
  const auto& global = flow.domain().cell_global;
  const auto words = par::fetch_rows<std::uint64_t>(comm, n_cells, section.block, columns.width(), global);
  for (std::size_t c = 0; c < global.size(); ++c) {
    const auto row = cell_row(words.data() + c * columns.width(), columns);
    count.push_back(row.particles);
    put(row, c, flow);
  }
}

void restore_particles(const par::Comm& comm, const Section& section, GlobalId n_cells, Flow& flow,
                       const std::vector<std::int64_t>& count) {
  const auto numbering = number_along_cells(comm, n_cells, flow.domain().cell_global, count);
  if (section.rows != numbering.total)
    throw Error(
        fmt::format("checkpoint: expected {} particles, as its cells have, found {}", numbering.total, section.rows));
  InOrderOfCells order(count);
  flow.particles.reserve(at(order.size()));
  par::in_rounds(comm, at(order.size()), particles_of_round, [&](std::size_t begin, std::size_t end) {
    const auto places = order.take(end - begin);
    std::vector<GlobalId> rows;
    for (const auto& place : places) rows.push_back(numbering.first[place.cell] + place.in_cell);
    const auto words = par::fetch_rows<std::uint64_t>(comm, section.rows, section.block, section.width, rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      auto p = particle_from(words.data() + i * section.width, flow.particles.vibrate());
      p.cell = static_cast<LocalId>(places[i].cell);
      flow.particles.append(p);
    }
  });
  flow.particles.sort_by_cell(flow.domain().n_cells());
}

void restore_faces(const par::Comm& comm, const Section& section, GlobalId n_cells, RunState& run, Flow& flow) {
  const auto numbers = number_faces(comm, n_cells, flow.domain());
  if (section.rows != numbers.total)
    throw Error(fmt::format("checkpoint: expected {} boundary faces, found {}", numbers.total, section.rows));
  const auto words = par::fetch_rows<std::uint64_t>(comm, numbers.total, section.block, face_words, numbers.of);
  const auto sums = [](const std::uint64_t* w) {
    return SurfaceTally::Sums{integer(w[0]), {integer(w[1]), integer(w[2]), integer(w[3])}, integer(w[4])};
  };
  for (std::size_t f = 0; f < numbers.of.size(); ++f) {
    const auto* w = words.data() + f * face_words;
    flow.surface.face[f] = sums(w);
    run.face[f] = {sums(w + 5), real(w[10]), real(w[11])};
  }
}

/// Restores the fluxes of the current interval, on rank 0. Checkpoints of older versions have none.
void restore_fluxes(const par::Comm& comm, const nlohmann::json& header, Flow& flow) {
  if (!header.contains("fluxes")) return;
  std::vector<std::int64_t> words;
  for (const auto& word : array_of(header["fluxes"], "fluxes", flow.flux.n_words()))
    words.push_back(integer_of(word, "a word of the fluxes"));
  if (comm.is_first()) flow.flux.set_words(words);
}

/// Restores the averages at inlets and outlets.
void restore_driven(const nlohmann::json& header, Flow& flow) {
  if (flow.driven().empty()) return;
  std::vector<double> means;
  for (const auto& mean : array_of(member(header, "driven"), "driven"))
    means.push_back(number_of(mean, "an average at an inlet or outlet"));
  flow.set_driven_means(means);
}

/// The mesh that the header of a checkpoint names, beside it; empty for none. Throws `Error`.
std::string mesh_file_of(const nlohmann::json& header, const std::string& checkpoint) {
  if (!header.contains("mesh_file")) return {};
  const std::filesystem::path name = string_of(header["mesh_file"], "mesh_file");
  if (name.empty() || name != name.filename())
    throw Error(fmt::format("expected the name of a file beside it, found \"{}\"", name.string()));
  return (std::filesystem::path(checkpoint).parent_path() / name).string();
}

}  // namespace

MeshKey key_of(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::uint64_t sum = 0;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    auto h = static_cast<std::uint64_t>(mesh.cell_global[at(cell)] - mesh.info.first_id);
    for (const auto& p : mesh.points(cell)) h = combine(combine(combine(h, bits_of(p.x)), bits_of(p.y)), bits_of(p.z));
    sum += h;
  }
  return {mesh::fingerprint(comm, mesh), static_cast<std::uint64_t>(comm.sum(static_cast<std::int64_t>(sum))),
          mesh.info.n_global_cells};
}

bool is_of_mesh(const nlohmann::json& header, const MeshKey& mesh) {
  return word_of(member(header, "fingerprint"), "fingerprint") == mesh.fingerprint &&
         word_of(member(header, "numbering"), "numbering") == mesh.numbering &&
         count_of(member(header, "n_cells"), "n_cells") == mesh.n_cells;
}

Snapshot take_snapshot(const par::Comm& comm, const MeshKey& mesh, const RunState& run, const Flow& flow) {
  nlohmann::json header{{"fingerprint", mesh.fingerprint},
                        {"numbering", mesh.numbering},
                        {"n_cells", mesh.n_cells},
                        {"steps_done", flow.steps_done},
                        {"sampled_steps", flow.cells.steps},
                        {"sampled_blocks", flow.cells.blocks},
                        {"steps_in_block", flow.cells.steps_in_block},
                        {"steps_in_blocks", flow.cells.steps_in_blocks},
                        {"setup", setup_of(flow)},
                        {"fluxes", total_fluxes(comm, flow.flux)},
                        {"run", to_json(run)}};
  if (!flow.driven().empty()) header["driven"] = flow.driven_means();
  return {std::move(header), cell_section(comm, mesh.n_cells, flow), face_section(comm, mesh.n_cells, run, flow),
          particle_section(comm, mesh.n_cells, flow)};
}

void require_same_mesh(const SectionFile& file, const MeshKey& mesh) {
  const auto& header = file.header();
  const auto n_rows = file.n_rows("cells");
  const auto fingerprint = word_of(member(header, "fingerprint"), "fingerprint");
  const auto n_cells = count_of(member(header, "n_cells"), "n_cells");
  if (fingerprint != mesh.fingerprint || n_cells != mesh.n_cells || n_rows != mesh.n_cells)
    throw Error(fmt::format(
        "expected a checkpoint of this mesh (fingerprint {:x}, {} cells), found one of another mesh ({:x}, {} cells)",
        mesh.fingerprint, mesh.n_cells, fingerprint, n_rows));
  if (word_of(member(header, "numbering"), "numbering") != mesh.numbering)
    throw Error("expected the cells in the order of this mesh, found another order");
}

RunState restore(const par::Comm& comm, const Snapshot& snapshot, Flow& flow) {
  const auto& header = snapshot.header;
  const auto n_cells = snapshot.cells.rows;
  constexpr std::int64_t max_steps = std::int64_t{1} << 40U;
  const auto steps_done = count_of(member(header, "steps_done"), "steps_done", max_steps);
  const auto steps = [&](const char* key) { return count_of(member(header, key), key, steps_done); };
  flow.steps_done = static_cast<std::uint64_t>(steps_done);
  auto run = run_state_from(member(header, "run"),
                            {flow.steps_done, flow.setup().patch.size(), flow.domain().boundary.size(),
                             flow.setup().patch.size() + flow.setup().plane.size(), flow.setup().gas.species.size()});
  flow.resume(run.sampling);
  flow.cells.steps = steps("sampled_steps");
  flow.cells.blocks = steps("sampled_blocks");
  flow.cells.steps_in_block = steps("steps_in_block");
  flow.cells.steps_in_blocks = steps("steps_in_blocks");
  if (flow.cells.steps != flow.cells.steps_in_block + flow.cells.steps_in_blocks)
    throw Error(fmt::format("checkpoint: expected steps of blocks that add up to {}, found {} and {}", flow.cells.steps,
                            flow.cells.steps_in_block, flow.cells.steps_in_blocks));
  std::vector<std::int64_t> count;
  restore_cells(comm, snapshot.cells, n_cells, flow, count);
  restore_particles(comm, snapshot.particles, n_cells, flow, count);
  restore_faces(comm, snapshot.faces, n_cells, run, flow);
  restore_fluxes(comm, header, flow);
  restore_driven(header, flow);
  return run;
}

void write_checkpoint(const par::Comm& comm, const std::string& file, const Snapshot& snapshot) {
  write_sections(comm, file, snapshot.header, {&snapshot.cells, &snapshot.faces, &snapshot.particles},
                 member(snapshot.header, "setup").contains("vibration") ? 2 : 1);
}

std::optional<std::uint64_t> begun_on(const nlohmann::json& header) {
  if (!header.contains(begun_on_member)) return {};
  return word_of(header[begun_on_member], begun_on_member);
}

CheckpointHead head_of(const par::Comm& comm, const std::string& checkpoint) {
  const SectionFile file(comm, checkpoint);
  return with_file_name(checkpoint, [&] {
    const auto& header = file.header();
    CheckpointHead head;
    head.steps_done = static_cast<std::uint64_t>(count_of(member(header, "steps_done"), "steps_done"));
    head.fnum = number_of(member(member(header, "setup"), "molecules"), "molecules");
    head.n_particles = file.n_rows("particles");
    head.mesh_file = mesh_file_of(header, checkpoint);
    head.begun_on = begun_on(header);
    return head;
  });
}

std::vector<std::string> files_in_checkpoint(const std::string& file) {
  try {
    const auto mesh = mesh_file_of(header_of_sections(file), file);
    return mesh.empty() ? std::vector<std::string>{} : std::vector<std::string>{mesh};
  } catch (const Error&) {  // no sound checkpoint; who reads it says so
    return {};
  }
}

Snapshot read_checkpoint(const SectionFile& file, const Gas& gas) {
  return {file.header(), file.read("cells", columns_of(gas).width()), file.read("faces", face_words),
          file.read("particles", particle_words(gas.is_vibrating))};
}

}  // namespace pamr::dsmc
