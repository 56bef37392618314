// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/harmonic.hpp"

#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "pamr/base/index.hpp"

namespace pamr::poisson_boltzmann {

namespace {

constexpr double reduction = 1e-3;  ///< of the residual
constexpr int max_iterations = 100000;

/// The diagonal entries of given nodes are larger by so much, which holds them.
constexpr double hold = 1e12;

/// The matrix with given nodes, and what the iterations need.
class HeldMatrix {
 public:
  HeldMatrix(const par::Comm& comm, const Domain& domain, const SymmetricRows& rows, std::uint64_t given)
      : comm_(comm), nodes_(domain.nodes), rows_(rows), scale(rows.diagonal) {
    nodes_.sum_copies(comm, scale);
    for (std::size_t i = 0; i < scale.size(); ++i) {
      if ((domain.node_patches[i] & given) != 0) {
        held_.push_back({i, (hold - 1) * scale[i]});
        scale[i] *= hold;
      }
      scale[i] = scale[i] > 0 ? 1 / scale[i] : 0;
      if (!nodes_.is_owned(i)) copies_.push_back(i);
    }
  }

  /// y = K x of all ranks, nothing held. Collective.
  void multiply_free(const std::vector<double>& x, std::vector<double>& y) const {
    rows_.multiply(x, y);
    nodes_.sum_copies(comm_, y);
  }

  /// y = A x of all ranks; returns x . A x. Collective.
  double multiply(const std::vector<double>& x, std::vector<double>& y) const {
    double product = rows_.multiply(x, y);
    nodes_.sum_copies(comm_, y);
    for (const auto& [node, entry] : held_) {
      y[node] += entry * x[node];
      if (nodes_.is_owned(node)) product += entry * x[node] * x[node];
    }
    return total(product);
  }

  std::vector<double> without_held(std::vector<double> values) const {
    for (const auto& [node, entry] : held_) values[node] = 0;
    return values;
  }

  struct Norms {
    double squared = 0, scaled = 0;
  };
  /// r -= step q; r . r and r . r with the inverse of the diagonal. Collective.
  Norms advance(double step, const std::vector<double>& q, std::vector<double>& r) const {
    // Four sums at a time: one would wait for its own last addition.
    std::array<Norms, 4> part{};
    const auto add = [&](std::size_t i, Norms& to) {
      r[i] -= step * q[i];
      const double square = r[i] * r[i];
      to.squared += square;
      to.scaled += square * scale[i];
    };
    std::size_t i = 0;
    for (; i + 4 <= r.size(); i += 4)
      for (std::size_t lane = 0; lane < 4; ++lane) add(i + lane, part[lane]);
    for (; i < r.size(); ++i) add(i, part[0]);
    Norms norms{(part[0].squared + part[1].squared) + (part[2].squared + part[3].squared),
                (part[0].scaled + part[1].scaled) + (part[2].scaled + part[3].scaled)};
    for (const auto node : copies_) {
      const double square = r[node] * r[node];
      norms.squared -= square;
      norms.scaled -= square * scale[node];
    }
    return {total(norms.squared), total(norms.scaled)};
  }

 private:
  /// Sum over the ranks in their order. Collective.
  double total(double here) const {
    const auto of_ranks = comm_.all_gather(here);
    return std::accumulate(of_ranks.begin(), of_ranks.end(), 0.0);
  }

  const par::Comm& comm_;
  const NodeMap& nodes_;
  const SymmetricRows& rows_;
  struct Held {
    std::size_t node;
    double entry;  ///< that the diagonal has in addition
  };
  std::vector<Held> held_;
  std::vector<std::size_t> copies_;  ///< nodes of other ranks

 public:
  std::vector<double> scale;  ///< n_nodes: inverse of the diagonal
};

}  // namespace

std::vector<double> harmonic_function(const par::Comm& comm, const Domain& domain, const SymmetricRows& rows,
                                      std::uint64_t one, std::uint64_t zero) {
  const auto n_nodes = domain.point.size();
  const HeldMatrix matrix(comm, domain, rows, one | zero);
  std::vector<double> given(n_nodes, 0), product(n_nodes);
  for (std::size_t i = 0; i < n_nodes; ++i)
    if ((domain.node_patches[i] & one) != 0) given[i] = 1;
  matrix.multiply_free(given, product);
  product = matrix.without_held(std::move(product));

  // Solved for what is missing from the given values.
  std::vector<double> missing(n_nodes, 0), residual(n_nodes, 0), direction(n_nodes);
  auto norms = matrix.advance(1, product, residual);
  for (std::size_t i = 0; i < n_nodes; ++i) direction[i] = matrix.scale[i] * residual[i];
  const double wanted = reduction * std::sqrt(norms.squared);
  for (int k = 0; k < max_iterations && std::sqrt(norms.squared) > wanted; ++k) {
    const double before = norms.scaled;
    const double step = before / matrix.multiply(direction, product);
    norms = matrix.advance(step, product, residual);
    const double turn = norms.scaled / before;
    for (std::size_t i = 0; i < n_nodes; ++i) {
      missing[i] += step * direction[i];
      direction[i] = matrix.scale[i] * residual[i] + turn * direction[i];
    }
  }
  auto result = matrix.without_held(std::move(missing));
  for (std::size_t i = 0; i < n_nodes; ++i) result[i] += given[i];
  return result;
}

}  // namespace pamr::poisson_boltzmann
