// SPDX-License-Identifier: GPL-3.0-or-later
// Speed and memory of one refinement, the refine call alone, on the workloads that the peers were measured on
// (docs/reports/performance.md): W1 all of K(55) split 1:8; W2 a shell of K(56) with closure; W3 five levels of the
// cells cut by a sphere in K(14); W1-tagged and W2-tagged: W1 and W2 (policy 3, removable) with a tenth of the faces
// inside in a patch; and `limit`, which writes the same bytes a cell without any logic. The sizes of 20
// are for a quick look. Run alone or under mpirun; the first rank prints. Rates are of all ranks together; CPU seconds
// are summed over the ranks.
#include <benchmark/benchmark.h>

#include <memory>

#include "bench/compare/memory.hpp"
#include "bench/workloads.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/par/runtime.hpp"

namespace {

using namespace pamr;

const par::Comm* world = nullptr;

struct Stopwatch {
  double wall = wall_seconds();
  double cpu = cpu_seconds();
};

void report(benchmark::State& state, const Stopwatch& start, std::int64_t cells_out, std::size_t memory_before) {
  const auto peak = static_cast<std::int64_t>(bench::peak_bytes() - std::min(bench::peak_bytes(), memory_before));
  const double wall = world->max(wall_seconds() - start.wall);
  const auto cpu = static_cast<double>(world->sum(static_cast<std::int64_t>(1e9 * (cpu_seconds() - start.cpu)))) * 1e-9;
  state.SetIterationTime(wall);
  const auto cells = static_cast<double>(cells_out);
  state.counters["Mcells_per_cpu_s"] = 1e-6 * cells / cpu;
  state.counters["Mcells_per_wall_s"] = 1e-6 * cells / wall;
  state.counters["cells_out"] = cells;
  state.counters["peak_bytes_per_cell"] = static_cast<double>(world->sum(peak)) / cells;
  state.counters["largest_rank_peak_MB"] = 1e-6 * static_cast<double>(world->max(peak));
}

void run(benchmark::State& state, const mesh::DistMesh& mesh, const std::vector<std::uint8_t>& flags,
         std::size_t memory_before, refine::QualityControl policy = refine::QualityControl::removable) {
  for (auto _ : state) {
    peer::warm_memory(600 * static_cast<std::size_t>(mesh.n_cells()));
    bench::reset_peak();
    world->barrier();
    const Stopwatch start;
    const auto result =
        adapt::refine(*world, mesh, flags, {.quality_control = policy, .parent_field = false, .marks_field = ""});
    report(state, start, result.report.cells_out, memory_before);
    state.counters["bytes_at_rest_per_cell"] =
        static_cast<double>(world->sum(static_cast<std::int64_t>(mesh::bytes_at_rest(result.mesh)))) /
        static_cast<double>(result.report.cells_out);
  }
}

void uniform(benchmark::State& state) {
  const auto before = bench::resident_bytes();
  const auto mesh = bench::cube(*world, static_cast<int>(state.range(0)));
  run(state, mesh, std::vector<std::uint8_t>(static_cast<std::size_t>(mesh.n_cells()), 1), before);
}

void uniform_tagged(benchmark::State& state) {
  const auto before = bench::resident_bytes();
  auto mesh = bench::cube(*world, static_cast<int>(state.range(0)));
  bench::tag_planes(mesh, static_cast<int>(state.range(0)));
  run(state, mesh, std::vector<std::uint8_t>(static_cast<std::size_t>(mesh.n_cells()), 1), before);
}

void shell_tagged(benchmark::State& state) {
  const auto before = bench::resident_bytes();
  auto mesh = bench::cube(*world, static_cast<int>(state.range(0)));
  bench::tag_planes(mesh, static_cast<int>(state.range(0)));
  run(state, mesh, bench::mark_shell(mesh, 0.35, 0.06), before);
}

void shell(benchmark::State& state) {
  const auto before = bench::resident_bytes();
  const auto mesh = bench::cube(*world, static_cast<int>(state.range(0)));
  run(state, mesh, bench::mark_shell(mesh, 0.35, 0.06), before, static_cast<refine::QualityControl>(state.range(1)));
}

void levels(benchmark::State& state, refine::QualityControl policy) {
  const auto before = bench::resident_bytes();
  auto mesh = bench::cube(*world, static_cast<int>(state.range(0)));
  for (int level = 1; level < state.range(1); ++level)
    mesh = adapt::refine(*world, mesh, bench::mark_crossing(mesh, 0.35),
                         {.quality_control = policy, .parent_field = false, .marks_field = ""})
               .mesh;
  run(state, mesh, bench::mark_crossing(mesh, 0.35), before, policy);
}

template <class T>
std::vector<T> fresh(std::size_t n, bool in_large_pages) {
  std::vector<T> array;
  if (in_large_pages) reserve_array(array, n);
  array.resize(n);
  return array;
}

/// Writes as many bytes for each cell as a mesh at rest holds, to fresh memory, in the system's ordinary pages or, as
/// the library does, in large ones.
void limit(benchmark::State& state, bool in_large_pages) {
  const auto n = static_cast<std::size_t>(6 * 8 * state.range(0) * state.range(0) * state.range(0) / world->size());
  for (auto _ : state) {
    peer::warm_memory(64 * n);
    const auto before = bench::resident_bytes();
    bench::reset_peak();
    world->barrier();
    const Stopwatch start;
    auto nodes = fresh<mesh::CellNodes>(n, in_large_pages);
    auto neighbors = fresh<mesh::CellNeighbors>(n, in_large_pages);
    auto global = fresh<GlobalId>(n, in_large_pages);
    auto lineage = fresh<mesh::Lineage>(n, in_large_pages);
    auto position = fresh<geometry::Vec3>(n / 6, in_large_pages);
    auto node_global = fresh<GlobalId>(n / 6, in_large_pages);
    for (std::size_t c = 0; c < n; ++c) {
      const auto id = static_cast<LocalId>(c);
      nodes[c] = {id, id + 1, id + 2, id + 3};
      neighbors[c] = {id - 1, id + 1, id - 2, id + 2};
      global[c] = id;
      lineage[c] = mesh::Lineage(static_cast<std::uint64_t>(c));
    }
    for (std::size_t i = 0; i < n / 6; ++i) {
      position[i] = {1.0 * static_cast<double>(i), 0.5, 0.25};
      node_global[i] = static_cast<GlobalId>(i);
    }
    benchmark::DoNotOptimize(nodes.data());
    benchmark::DoNotOptimize(neighbors.data());
    benchmark::DoNotOptimize(global.data());
    benchmark::DoNotOptimize(lineage.data());
    benchmark::DoNotOptimize(position.data());
    benchmark::DoNotOptimize(node_global.data());
    report(state, start, static_cast<std::int64_t>(n) * world->size(), before);
  }
}

class Silent : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& /*context*/) override { return true; }
  void ReportRuns(const std::vector<Run>& /*runs*/) override {}
};

}  // namespace

// Every rank has to run each benchmark the same number of times, so the number is fixed.
BENCHMARK_CAPTURE(limit, ordinary pages, false)
    ->Name("limit")
    ->Arg(20)
    ->Arg(55)
    ->UseManualTime()
    ->Iterations(1)
    ->Repetitions(5)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(limit, large pages, true)
    ->Name("limit-large-pages")
    ->Arg(55)
    ->UseManualTime()
    ->Iterations(1)
    ->Repetitions(5)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(uniform)->Name("W1")->Arg(20)->Arg(55)->UseManualTime()->Iterations(1)->Repetitions(5)->Unit(
    benchmark::kMillisecond);
BENCHMARK(shell)
    ->Name("W2")
    ->ArgsProduct({{20, 56}, {0, 3}})
    ->ArgNames({"n", "policy"})
    ->UseManualTime()
    ->Iterations(1)
    ->Repetitions(5)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(uniform_tagged)
    ->Name("W1-tagged")
    ->Arg(20)
    ->Arg(55)
    ->UseManualTime()
    ->Iterations(1)
    ->Repetitions(5)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(shell_tagged)
    ->Name("W2-tagged")
    ->Arg(20)
    ->Arg(56)
    ->UseManualTime()
    ->Iterations(1)
    ->Repetitions(5)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(levels, removable, refine::QualityControl::removable)
    ->Name("W3")
    ->ArgsProduct({{14}, {1, 2, 3, 4, 5}})
    ->ArgNames({"n", "level"})
    ->UseManualTime()
    ->Iterations(1)
    ->Repetitions(5)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(levels, none, refine::QualityControl::none)
    ->Name("W3-none")
    ->ArgsProduct({{14}, {1, 2, 3, 4, 5}})
    ->ArgNames({"n", "level"})
    ->UseManualTime()
    ->Iterations(1)
    ->Repetitions(5)
    ->Unit(benchmark::kMillisecond);

int main(int argc, char** argv) {
  const pamr::par::Runtime runtime(argc, argv);
  const pamr::par::Comm comm(MPI_COMM_WORLD);
  world = &comm;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  Silent silent;
  if (comm.is_first())
    benchmark::RunSpecifiedBenchmarks();
  else
    benchmark::RunSpecifiedBenchmarks(&silent);
  return 0;
}
