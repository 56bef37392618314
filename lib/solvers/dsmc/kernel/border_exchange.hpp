// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pamr/par/comm.hpp"
#include "solvers/dsmc/kernel/flight.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"

namespace pamr::dsmc {

/// Collects the flights that leave a rank and delivers them to its neighbors. A message has room for somewhat more
/// flights than the last one in its place, which both sides know, so that nobody has to ask first; what finds no room
/// follows in a second message.
class BorderExchange {
 public:
  /// For a domain that outlives it.
  explicit BorderExchange(const GasDomain& domain);

  /// `flight.particle.cell` is the number of the border face that it crosses.
  void add(Flight flight);
  bool is_empty() const { return n_ == 0; }

  /// Delivers what was added and returns what the neighbors added, by ascending ranks, in the cells that it has come
  /// to. `round`: number of deliveries before this one in the time step, the same on all ranks. Collective: one message
  /// to and from each neighbor, and a second one where there was no room.
  std::vector<Flight> deliver(const par::Comm& comm, int round);

 private:
  struct Room {
    std::vector<std::size_t> out, in;  ///< flights, for each neighbor
  };
  void enter(Flight& flight, std::size_t first_face) const;

  const GasDomain* domain_;
  std::vector<std::vector<Flight>> leaving_;  ///< to each neighbor; their cell is the number of the face on this border
  std::size_t n_ = 0;
  std::array<Room, 3> room_;  ///< of the first, second and later rounds
};

}  // namespace pamr::dsmc
