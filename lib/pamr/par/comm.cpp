// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/comm.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <thread>

#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/par/wait_asleep.hpp"

namespace pamr::par {

namespace {

void require_success(int code, const char* call) {
  if (code == MPI_SUCCESS) return;
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(code, text.data(), &length);
  throw Error(std::string(call) + " failed: " + std::string(text.data(), static_cast<std::size_t>(length)));
}

/// Calls `transfer(offset, length)` for each piece of `n` items: at most `piece` of them, in order. MPI does not let
/// messages of one sender, receiver and tag overtake each other, so they arrive in order, too.
template <class Transfer>
void in_pieces(std::size_t n, std::size_t piece, Transfer transfer) {
  for (std::size_t at = 0; at < n; at += piece) transfer(at, static_cast<int>(std::min(piece, n - at)));
}

}  // namespace

void Comm::Waiting::resume() {
  if (is_running_) return;
  is_running_ = true;
  book(-wall_seconds(), -cpu_seconds());
}

void Comm::Waiting::pause() {
  if (!is_running_) return;
  is_running_ = false;
  book(wall_seconds(), cpu_seconds());
}

void Comm::Waiting::book(double wall, double cpu) {
  traffic_.wait_wall += wall;
  traffic_.wait_cpu += cpu;
  if (in_ == In::library) traffic_.external_cpu += cpu;
}

template <class Operation>
void Comm::together(const char* name, Operation operation) const {
  const Waiting waiting(*this);
  ++traffic_.reductions;
  require_success(operation(), name);
}

template <class T>
T Comm::reduced(T here, MPI_Datatype type, MPI_Op op) const {
  T result{};
  together("MPI_Allreduce", [&] { return MPI_Allreduce(&here, &result, 1, type, op, comm_); });
  return result;
}

Comm::Comm(MPI_Comm parent, Exact<std::size_t> piece_bytes) : piece_bytes_(piece_bytes) {
  PAMR_EXPECTS(piece_bytes >= 1 && piece_bytes <= std::size_t{std::numeric_limits<int>::max()});
  require_success(MPI_Comm_dup(parent, &comm_), "MPI_Comm_dup");
  require_success(MPI_Comm_set_errhandler(comm_, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
  require_success(MPI_Comm_rank(comm_, &rank_), "MPI_Comm_rank");
  require_success(MPI_Comm_size(comm_, &size_), "MPI_Comm_size");
}

Comm::~Comm() {
  int finalized = 0;
  MPI_Finalized(&finalized);
  if (finalized == 0 && comm_ != MPI_COMM_NULL) MPI_Comm_free(&comm_);
}

void Comm::barrier() const {
  together("MPI_Barrier", [&] { return MPI_Barrier(comm_); });
}

bool Comm::any(Exact<bool> here) const { return reduced<int>(here ? 1 : 0, MPI_INT, MPI_MAX) != 0; }
std::int64_t Comm::sum(Exact<std::int64_t> here) const { return reduced<std::int64_t>(here, MPI_INT64_T, MPI_SUM); }
std::int64_t Comm::min(std::int64_t here) const { return reduced(here, MPI_INT64_T, MPI_MIN); }
std::int64_t Comm::max(std::int64_t here) const { return reduced(here, MPI_INT64_T, MPI_MAX); }
double Comm::min(double here) const { return reduced(here, MPI_DOUBLE, MPI_MIN); }
double Comm::max(double here) const { return reduced(here, MPI_DOUBLE, MPI_MAX); }

std::int64_t Comm::min_asleep(Exact<std::int64_t> here) const {
  std::int64_t result = 0;
  together("MPI_Iallreduce", [&] {
    MPI_Request request = MPI_REQUEST_NULL;
    const int code = MPI_Iallreduce(&here, &result, 1, MPI_INT64_T, MPI_MIN, comm_, &request);
    return code == MPI_SUCCESS ? *wait_asleep(request) : code;
  });
  return result;
}

template <class T>
void Comm::reduce_in_place(std::span<T> values, MPI_Datatype type, MPI_Op op) const {
  const std::vector<T> here(values.begin(), values.end());
  in_pieces(values.size(), std::max<std::size_t>(1, piece_bytes_ / sizeof(T)), [&](std::size_t at, int n) {
    together("MPI_Allreduce", [&] { return MPI_Allreduce(here.data() + at, values.data() + at, n, type, op, comm_); });
  });
}

void Comm::sum_in_place(std::span<std::int64_t> values) const { reduce_in_place(values, MPI_INT64_T, MPI_SUM); }
void Comm::max_in_place(std::span<std::int64_t> values) const { reduce_in_place(values, MPI_INT64_T, MPI_MAX); }
void Comm::max_in_place(std::span<double> values) const { reduce_in_place(values, MPI_DOUBLE, MPI_MAX); }

std::int64_t Comm::exclusive_sum(Exact<std::int64_t> here) const {
  std::int64_t before = 0;
  together("MPI_Exscan", [&] { return MPI_Exscan(&here, &before, 1, MPI_INT64_T, MPI_SUM, comm_); });
  return rank_ == 0 ? 0 : before;
}

std::vector<std::int64_t> Comm::all_gather(std::int64_t here) const {
  std::vector<std::int64_t> all(static_cast<std::size_t>(size_));
  together("MPI_Allgather", [&] { return MPI_Allgather(&here, 1, MPI_INT64_T, all.data(), 1, MPI_INT64_T, comm_); });
  return all;
}

std::vector<double> Comm::all_gather(double here) const {
  std::vector<double> all(static_cast<std::size_t>(size_));
  together("MPI_Allgather", [&] { return MPI_Allgather(&here, 1, MPI_DOUBLE, all.data(), 1, MPI_DOUBLE, comm_); });
  return all;
}

void Comm::broadcast_raw(std::vector<std::byte>& data, Rank root) const {
  std::int64_t length = static_cast<std::int64_t>(data.size());
  together("MPI_Bcast", [&] { return MPI_Bcast(&length, 1, MPI_INT64_T, root, comm_); });
  data.resize(static_cast<std::size_t>(length));
  in_pieces(data.size(), piece_bytes_, [&](std::size_t at, int n) {
    together("MPI_Bcast", [&] { return MPI_Bcast(data.data() + at, n, MPI_BYTE, root, comm_); });
  });
}

std::string Comm::broadcast(std::string text, Exact<Rank> root) const {
  const auto data = broadcast(std::vector<char>(text.begin(), text.end()), root);
  return {data.begin(), data.end()};
}

std::vector<Comm::RawReceived> Comm::sparse_exchange_raw(std::span<const RawMessage> messages,
                                                         std::size_t item_bytes) const {
  // The tag alternates between two consecutive calls, so that a fast neighbor's next message is not taken for this
  // call's: the closing barrier keeps it from being more than one call ahead.
  const int tag = 100 + next_tag_;
  next_tag_ = 1 - next_tag_;
  ++traffic_.rounds;
  ++traffic_.reductions;  // the closing barrier
  std::vector<RawReceived> received;
  std::vector<MPI_Request> sends;
  Waiting waiting(*this);
  const auto whole_items = std::max(item_bytes, piece_bytes_ / item_bytes * item_bytes);
  for (const auto& message : messages) {
    PAMR_EXPECTS(message.rank >= 0 && message.rank < size_);
    if (message.data.empty()) continue;
    if (message.rank == rank_) {
      received.push_back({rank_, message.data, nullptr});
      continue;
    }
    in_pieces(message.data.size(), whole_items, [&](std::size_t at, int n) {
      sends.emplace_back();
      require_success(MPI_Issend(message.data.data() + at, n, MPI_BYTE, message.rank, tag, comm_, &sends.back()),
                      "MPI_Issend");
      ++traffic_.messages;
    });
    traffic_.bytes += static_cast<std::int64_t>(message.data.size());
  }
  const auto take = [&](const MPI_Status& status) {
    int count = 0;
    require_success(MPI_Get_count(&status, MPI_BYTE, &count), "MPI_Get_count");
    const auto n = static_cast<std::size_t>(count);
    std::unique_ptr<std::byte[]> memory(new std::byte[n]);  // not set to zero
    require_success(MPI_Recv(memory.get(), count, MPI_BYTE, status.MPI_SOURCE, tag, comm_, MPI_STATUS_IGNORE),
                    "MPI_Recv");
    traffic_.bytes_received += count;
    received.push_back({status.MPI_SOURCE, {memory.get(), n}, std::move(memory)});
  };
  MPI_Request barrier = MPI_REQUEST_NULL;
  bool in_barrier = false;
  for (int done = 0; done == 0;) {
    int arrived = 0;
    MPI_Status status;
    require_success(MPI_Iprobe(MPI_ANY_SOURCE, tag, comm_, &arrived, &status), "MPI_Iprobe");
    if (arrived != 0)
      take(status);
    else
      std::this_thread::yield();  // where ranks share cores the one that is waited for may stand in line for this one
    if (in_barrier) {
      require_success(MPI_Test(&barrier, &done, MPI_STATUS_IGNORE), "MPI_Test");
    } else {
      int sent = 0;
      require_success(MPI_Testall(narrow<int>(sends.size()), sends.data(), &sent, MPI_STATUSES_IGNORE), "MPI_Testall");
      if (sent != 0) {
        require_success(MPI_Ibarrier(comm_, &barrier), "MPI_Ibarrier");
        in_barrier = true;
      }
    }
  }
  waiting.pause();
  // Pieces of one message arrived in order.
  std::stable_sort(received.begin(), received.end(),
                   [](const RawReceived& a, const RawReceived& b) { return a.rank < b.rank; });
  return received;
}

void Comm::neighbor_exchange(std::span<const Rank> rank, std::span<const std::span<const std::byte>> send,
                             std::span<const std::span<std::byte>> receive) const {
  constexpr int tag = 99;
  std::vector<MPI_Request> requests;
  ++traffic_.rounds;
  const Waiting waiting(*this);
  for (std::size_t i = 0; i < rank.size(); ++i) {
    traffic_.bytes_received += static_cast<std::int64_t>(receive[i].size());
    in_pieces(receive[i].size(), piece_bytes_, [&](std::size_t at, int n) {
      requests.emplace_back();
      require_success(MPI_Irecv(receive[i].data() + at, n, MPI_BYTE, rank[i], tag, comm_, &requests.back()),
                      "MPI_Irecv");
    });
  }
  for (std::size_t i = 0; i < rank.size(); ++i) {
    in_pieces(send[i].size(), piece_bytes_, [&](std::size_t at, int n) {
      requests.emplace_back();
      require_success(MPI_Isend(send[i].data() + at, n, MPI_BYTE, rank[i], tag, comm_, &requests.back()), "MPI_Isend");
      ++traffic_.messages;
    });
    traffic_.bytes += static_cast<std::int64_t>(send[i].size());
  }
  require_success(MPI_Waitall(narrow<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE), "MPI_Waitall");
}

void agree(const Comm& comm, const std::function<void()>& local) {
  std::optional<std::string> trouble;
  try {
    local();
  } catch (const Error& error) {
    trouble = error.what();
  }
  const auto first = comm.min_asleep(static_cast<std::int64_t>(trouble ? comm.rank() : comm.size()));
  if (first == comm.size()) return;
  throw Error(comm.broadcast(trouble.value_or(""), static_cast<Rank>(first)));
}

}  // namespace pamr::par
