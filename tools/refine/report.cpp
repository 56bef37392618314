// SPDX-License-Identifier: GPL-3.0-or-later
#include "refine/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <numeric>
#include <string>

namespace pamr::refine_tool {

namespace {

nlohmann::json over_ranks(const par::Comm& comm, double here) {
  const auto all = comm.all_gather(here);
  const double sum = std::accumulate(all.begin(), all.end(), 0.0);
  return {{"min", *std::min_element(all.begin(), all.end())},
          {"mean", sum / static_cast<double>(all.size())},
          {"max", *std::max_element(all.begin(), all.end())}};
}

}  // namespace

nlohmann::json make_report(const par::Comm& comm, const adapt::Report& report, const Measured& measured) {
  nlohmann::json seconds, cpu_seconds, check_seconds;
  double total = 0, cpu_total = 0;
  for (const auto& step : measured.steps) {
    if (step.step == Measured::check_step) {
      check_seconds = over_ranks(comm, step.wall);
      continue;
    }
    seconds[step.step] = over_ranks(comm, step.wall);
    cpu_seconds[step.step] = over_ranks(comm, step.cpu);
    total += step.wall;
    cpu_total += step.cpu;
  }
  seconds["total"] = over_ranks(comm, total);
  cpu_seconds["total"] = over_ranks(comm, cpu_total);
  const auto at_rest = comm.sum(static_cast<std::int64_t>(measured.bytes_at_rest));
  const auto peak = static_cast<std::int64_t>(peak_resident_bytes());
  return {{"cells_in", report.cells_in},
          {"cells_out", report.cells_out},
          {"nodes_in", report.nodes_in},
          {"nodes_out", report.nodes_out},
          {"marked", report.marked},
          {"marked_not_split", report.marked_not_split},
          {"rounds", report.rounds},
          {"back_off_rounds", report.back_off_rounds},
          {"families_rebuilt", report.families_rebuilt},
          {"families_kept", report.families_kept},
          {"inverted_cells", measured.inverted_cells},
          {"off_surface_nodes", report.off_surface_nodes},
          {"fingerprint", fmt::format("{:016x}", measured.fingerprint)},
          {"ranks", comm.size()},
          {"peak_rss_bytes", comm.max(peak)},
          {"peak_rss_bytes_sum", comm.sum(peak)},
          {"bytes_per_cell_at_rest", static_cast<double>(at_rest) / static_cast<double>(report.cells_out)},
          {"bytes_sent_max", comm.max(comm.traffic().bytes)},
          {"messages_sent_max", comm.max(comm.traffic().messages)},
          {"bytes_read_max", comm.max(measured.bytes_read)},
          {"seconds", seconds},
          {"cpu_seconds", cpu_seconds},
          {"check_seconds", check_seconds}};
}

std::int64_t bytes_read_so_far() {
  std::ifstream io("/proc/self/io");
  std::int64_t bytes = 0;
  for (std::string word; io >> word;)
    if (word == "rchar:") io >> bytes;
  return bytes;
}

}  // namespace pamr::refine_tool
