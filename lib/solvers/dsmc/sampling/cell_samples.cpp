// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/cell_samples.hpp"

#include "pamr/base/memory.hpp"

namespace pamr::dsmc {

using namespace geometry;

void CellSamples::clear(std::size_t n_cells, const Gas& gas) {
  *this = {};
  assign_array(sums, n_cells * gas.species.size(), {});
  assign_array(block, n_cells, 0.0);
  assign_array(square_of_blocks, n_cells, 0.0);
}

void CellSamples::add(const Particles& p, const Gas& gas) {
  const auto n_species = gas.species.size();
  ++steps;
  ++steps_in_block;
  const auto begin = p.begin();
  for (std::size_t c = 0; c < block.size(); ++c) {
    const auto first = begin[c], last = begin[c + 1];
    if (!gas.is_weighted) block[c] += last - first;
    if (n_species == 1) {
      CellSums here;
      for (auto i = first; i < last; ++i) {
        const Vec3 v = p.velocity(i);
        here.velocity = here.velocity + v;
        here.square += squared_norm(v);
        here.rotation += p.rotation[i];
        if (gas.is_vibrating) here.vibration += vibrational_energy(gas.species[0].vibration, p.levels[i]);
      }
      auto& sum = sums[c];
      sum.n += last - first;
      sum.velocity = sum.velocity + here.velocity;
      sum.square += here.square;
      sum.rotation += here.rotation;
      sum.vibration += here.vibration;
      continue;
    }
    for (auto i = first; i < last; ++i) {
      auto& sum = sums[c * n_species + p.species[i]];
      const Vec3 v = p.velocity(i);
      sum.n += 1;
      sum.velocity = sum.velocity + v;
      sum.square += squared_norm(v);
      sum.rotation += p.rotation[i];
      if (gas.is_vibrating) sum.vibration += vibrational_energy(gas.species[p.species[i]].vibration, p.levels[i]);
      if (gas.is_weighted) block[c] += gas.species[p.species[i]].weight;
    }
  }
}

void CellSamples::end_block() {
  if (steps_in_block == 0) return;
  for (std::size_t c = 0; c < block.size(); ++c) {
    square_of_blocks[c] += block[c] * block[c];
    block[c] = 0;
  }
  ++blocks;
  steps_in_blocks += steps_in_block;
  steps_in_block = 0;
}

}  // namespace pamr::dsmc
