// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/kernel/flight.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/kernel/surface_tally.hpp"

namespace pamr::dsmc {

/// What one boundary face of another rank was given.
struct FaceHits {
  std::int64_t face = 0;
  SurfaceTally::Sums sums;
};

/// What came from the neighbors, by ascending ranks, with the numbers of cells and faces of this rank.
struct Arrivals {
  std::vector<Particle> resting;
  std::vector<Flight> flying;
  std::vector<FaceHits> hits;
};

/// Collects what leaves a rank and delivers it to its neighbors. A message has room for somewhat more than the last
/// ones in its place had, which both sides know, so that nobody has to ask first; what finds no room follows in a
/// second message.
class BorderExchange {
 public:
  /// For a domain with a halo, which outlives it.
  explicit BorderExchange(const GasDomain& domain);

  /// A particle whose flight has ended in the halo, in the cell that its link names.
  void add(Particle particle);
  /// A flight that goes on behind the halo.
  void add(Flight flight);
  /// To a face of the halo's boundary.
  void add_hit(std::size_t halo_face, const SurfaceTally& units, geometry::Vec3 momentum, double energy);
  /// Whether there is nothing to deliver.
  bool is_empty() const { return n_ == 0; }

  /// Delivers what was added. `round`: number of deliveries before this one in the time step, the same on all ranks.
  /// Collective: one message to and from each neighbor, and a second one where there was no room.
  Arrivals deliver(const par::Comm& comm, int round);

 private:
  using Bytes = std::vector<std::byte>;
  /// Running mean of the lengths of messages, in sixteenths of a unit: whole numbers, the same on both sides.
  struct Room {
    std::size_t mean = 0;
    std::size_t bytes() const;
    void note(std::size_t n_bytes);
  };
  struct Rooms {
    std::vector<Room> out, in;  ///< for each neighbor
  };
  Bytes pack(std::size_t neighbor) const;
  void unpack(const Bytes& message, Arrivals& arrivals) const;
  void take_hits();
  void enter(Flight& flight) const;

  const GasDomain* domain_;
  std::vector<Arrivals> leaving_;  ///< to each neighbor, with the numbers of its cells and faces
  std::size_t n_ = 0;
  SurfaceTally tally_;                  ///< of the halo's boundary
  std::vector<std::size_t> hit_faces_;  ///< of these
  std::array<Rooms, 2> rooms_;          ///< of the first and later rounds
};

}  // namespace pamr::dsmc
