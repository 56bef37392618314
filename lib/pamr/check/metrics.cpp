// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "pamr/geometry/tet_shape.hpp"
#include "pamr/par/reproducible_sum.hpp"

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

const std::array<Edges, n_metrics>& histogram_edges() {
  static const std::array<Edges, n_metrics> edges{evenly_spaced(0, 1),   evenly_spaced(0, 1),   evenly_spaced_powers(),
                                                  evenly_spaced(0, 180), evenly_spaced(0, 180), evenly_spaced_powers()};
  return edges;
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

std::vector<MetricReport> measure_cells(const par::Comm& comm, const mesh::DistMesh& mesh) {
  const auto& edges = histogram_edges();
  std::array<double, 2 * n_metrics> extreme{};  // minima, then maxima
  std::fill_n(extreme.begin(), n_metrics, unbounded);
  std::fill_n(extreme.begin() + n_metrics, n_metrics, -unbounded);
  std::vector<par::ExactSum> sums(n_metrics);
  std::vector<std::int64_t> counts(n_metrics * n_bins, 0);
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto value = cell_metrics(mesh.points(cell));
    for (std::size_t m = 0; m < n_metrics; ++m) {
      extreme[m] = std::min(extreme[m], value[m]);
      extreme[n_metrics + m] = std::max(extreme[n_metrics + m], value[m]);
      sums[m].add(value[m]);
      ++counts[m * n_bins + bin_of(edges[m], value[m])];
    }
  }

  const auto total = par::reproducible_sums(comm, sums);
  comm.sum_in_place(counts);
  const auto n_cells = static_cast<double>(comm.sum(std::int64_t{mesh.n_cells()}));
  std::vector<MetricReport> reports(n_metrics);
  for (std::size_t m = 0; m < n_metrics; ++m) {
    auto& report = reports[m];
    report.name = metric_names()[m];
    report.edge = edges[m];
    const double min = comm.min(extreme[m]), max = comm.max(extreme[n_metrics + m]);
    if (n_cells > 0) {
      report.min = min;
      report.max = max;
      report.mean = total[m] / n_cells;
    }
    std::copy_n(counts.begin() + static_cast<std::ptrdiff_t>(m * n_bins), n_bins, report.histogram.begin());
  }
  return reports;
}

}  // namespace pamr::check
