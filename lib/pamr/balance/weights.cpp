// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/weights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/par/reproducible_sum.hpp"

namespace pamr::balance {

namespace {

void check_each(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const double> weight,
                const std::string& what) {
  par::agree(comm, [&] {
    if (weight.size() != mesh.cell_global.size())
      throw Error(fmt::format("{}: expected one for each of the {} cells of rank {}, found {}", what, mesh.n_cells(),
                              comm.rank(), weight.size()));
    for (std::size_t c = 0; c < weight.size(); ++c)
      if (!std::isfinite(weight[c]) || weight[c] < 0)
        throw Error(fmt::format("{}: expected finite numbers of at least 0, found {} at cell {}", what, weight[c],
                                mesh.cell_global[c]));
  });
}

}  // namespace

std::vector<std::int64_t> integer_weights(const par::Comm& comm, const mesh::DistMesh& mesh,
                                          std::span<const double> weight, const std::string& what) {
  check_each(comm, mesh, weight, what);
  double greatest = 0;
  bool is_plain = true;  // positive integers
  for (const auto w : weight) {
    greatest = std::max(greatest, w);
    is_plain = is_plain && w >= 1 && w == std::floor(w);
  }
  greatest = comm.max(greatest);
  is_plain = comm.all(is_plain);
  if (!(greatest > 0))
    throw Error(
        fmt::format("{}: expected at least one above 0, found 0 in all the {} cells", what, mesh.info.n_global_cells));
  int exponent = 0;
  std::frexp(greatest, &exponent);
  par::ExactSum here;
  for (const auto w : weight) here.add(std::ldexp(w, -exponent));  // at most 1 each
  const double total = par::reproducible_sums(comm, std::span(&here, 1)).front();

  const auto limit = static_cast<double>(max_total_weight);
  const bool keep = is_plain && std::ldexp(total, exponent) <= limit;
  int scale = 0;
  std::frexp(limit / total, &scale);
  std::vector<std::int64_t> result;
  result.reserve(weight.size());
  for (const auto w : weight) {
    const double scaled = keep ? w : std::ldexp(w, scale - 1 - exponent);
    result.push_back(std::max<std::int64_t>(1, std::llround(scaled)));
  }
  return result;
}

std::vector<std::int64_t> weights_from_field(const par::Comm& comm, const mesh::DistMesh& mesh,
                                             const std::string& name) {
  std::vector<double> weight;
  par::agree(comm, [&] {
    const auto* field = mesh.find_cell_field(name);
    if (field == nullptr)
      throw Error(fmt::format("weights: expected a cell field '{}', found none of that name", name));
    if (field->n_components != 1)
      throw Error(
          fmt::format("weights: expected a cell field of one component, found '{}' of {}", name, field->n_components));
    if (field->holds_integers())
      weight.assign(field->integer().begin(), field->integer().end());
    else
      weight = field->real();
  });
  return integer_weights(comm, mesh, weight, "weights: cell field '" + name + "'");
}

}  // namespace pamr::balance
