// SPDX-License-Identifier: GPL-3.0-or-later
/// A ball-shaped pulse that a constant wind carries through a cube, on a mesh that follows it: an example of a solver
/// of one's own that refines and coarsens with PAMR in memory, in one MPI run. README.md says what it shows.
///
///     mpirun -n 2 moving-front [--n CELLS] [--levels L] [--uniform] [--every STEPS] [--frames N] [--out FOLDER]
///
///     --n CELLS       cells along an edge of the cube at level 0 (6)
///     --levels L      of refinement (3)
///     --uniform       refine all cells L times instead, and never again
///     --every STEPS   steps between adaptations (2)
///     --frames N      meshes to write, evenly in time (0)
///     --out FOLDER    for meshes and history.csv (.)
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>

#include "finite_volumes.hpp"

namespace {

using front::FiniteVolumes;
using pamr::LocalId;
using pamr::geometry::Vec3;
using Clock = std::chrono::steady_clock;

constexpr Vec3 wind{1, 0.6, 0.4}, start{0.3, 0.35, 0.4};
constexpr double radius = 0.2;
constexpr double end_time = 1.05;  // the pulse has left through x = 1 by then, and what the scheme smears with it
constexpr double courant = 0.4;
constexpr double split_above = 0.02, merge_below = 0.004;  // of the difference between neighbors; the pulse is 1 high

std::size_t at(LocalId i) { return static_cast<std::size_t>(i); }
double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

struct Options {
  int n = 6, levels = 3, every = 2, frames = 0;
  bool is_uniform = false;
  std::string out = ".";
};

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--uniform") {
      options.is_uniform = true;
      continue;
    }
    if (i + 1 == argc) throw pamr::Error("moving-front: " + name + " needs a value, or is unknown");
    const std::string value = argv[++i];
    if (name == "--out")
      options.out = value;
    else if (name == "--n")
      options.n = std::stoi(value);
    else if (name == "--levels")
      options.levels = std::stoi(value);
    else if (name == "--every")
      options.every = std::stoi(value);
    else if (name == "--frames")
      options.frames = std::stoi(value);
    else
      throw pamr::Error("moving-front: unknown option " + name);
  }
  if (options.n < 1 || options.levels < 0 || options.every < 1 || options.frames < 0)
    throw pamr::Error("moving-front: numbers must be positive");
  return options;
}

double exact(Vec3 point, double time) {
  const double r = norm(point - start - time * wind) / radius;
  return r < 1 ? 0.5 * (1 + std::cos(std::numbers::pi * r)) : 0;
}

std::vector<double> exact_values(const FiniteVolumes& volumes, double time) {
  std::vector<double> value;
  for (LocalId c = 0; c < volumes.n_cells(); ++c) value.push_back(exact(volumes.centroid(c), time));
  return value;
}

void put(pamr::mesh::DistMesh& mesh, const std::string& name, int n_components, std::vector<double> value) {
  mesh.cell_fields.push_back({name, "", n_components, pamr::mesh::StorageType::float64, std::move(value)});
}

std::vector<double> flat(const std::vector<Vec3>& vectors) {
  std::vector<double> numbers;
  for (const auto& v : vectors) numbers.insert(numbers.end(), {v.x, v.y, v.z});
  return numbers;
}

Vec3 vector_in(const pamr::mesh::DistMesh& mesh, const std::string& name, LocalId cell) {
  const auto* of_cell = &mesh.find_cell_field(name)->real()[3 * at(cell)];
  return {of_cell[0], of_cell[1], of_cell[2]};
}

/// What a cell must know to give linear values to the cells that come of it: it travels as fields, so that it is
/// averaged by volume where cells become one.
void pack(const FiniteVolumes& volumes, const std::vector<double>& value, pamr::mesh::DistMesh& mesh) {
  put(mesh, "c", 1, value);
  put(mesh, "slope", 3, flat(volumes.slopes(value)));
  put(mesh, "center", 3, flat(volumes.centroids()));
}

/// Values at the new cells' centroids. The children of a cell have its value on average, so that the sum is kept.
std::vector<double> unpack(const FiniteVolumes& volumes, pamr::mesh::DistMesh& mesh) {
  auto value = mesh.find_cell_field("c")->real();
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    value[at(c)] += dot(vector_in(mesh, "slope", c), volumes.centroid(c) - vector_in(mesh, "center", c));
  mesh.cell_fields.clear();
  return value;
}

/// Cells whose neighbors differ from them, and the cells around these, are split down to the finest level; cells that
/// are equal to their neighbors may be coarsened.
std::vector<std::int8_t> flags_of(const FiniteVolumes& volumes, const pamr::mesh::DistMesh& mesh,
                                  const std::vector<double>& value, int levels) {
  const auto jump = volumes.jumps(value);
  const auto ghost = volumes.ghosts(jump);
  std::vector<std::int8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    double largest = jump[at(c)];
    for (const auto next : mesh.cell_to_cell[at(c)])
      if (next >= 0)
        largest = std::max(largest, mesh.is_ghost(next) ? ghost[at(next - mesh.n_cells())] : jump[at(next)]);
    const bool is_finest = mesh.lineage[at(c)].level() >= levels;
    flags.push_back(largest > split_above ? (is_finest ? 0 : 1) : largest < merge_below ? -1 : 0);
  }
  return flags;
}

class Run {
 public:
  Run(const pamr::par::Comm& comm, const Options& options)
      : comm_(comm),
        options_(options),
        mesh_(pamr::assemble::assemble(comm, pamr::assemble::kuhn_cube(comm, options.n))),
        level0_(pamr::mesh::fingerprint(comm, mesh_)) {
    volumes_.emplace(comm_, mesh_, wind);
    for (int level = 0; level < options.levels; ++level) {
      auto flags = flags_of(*volumes_, mesh_, exact_values(*volumes_, 0), options_.levels);
      if (options_.is_uniform) std::fill(flags.begin(), flags.end(), std::int8_t{1});
      adapt(flags);
    }
    value_ = exact_values(*volumes_, 0);
    mass_at_start_ = mass();
  }

  void go() {
    const auto name = options_.out + "/history.csv";
    if (comm_.is_first()) history_ = std::fopen(name.c_str(), "w");
    if (comm_.any(comm_.is_first() && history_ == nullptr)) throw pamr::Error("moving-front: cannot write " + name);
    say("step,time,cells,error,mass_defect,largest,smallest_mean_ratio");
    seconds_adapting_ = 0;  // the first mesh does not count
    const auto begin = Clock::now();
    for (double next_frame = 0; time_ < end_time;) {
      const bool writes = options_.frames > 0 && time_ >= next_frame;
      if (writes || steps_ % 50 == 0) tell();
      if (writes) {
        next_frame += end_time / options_.frames;
        write();
      }
      advance(volumes_->time_step(courant));
      if (!options_.is_uniform) follow();
    }
    for (int level = 0; level < options_.levels && !options_.is_uniform; ++level) follow();
    tell();
    const double all = seconds_since(begin);
    const bool is_level0 = pamr::mesh::fingerprint(comm_, mesh_) == level0_;
    if (comm_.is_first())
      std::printf(
          "%d steps, mean %.0f cells, largest error %.4f, the last mesh is %slevel 0; %.1f s, of which adapting %.1f "
          "%%\n",
          steps_, cell_steps_ / n_told_, worst_error_, is_level0 ? "" : "not ", all, 100 * seconds_adapting_ / all);
    if (comm_.any(history_ != nullptr && std::fclose(history_) != 0))
      throw pamr::Error("moving-front: cannot write " + name);
  }

 private:
  void adapt(const std::vector<std::int8_t>& flags) {
    const auto begin = Clock::now();
    auto result = pamr::adapt::adapt(comm_, std::move(mesh_), flags);
    mesh_ = std::move(result.mesh);
    std::erase_if(mesh_.cell_fields, [](const auto& field) { return field.name == pamr::mesh::parent_field; });
    seconds_adapting_ += seconds_since(begin);
    volumes_.emplace(comm_, mesh_, wind);
  }

  /// The steps until the mesh is adapted next.
  void advance(double dt) {
    for (int i = 0; i < options_.every && time_ < end_time; ++i) {
      const double step = std::min(dt, end_time - time_);
      left_ += pamr::par::reproducible_sum(comm_, std::array{volumes_->advance(step, value_)});
      time_ += step;
      ++steps_;
    }
  }

  /// Adapts the mesh to the solution and carries it over.
  void follow() {
    const auto flags = flags_of(*volumes_, mesh_, value_, options_.levels);
    pack(*volumes_, value_, mesh_);
    adapt(flags);
    value_ = unpack(*volumes_, mesh_);
  }

  double mass() const {
    std::vector<double> parts;
    for (LocalId c = 0; c < mesh_.n_cells(); ++c) parts.push_back(volumes_->volume(c) * value_[at(c)]);
    return pamr::par::reproducible_sum(comm_, parts);
  }

  void tell() {
    const auto truth = exact_values(*volumes_, time_);
    double largest = 0, worst_shape = 1;
    std::vector<double> parts;
    for (LocalId c = 0; c < mesh_.n_cells(); ++c) {
      parts.push_back(volumes_->volume(c) * std::abs(value_[at(c)] - truth[at(c)]));
      largest = std::max(largest, value_[at(c)]);
      worst_shape = std::min(worst_shape, pamr::geometry::mean_ratio(mesh_.points(c)));
    }
    const double error = pamr::par::reproducible_sum(comm_, parts) / mass_at_start_;
    const double defect = (mass() + left_ - mass_at_start_) / mass_at_start_;
    worst_error_ = std::max(worst_error_, error);
    cell_steps_ += static_cast<double>(mesh_.info.n_global_cells);
    ++n_told_;
    char row[200];
    std::snprintf(row, sizeof row, "%d,%.5f,%lld,%.5f,%.1e,%.4f,%.4f", steps_, time_,
                  static_cast<long long>(mesh_.info.n_global_cells), error, defect, comm_.max(largest),
                  comm_.min(worst_shape));
    say(row);
  }

  void say(const char* line) const {
    if (!comm_.is_first()) return;
    std::puts(line);
    if (history_ != nullptr) std::fprintf(history_, "%s\n", line);
  }

  void write() {
    char name[40];
    std::snprintf(name, sizeof name, "/front_%03d.hdf", n_frames_++);
    put(mesh_, "c", 1, value_);
    pamr::io::write_native(comm_, options_.out + name, mesh_);
    mesh_.cell_fields.clear();
  }

  const pamr::par::Comm& comm_;
  Options options_;
  pamr::mesh::DistMesh mesh_;
  std::uint64_t level0_;                  ///< fingerprint of the first mesh
  std::optional<FiniteVolumes> volumes_;  ///< of the mesh as it is
  std::vector<double> value_;
  double time_ = 0, mass_at_start_ = 0, left_ = 0, worst_error_ = 0, cell_steps_ = 0, seconds_adapting_ = 0;
  int steps_ = 0, n_frames_ = 0, n_told_ = 0;
  std::FILE* history_ = nullptr;
};

}  // namespace

int main(int argc, char** argv) {
  const pamr::par::Runtime mpi(argc, argv);
  const pamr::par::Comm comm(mpi.world());
  try {
    Run(comm, read_options(argc, argv)).go();
  } catch (const std::exception& error) {
    if (comm.is_first()) std::fprintf(stderr, "moving-front: error: %s\n", error.what());
    return 2;
  }
  return 0;
}
