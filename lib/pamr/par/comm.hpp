// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mpi.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "pamr/base/contract.hpp"
#include "pamr/base/exact.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/base/types.hpp"

namespace pamr::par {

/// What one rank received from the others: the items from `rank[i]` are `item[offset[i] .. offset[i+1])`, ranks
/// ascending.
template <class T>
struct Received {
  std::vector<Rank> rank;
  std::vector<std::size_t> offset{0};
  std::vector<T> item;

  std::span<const T> from(std::size_t i) const {
    return std::span<const T>(item).subspan(offset[i], offset[i + 1] - offset[i]);
  }
};

/// Items for one other rank.
template <class T>
struct Outgoing {
  Rank to = 0;
  std::vector<T> item;
};

/// A group of processes. Holds a duplicate of the MPI communicator it was made from, so its messages never meet those
/// of the application. Every member function but `rank`, `size` and `traffic` is collective; every one is
/// deterministic, and sums are of integers only, because a sum of doubles depends on the number of ranks.
class Comm {
 public:
  /// Collective over `parent`. MPI must be initialized and outlive the object. The counts of MPI are of 32 bits, so
  /// messages of more than `piece_bytes` (1 to 2^31 - 1, the same on every rank) go in pieces; tests choose tiny ones.
  explicit Comm(MPI_Comm parent, Exact<std::size_t> piece_bytes = std::size_t{1} << 30U);
  ~Comm();
  Comm(const Comm&) = delete;
  Comm& operator=(const Comm&) = delete;
  Comm(Comm&&) = delete;
  Comm& operator=(Comm&&) = delete;

  Rank rank() const { return rank_; }
  Rank size() const { return size_; }
  bool is_first() const { return rank_ == 0; }
  MPI_Comm handle() const { return comm_; }
  /// What this rank has sent through this object, and the time it has spent in its calls, since it was made.
  Traffic traffic() const { return traffic_; }

  /// Books time as spent in communication, from its making to its end but for the pauses. Not to be nested. Costs two
  /// readings of the clocks.
  class Waiting {
   public:
    enum class In : bool {
      mpi,
      library,  ///< one that communicates by itself through `handle()`: HDF5, Scotch; work and waiting are one there
    };
    explicit Waiting(const Comm& comm, In in = In::mpi) : traffic_(comm.traffic_), in_(in) { resume(); }
    ~Waiting() { pause(); }
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;
    Waiting(Waiting&&) = delete;
    Waiting& operator=(Waiting&&) = delete;
    void resume();
    void pause();

   private:
    void book(double wall, double cpu);
    Traffic& traffic_;
    In in_;
    bool is_running_ = false;
  };
  /// Runs a part of such a library and returns what it returns.
  template <class Call>
  auto in_library(Call&& call) const {
    const Waiting waiting(*this, Waiting::In::library);
    return call();
  }

  void barrier() const;
  bool any(Exact<bool> here) const;
  bool all(Exact<bool> here) const { return !any(!here); }
  std::int64_t sum(Exact<std::int64_t> here) const;
  template <std::floating_point T>
  T sum(T here) const = delete;  // par::reproducible_sum adds doubles
  std::int64_t min(std::int64_t here) const;
  std::int64_t max(std::int64_t here) const;
  /// As `min`, for what one rank may have worked on for long while the others had nothing to do: those sleep
  /// (`wait_asleep`).
  std::int64_t min_asleep(Exact<std::int64_t> here) const;
  double min(double here) const;
  double max(double here) const;
  /// Element by element; the spans have the same length on every rank.
  void sum_in_place(std::span<std::int64_t> values) const;
  void max_in_place(std::span<std::int64_t> values) const;
  void max_in_place(std::span<double> values) const;
  /// Sum over the ranks before this one; 0 on rank 0.
  std::int64_t exclusive_sum(Exact<std::int64_t> here) const;
  std::vector<std::int64_t> all_gather(std::int64_t here) const;
  std::vector<double> all_gather(double here) const;
  /// Text of rank `root` on every rank.
  std::string broadcast(std::string text, Exact<Rank> root = 0) const;
  /// Same for plain data; only `root` gives the length.
  template <class T>
  std::vector<T> broadcast(std::vector<T> values, Exact<Rank> root = 0) const;

  /// Delivers each message to its rank (at most one message per target); nobody needs to know who will write to it.
  /// Sparse: costs as many messages as there are pairs that talk, plus one barrier. Source: T. Hoefler, C. Siebert,
  /// A. Lumsdaine, "Scalable communication protocols for dynamic sparse data exchange", PPoPP 2010 (NBX).
  template <class T>
  Received<T> sparse_exchange(const std::vector<Outgoing<T>>& messages) const;

  /// Bytes to and from known neighbors: `send[i]` goes to `rank[i]`, whose answer fills `receive[i]`, whose length is
  /// known beforehand. Use `Exchange` instead where a pattern is at hand.
  void neighbor_exchange(std::span<const Rank> rank, std::span<const std::span<const std::byte>> send,
                         std::span<const std::span<std::byte>> receive) const;

 private:
  struct RawMessage {
    Rank rank = 0;
    std::span<const std::byte> data;
  };
  /// A message, or a piece of one, that arrived; `data` lies in `memory`, or where a message to this rank itself lay.
  struct RawReceived {
    Rank rank = 0;
    std::span<const std::byte> data;
    std::unique_ptr<std::byte[]> memory;
  };
  /// In ascending order of ranks, the pieces of one message in their order. No item of `item_bytes` is cut in two.
  std::vector<RawReceived> sparse_exchange_raw(std::span<const RawMessage> messages, std::size_t item_bytes) const;
  void broadcast_raw(std::vector<std::byte>& data, Rank root) const;
  /// One operation of all ranks: counts it, times it, and throws `Error` when it fails. `operation` returns MPI's code.
  template <class Operation>
  void together(const char* name, Operation operation) const;
  template <class T>
  T reduced(T here, MPI_Datatype type, MPI_Op op) const;
  template <class T>
  void reduce_in_place(std::span<T> values, MPI_Datatype type, MPI_Op op) const;

  MPI_Comm comm_ = MPI_COMM_NULL;
  Rank rank_ = 0;
  Rank size_ = 1;
  std::size_t piece_bytes_ = 0;
  mutable Traffic traffic_;
  mutable int next_tag_ = 0;
};

/// Runs `local` (which must not communicate) on every rank; when it throws `Error` on some ranks, every rank throws the
/// `Error` of the lowest of them. Collective. Any other exception passes through on the rank where it rose.
void agree(const Comm& comm, const std::function<void()>& local);

/// Half-open range of the ids that block `rank` of `size` holds in the canonical block distribution.
struct BlockRange {
  GlobalId begin = 0, end = 0;
  GlobalId count() const { return end - begin; }
  bool contains(GlobalId id) const { return id >= begin && id < end; }
};
inline BlockRange block_range(IdRange ids, Exact<Rank> rank, Exact<Rank> size) {
  const GlobalId quotient = ids.n / size, remainder = ids.n % size;
  const GlobalId begin = ids.first + rank * quotient + std::min<GlobalId>(rank, remainder);
  return {begin, begin + quotient + (rank < remainder ? 1 : 0)};
}
/// The block that holds item `id`. Inline, so that a loop over many items divides by the number of blocks only once.
inline Rank block_of(Exact<GlobalId> id, IdRange ids, Exact<Rank> size) {
  PAMR_EXPECTS(ids.contains(id));
  const GlobalId quotient = ids.n / size, remainder = ids.n % size;
  const GlobalId in_long = remainder * (quotient + 1), at = id - ids.first;
  return static_cast<Rank>(at < in_long ? at / (quotient + 1) : remainder + (at - in_long) / quotient);
}

template <class T>
std::vector<T> Comm::broadcast(std::vector<T> values, Exact<Rank> root) const {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto bytes = std::as_bytes(std::span<const T>(values));
  std::vector<std::byte> data(bytes.begin(), bytes.end());
  broadcast_raw(data, root);
  values.resize(data.size() / sizeof(T));
  std::copy(data.begin(), data.end(), reinterpret_cast<std::byte*>(values.data()));
  return values;
}

template <class T>
Received<T> Comm::sparse_exchange(const std::vector<Outgoing<T>>& messages) const {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<RawMessage> raw;
  raw.reserve(messages.size());
  for (const auto& message : messages) raw.push_back({message.to, std::as_bytes(std::span<const T>(message.item))});
  auto arrived = sparse_exchange_raw(raw, sizeof(T));
  Received<T> result;
  std::size_t total = 0;
  for (const auto& message : arrived) total += message.data.size() / sizeof(T);
  reserve_array(result.item, total);
  for (auto& message : arrived) {
    if (result.rank.empty() || result.rank.back() != message.rank) {
      result.rank.push_back(message.rank);
      result.offset.push_back(result.offset.back());
    }
    const auto* items = reinterpret_cast<const T*>(message.data.data());
    result.item.insert(result.item.end(), items, items + message.data.size() / sizeof(T));
    result.offset.back() = result.item.size();
    message.memory.reset();
  }
  return result;
}

}  // namespace pamr::par
