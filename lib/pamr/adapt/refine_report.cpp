// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/refine_report.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pamr::adapt {

namespace {

nlohmann::json over_ranks(const std::vector<double>& all) {
  const double sum = std::accumulate(all.begin(), all.end(), 0.0);
  return {{"min", *std::min_element(all.begin(), all.end())},
          {"mean", sum / static_cast<double>(all.size())},
          {"max", *std::max_element(all.begin(), all.end())}};
}

nlohmann::json over_ranks(const par::Comm& comm, double here) { return over_ranks(comm.all_gather(here)); }

/// What a step took in addition to its time; one entry for each key of the report.
std::vector<std::pair<const char*, double>> quantities(const StepTime& step) {
  const auto& traffic = step.traffic;
  return {{"compute", step.compute()},
          {"library", traffic.external_cpu},
          {"wait", traffic.wait_wall},
          {"messages", static_cast<double>(traffic.messages)},
          {"bytes", static_cast<double>(traffic.bytes)},
          {"bytes_received", static_cast<double>(traffic.bytes_received)},
          {"rounds", static_cast<double>(traffic.rounds)},
          {"reductions", static_cast<double>(traffic.reductions)}};
}

nlohmann::json balance_report(const par::Comm& comm, const adapt::BalanceReport& balance) {
  return {{"method", balance::name_of(balance.method)},
          {"imbalance_before", balance.before.imbalance},
          {"imbalance_after", balance.after.imbalance},
          {"edge_cut_before", balance.before.edge_cut},
          {"edge_cut_after", balance.after.edge_cut},
          {"neighbors_max_before", balance.before.max_neighbors},
          {"neighbors_max_after", balance.after.max_neighbors},
          {"moved_cells", balance.moved_cells},
          {"partition_seconds", over_ranks(comm, balance.partition_seconds)},
          {"migrate_seconds", over_ranks(comm, balance.migrate_seconds)}};
}

/// Steps as `seconds` names them: cells migrate only where that balances something.
std::vector<StepTime> with_migration_in_balance(const std::vector<StepTime>& steps) {
  std::vector<StepTime> named;
  for (auto step : steps) {
    if (step.step == "migrate") step.step = "balance";
    named = merge_steps(std::move(named), {step});
  }
  return named;
}

}  // namespace

nlohmann::json to_json(const Report& report) {
  return {{"cells_in", report.cells_in},
          {"cells_out", report.cells_out},
          {"nodes_in", report.nodes_in},
          {"nodes_out", report.nodes_out},
          {"marked", report.closure.n_marked},
          {"marked_not_split", report.marked_not_split},
          {"marked_too_deep", report.marked_too_deep},
          {"rounds", report.closure.rounds},
          {"sweeps", report.closure.sweeps},
          {"early_passes", report.closure.early_passes},
          {"back_off_rounds", report.certificate.back_off_rounds},
          {"moved_nodes", report.certificate.n_moved},
          {"cells_checked", report.certificate.n_cells_checked},
          {"families_rebuilt", report.closure.families_rebuilt},
          {"families_kept", report.closure.families_kept},
          {"floor_cost", report.floor_cost},
          {"lower_floor", report.lower_floor},
          {"off_surface_nodes", report.certificate.n_off_surface},
          {"off_facets_nodes", report.certificate.n_off_facets},
          {"level0",
           {{"coarse_edges", report.level0.n_coarse_edges},
            {"bent_cells", report.level0.n_bent_cells},
            {"moved_nodes", report.level0.n_moved},
            {"min_jacobian_before", report.level0.smallest_before},
            {"min_jacobian", report.level0.smallest},
            {"shapes", to_json(report.level0.shapes)}}}};
}

nlohmann::json to_json(const curved::Level0Shapes& shapes) {
  const auto place = [](const mesh::WorstPlace& worst) {
    return nlohmann::json{{"value", worst.value}, {"where", {worst.where.x, worst.where.y, worst.where.z}}};
  };
  return {{"determinant", place(shapes.determinant)},
          {"mean_ratio", place(shapes.mean_ratio)},
          {"sampled", place(shapes.sampled)},
          {"split", shapes.split},
          {"all_splits", place(shapes.all_splits)}};
}

std::string nothing_coarsened_text(const CoarseningReport& report) {
  if (report.octets_gone > 0 || report.cells_without_parent == 0) return {};
  return fmt::format(
      "nothing was coarsened: of {} cells that may be coarsened {} know no parent (they are of level 0, of "
      "broken families or of files without their history)",
      report.cells_flagged, report.cells_without_parent);
}

nlohmann::json to_json(const CoarseningReport& report) {
  return {{"cells_flagged", report.cells_flagged},
          {"cells_without_parent", report.cells_without_parent},
          {"cells_without_siblings", report.cells_without_siblings},
          {"octets_gone", report.octets_gone},
          {"octets_needed", report.octets_needed},
          {"octets_kept", report.octets_kept},
          {"families_closed", report.families_closed},
          {"families_kept", report.families_kept},
          {"cells_moved", report.cells_moved},
          {"cells_between", report.cells_between},
          {"rounds", report.rounds}};
}

nlohmann::json make_report(const par::Comm& comm, const adapt::Report& report, const Measured& measured) {
  nlohmann::json seconds, cpu_seconds, check_seconds, steps, of_rank;
  const auto sent = comm.traffic();  // before the report sends anything itself
  for (const auto& step : measured.steps) {
    if (step.step == Measured::check_step) continue;
    for (const auto& [name, here] : quantities(step)) {
      const auto all = comm.all_gather(here);
      steps[step.step][name] = over_ranks(all);
      if (measured.lists_ranks) of_rank[step.step][name] = all;
    }
  }
  double total = 0, cpu_total = 0;
  for (const auto& step : with_migration_in_balance(measured.steps)) {
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
  const auto bytes_sent = comm.max(sent.bytes), messages_sent = comm.max(sent.messages);
  auto json = to_json(report);
  json.update({{"inverted_cells", measured.inverted_cells},
               {"cells_below_floor", measured.cells_below_floor},
               {"fingerprint", fmt::format("{:016x}", measured.fingerprint)},
               {"ranks", comm.size()},
               {"peak_rss_bytes", comm.max(peak)},
               {"peak_rss_bytes_sum", comm.sum(peak)},
               {"bytes_per_cell_at_rest", static_cast<double>(at_rest) / static_cast<double>(report.cells_out)},
               {"bytes_sent_max", bytes_sent},
               {"messages_sent_max", messages_sent},
               {"bytes_read_max", comm.max(measured.bytes_read)},
               {"balance", balance_report(comm, report.balance)},
               {"seconds", seconds},
               {"cpu_seconds", cpu_seconds},
               {"check_seconds", check_seconds},
               {"steps", steps}});
  if (measured.lists_ranks) {
    of_rank["peak_rss_bytes"] = comm.all_gather(peak);
    of_rank["shared_rss_bytes"] = comm.all_gather(shared_resident_bytes());
    of_rank["neighbors_closing"] = comm.all_gather(report.neighbors_closing);
    of_rank["neighbors"] = comm.all_gather(report.neighbors);
    of_rank["cells_out"] = comm.all_gather(measured.cells_here);
    json["of_rank"] = of_rank;
  }
  return json;
}

std::int64_t shared_resident_bytes() {
  std::ifstream status("/proc/self/status");
  std::int64_t kilobytes = 0;
  for (std::string word; status >> word;)
    if (word == "RssShmem:") status >> kilobytes;
  return 1024 * kilobytes;
}

std::int64_t bytes_read_so_far() {
  // no stream: this is asked within the time that the report tells
  std::array<char, 128> text{};
  const int io = ::open("/proc/self/io", O_RDONLY | O_CLOEXEC);
  if (io < 0) return 0;
  const auto n = ::read(io, text.data(), text.size());
  ::close(io);
  const std::string_view all(text.data(), n < 0 ? 0 : static_cast<std::size_t>(n)), key = "rchar: ";
  std::int64_t bytes = 0;
  if (const auto at = all.find(key); at != std::string_view::npos)
    std::from_chars(all.data() + at + key.size(), all.data() + all.size(), bytes);
  return bytes;
}

}  // namespace pamr::adapt
