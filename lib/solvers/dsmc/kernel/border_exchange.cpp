// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/border_exchange.hpp"

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>

#include "pamr/base/index.hpp"

namespace pamr::dsmc {

namespace {

struct Header {
  std::uint64_t n_resting = 0, n_flying = 0, n_hits = 0;

  std::size_t message_bytes() const {
    return sizeof(Header) + n_resting * sizeof(Particle) + n_flying * sizeof(Flight) + n_hits * sizeof(FaceHits);
  }
};

template <class T>
std::byte* put(std::byte* to, const std::vector<T>& items) {
  const auto bytes = std::as_bytes(std::span(items));
  return std::copy(bytes.begin(), bytes.end(), to);
}

template <class T>
const std::byte* append(std::vector<T>& items, std::uint64_t n, const std::byte* from) {
  const auto old = items.size();
  items.resize(old + static_cast<std::size_t>(n));
  const auto room = std::as_writable_bytes(std::span(items).subspan(old));
  std::copy_n(from, room.size(), room.begin());
  return from + room.size();
}

constexpr std::size_t unit = sizeof(Particle);

}  // namespace

/// Four standard deviations more than the mean, if particles leave independently of each other.
std::size_t BorderExchange::Room::bytes() const {
  const auto n = mean / 16 + 1;
  std::size_t root = 1;
  while (root * root < n) ++root;
  return sizeof(Header) + unit * (n + 4 * root + 4);
}

void BorderExchange::Room::note(std::size_t n_bytes) {
  const auto n = 16 * ((n_bytes + unit - 1) / unit);
  if (mean == 0) mean = n;
  mean = n > mean ? mean + (n - mean) / 8 : mean - (mean - n) / 8;
}

BorderExchange::BorderExchange(const GasDomain& domain) : domain_(&domain), leaving_(domain.neighbor.size()) {
  for (auto& rooms : rooms_) {
    rooms.out.resize(leaving_.size());
    rooms.in.resize(leaving_.size());
  }
  tally_.face.resize(domain.halo_boundary.size());
}

void BorderExchange::add(Particle particle) {
  const auto& place = domain_->abroad[at(particle.cell - domain_->n_cells())];
  particle.cell = place.number;
  leaving_[at(place.neighbor)].resting.push_back(particle);
  ++n_;
}

void BorderExchange::add(Flight flight) {
  const auto& place = domain_->abroad[at(flight.particle.cell - domain_->n_cells())];
  flight.particle.cell = place.number;
  leaving_[at(place.neighbor)].flying.push_back(flight);
  ++n_;
}

void BorderExchange::add_hit(std::size_t halo_face, const SurfaceTally& units, geometry::Vec3 momentum, double energy) {
  tally_.momentum_unit = units.momentum_unit;
  tally_.energy_unit = units.energy_unit;
  if (tally_.face[halo_face].hits == 0) hit_faces_.push_back(halo_face);
  tally_.add(halo_face, momentum, energy);
  ++n_;
}

void BorderExchange::take_hits() {
  for (const auto face : hit_faces_) {
    const auto& place = domain_->halo_boundary_place[face];
    leaving_[at(place.neighbor)].hits.push_back({place.number, std::exchange(tally_.face[face], {})});
  }
  hit_faces_.clear();
}

BorderExchange::Bytes BorderExchange::pack(std::size_t neighbor) const {
  const auto& leaving = leaving_[neighbor];
  const Header header{leaving.resting.size(), leaving.flying.size(), leaving.hits.size()};
  Bytes message(header.message_bytes());
  std::memcpy(message.data(), &header, sizeof header);
  put(put(put(message.data() + sizeof header, leaving.resting), leaving.flying), leaving.hits);
  return message;
}

void BorderExchange::unpack(const Bytes& message, Arrivals& arrivals) const {
  Header header;
  std::memcpy(&header, message.data(), sizeof header);
  const auto* from = append(arrivals.resting, header.n_resting, message.data() + sizeof header);
  const auto first = arrivals.flying.size();
  from = append(arrivals.flying, header.n_flying, from);
  append(arrivals.hits, header.n_hits, from);
  for (auto k = first; k < arrivals.flying.size(); ++k) enter(arrivals.flying[k]);
}

Arrivals BorderExchange::deliver(const par::Comm& comm, int round) {
  take_hits();
  const auto n = leaving_.size();
  auto& rooms = rooms_[static_cast<std::size_t>(std::min(round, 1))];
  std::vector<Bytes> out(n), in(n);
  std::vector<std::span<const std::byte>> send(n);
  std::vector<std::span<std::byte>> receive(n);
  std::vector<std::size_t> length(n);
  for (std::size_t i = 0; i < n; ++i) {
    out[i] = pack(i);
    length[i] = out[i].size();
    out[i].resize(std::max(length[i], rooms.out[i].bytes()));
    in[i].resize(rooms.in[i].bytes());
    send[i] = std::span<const std::byte>(out[i]).first(rooms.out[i].bytes());
    receive[i] = in[i];
  }
  comm.neighbor_exchange(domain_->neighbor, send, receive);

  bool is_more = false;
  for (std::size_t i = 0; i < n; ++i) {
    Header header;
    std::memcpy(&header, in[i].data(), sizeof header);
    const auto had = in[i].size(), sent = rooms.out[i].bytes();
    rooms.out[i].note(length[i]);
    rooms.in[i].note(header.message_bytes());
    in[i].resize(std::max(had, header.message_bytes()));
    receive[i] = std::span<std::byte>(in[i]).subspan(had);
    send[i] = std::span<const std::byte>(out[i]).subspan(sent);
    is_more = is_more || !send[i].empty() || !receive[i].empty();
  }
  if (is_more) comm.neighbor_exchange(domain_->neighbor, send, receive);

  Arrivals arrivals;
  for (std::size_t i = 0; i < n; ++i) {
    unpack(in[i], arrivals);
    leaving_[i] = {};
  }
  n_ = 0;
  return arrivals;
}

void BorderExchange::enter(Flight& flight) const {
  if (domain_->uniform_dt) return;
  const double ratio = domain_->dt[at(flight.particle.cell)] / flight.dt_from;
  flight.time = flight.passed + (flight.time - flight.passed) * ratio;
}

}  // namespace pamr::dsmc
