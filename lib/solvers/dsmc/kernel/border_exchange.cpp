// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/border_exchange.hpp"

#include <algorithm>
#include <cstring>
#include <span>

#include "pamr/base/index.hpp"

namespace pamr::dsmc {

namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t room_after(std::size_t n_last) { return n_last + n_last / 4 + 4; }

/// The number of the flights, and those that there is room for.
Bytes pack(std::span<const Flight> flights, std::size_t room) {
  Bytes message(sizeof(std::uint64_t) + room * sizeof(Flight));
  const std::uint64_t n = flights.size();
  std::memcpy(message.data(), &n, sizeof n);
  const auto fitting = std::as_bytes(flights.first(std::min(flights.size(), room)));
  std::copy(fitting.begin(), fitting.end(), message.begin() + sizeof n);
  return message;
}

}  // namespace

BorderExchange::BorderExchange(const GasDomain& domain) : domain_(&domain), leaving_(domain.border_rank.size()) {
  for (auto& room : room_) {
    room.out.assign(leaving_.size(), room_after(0));
    room.in = room.out;
  }
}

void BorderExchange::add(Flight flight) {
  const auto face = at(flight.particle.cell);
  const auto& offset = domain_->border_offset;
  const auto i = static_cast<std::size_t>(std::upper_bound(offset.begin(), offset.end(), face) - offset.begin()) - 1;
  flight.particle.cell = static_cast<LocalId>(face - offset[i]);
  leaving_[i].push_back(flight);
  ++n_;
}

std::vector<Flight> BorderExchange::deliver(const par::Comm& comm, int round) {
  const auto n = leaving_.size();
  auto& room = room_[static_cast<std::size_t>(std::min(round, 2))];
  std::vector<Bytes> out(n), in(n);
  std::vector<std::span<const std::byte>> send(n);
  std::vector<std::span<std::byte>> receive(n);
  for (std::size_t i = 0; i < n; ++i) {
    out[i] = pack(leaving_[i], room.out[i]);
    in[i].resize(sizeof(std::uint64_t) + room.in[i] * sizeof(Flight));
    send[i] = out[i];
    receive[i] = in[i];
  }
  comm.neighbor_exchange(domain_->border_rank, send, receive);

  std::vector<std::size_t> n_in(n), first(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    std::uint64_t count = 0;
    std::memcpy(&count, in[i].data(), sizeof count);
    n_in[i] = static_cast<std::size_t>(count);
    first[i + 1] = first[i] + n_in[i];
  }
  std::vector<Flight> arrived(first.back());
  bool is_more = false;
  for (std::size_t i = 0; i < n; ++i) {
    const auto here = std::span(arrived).subspan(first[i], n_in[i]);
    const auto fitting = std::as_writable_bytes(here.first(std::min(n_in[i], room.in[i])));
    std::copy_n(in[i].begin() + sizeof(std::uint64_t), fitting.size(), fitting.begin());
    receive[i] = std::as_writable_bytes(here).subspan(fitting.size());
    const auto leaving = std::span<const Flight>(leaving_[i]);
    send[i] = std::as_bytes(leaving.subspan(std::min(leaving.size(), room.out[i])));
    is_more = is_more || !send[i].empty() || !receive[i].empty();
  }
  if (is_more) comm.neighbor_exchange(domain_->border_rank, send, receive);

  for (std::size_t i = 0; i < n; ++i) {
    room.out[i] = room_after(leaving_[i].size());
    room.in[i] = room_after(n_in[i]);
    leaving_[i].clear();
    for (auto k = first[i]; k < first[i + 1]; ++k) enter(arrived[k], domain_->border_offset[i]);
  }
  n_ = 0;
  return arrived;
}

void BorderExchange::enter(Flight& flight, std::size_t first_face) const {
  const auto face = first_face + at(flight.particle.cell);
  flight.particle.cell = domain_->border_face[face].cell;
  if (domain_->uniform_dt) return;
  const double ratio = domain_->dt[at(flight.particle.cell)] / flight.dt_from;
  flight.time = flight.passed + (flight.time - flight.passed) * ratio;
}

}  // namespace pamr::dsmc
