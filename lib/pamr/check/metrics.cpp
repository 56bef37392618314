// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "pamr/geometry/tet_shape.hpp"

namespace pamr::check {

namespace {

constexpr std::size_t n_metrics = 6;
constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr std::array<double, n_metrics> worst_value{0, 0, unbounded, 0, 180, unbounded};

using Edges = std::array<double, n_bins + 1>;

Edges evenly_spaced(double from, double to) {
  Edges edge{};
  for (int i = 0; i <= n_bins; ++i) edge[static_cast<std::size_t>(i)] = from + (to - from) * i / n_bins;
  return edge;
}

/// 1 to 100, each edge 10^(1/25) times the one before.
Edges evenly_spaced_powers() {
  Edges edge{};
  for (int i = 0; i <= n_bins; ++i) edge[static_cast<std::size_t>(i)] = std::pow(10.0, i / 25.0);
  return edge;
}

const Edges& edges_of(MetricTally::Scale scale) {
  static const std::array<Edges, 3> edges{evenly_spaced(0, 1), evenly_spaced(0, 180), evenly_spaced_powers()};
  return edges[static_cast<std::size_t>(scale)];
}

std::size_t bin_of(const Edges& edge, double value) {
  const auto above = std::upper_bound(edge.begin(), edge.end(), value) - edge.begin();
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - 1, 0, n_bins - 1));
}

}  // namespace

const std::vector<std::string>& metric_names() {
  static const std::vector<std::string> names{"radius_ratio", "mean_ratio",   "aspect_ratio",
                                              "min_dihedral", "max_dihedral", "edge_ratio"};
  return names;
}

std::array<double, 6> cell_metrics(const geometry::TetPoints& points) {
  const auto angles = geometry::dihedral_angles(points);
  std::array<double, n_metrics> value{geometry::radius_ratio(points),
                                      geometry::mean_ratio(points),
                                      geometry::aspect_ratio(points),
                                      angles.min,
                                      angles.max,
                                      geometry::edge_ratio(points)};
  for (std::size_t m = 0; m < n_metrics; ++m)
    if (std::isnan(value[m])) value[m] = worst_value[m];
  return value;
}

MetricTally::MetricTally(std::vector<Kind> kinds)
    : kinds_(std::move(kinds)),
      min_(kinds_.size(), unbounded),
      max_(kinds_.size(), -unbounded),
      sum_(kinds_.size()),
      count_(kinds_.size() * n_bins, 0) {}

void MetricTally::add(std::size_t m, double value) {
  min_[m] = std::min(min_[m], value);
  max_[m] = std::max(max_[m], value);
  sum_[m].add(value);
  ++count_[m * n_bins + bin_of(edges_of(kinds_[m].scale), value)];
}

std::vector<MetricReport> MetricTally::report(const par::Comm& comm) const {
  auto sums = sum_;
  const auto total = par::reproducible_sums(comm, sums);
  auto counts = count_;
  comm.sum_in_place(counts);
  std::vector<MetricReport> reports(kinds_.size());
  for (std::size_t m = 0; m < kinds_.size(); ++m) {
    auto& report = reports[m];
    report.name = kinds_[m].name;
    report.edge = edges_of(kinds_[m].scale);
    const auto first = counts.begin() + static_cast<std::ptrdiff_t>(m * n_bins);
    std::copy_n(first, n_bins, report.histogram.begin());
    const auto n = std::accumulate(first, first + n_bins, std::int64_t{0});
    const double min = comm.min(min_[m]), max = comm.max(max_[m]);
    if (n == 0) continue;
    report.min = min;
    report.max = max;
    report.mean = total[m] / static_cast<double>(n);
  }
  return reports;
}

std::vector<MetricReport> measure_cells(const par::Comm& comm, const mesh::DistMesh& mesh) {
  using Scale = MetricTally::Scale;
  constexpr std::array<Scale, n_metrics> scale{Scale::to_one,  Scale::to_one,  Scale::powers,
                                               Scale::degrees, Scale::degrees, Scale::powers};
  std::vector<MetricTally::Kind> kinds;
  for (std::size_t m = 0; m < n_metrics; ++m) kinds.push_back({metric_names()[m], scale[m]});
  MetricTally tally(std::move(kinds));
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto value = cell_metrics(mesh.points(cell));
    for (std::size_t m = 0; m < n_metrics; ++m) tally.add(m, value[m]);
  }
  return tally.report(comm);
}

}  // namespace pamr::check
