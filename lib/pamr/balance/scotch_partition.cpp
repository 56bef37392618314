// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/scotch_partition.hpp"

#include <fmt/format.h>
#include <ptscotch.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <numeric>
#include <string>
#include <type_traits>

#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"

static_assert(std::is_same_v<SCOTCH_Num, std::int64_t>, "PAMR needs Scotch with 64-bit integers");

namespace {

/// The last thing that Scotch complained about; its own printing is replaced by the functions below.
std::string& last_complaint() {
  static std::string text;
  return text;
}

}  // namespace

// Scotch leaves these three to the program that uses it. Hidden, so that another Scotch in the same process keeps its
// own.
extern "C" {
__attribute__((visibility("hidden"))) void SCOTCH_errorProg(const char* const) {}
__attribute__((visibility("hidden"))) void SCOTCH_errorPrint(const char* const format, ...) {
  std::array<char, 512> text{};
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(text.data(), text.size(), format, values);
  va_end(values);
  last_complaint() = text.data();
}
__attribute__((visibility("hidden"))) void SCOTCH_errorPrintW(const char* const, ...) {}
}

namespace pamr::balance {

namespace {

void require_success(const par::Comm& comm, int code, const char* call) {
  par::agree(comm, [&] {
    if (code == 0) return;
    throw Error(fmt::format("partition: expected {} to succeed, found that it failed{}{} (rank {})", call,
                            last_complaint().empty() ? "" : ": ", last_complaint(), comm.rank()));
  });
}

/// Scotch's builds with integers of 32 and 64 bits have the same names: that the right one was linked shows only here.
void require_integer_size(const par::Comm& comm) {
  par::agree(comm, [&] {
    const auto size = SCOTCH_numSizeof();
    if (size != static_cast<int>(sizeof(SCOTCH_Num)))
      throw Error(fmt::format("partition: expected a Scotch with integers of {} bytes, found one with {} (rank {})",
                              sizeof(SCOTCH_Num), size, comm.rank()));
  });
}

/// Scotch's objects, freed in the reverse order.
class Context {
 public:
  Context() {
    require(SCOTCH_contextInit(&context_) == 0 &&
            SCOTCH_contextOptionSetNum(&context_, SCOTCH_OPTIONNUMDETERMINISTIC, 1) == 0 &&
            SCOTCH_contextOptionSetNum(&context_, SCOTCH_OPTIONNUMRANDOMFIXEDSEED, 1) == 0);
    SCOTCH_contextRandomReset(&context_);
    // threads would make every run give another partition
    require(SCOTCH_contextThreadSpawn(&context_, 1, nullptr) == 0);
  }
  ~Context() { SCOTCH_contextExit(&context_); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  Context(Context&&) = delete;
  Context& operator=(Context&&) = delete;
  SCOTCH_Context* get() { return &context_; }

 private:
  static void require(bool is_good) {
    if (!is_good)
      throw Error("partition: expected Scotch to make a context, found that it cannot: " + last_complaint());
  }
  SCOTCH_Context context_{};
};

class Graph {
 public:
  explicit Graph(const par::Comm& comm) {
    code_ = comm.in_library([&] { return SCOTCH_dgraphInit(&graph_, comm.handle()); });
  }
  ~Graph() { SCOTCH_dgraphExit(&graph_); }
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;
  Graph(Graph&&) = delete;
  Graph& operator=(Graph&&) = delete;
  SCOTCH_Dgraph* get() { return &graph_; }
  int code() const { return code_; }

 private:
  SCOTCH_Dgraph graph_{};
  int code_ = 0;
};

class Strategy {
 public:
  Strategy() { SCOTCH_stratInit(&strategy_); }
  ~Strategy() { SCOTCH_stratExit(&strategy_); }
  Strategy(const Strategy&) = delete;
  Strategy& operator=(const Strategy&) = delete;
  Strategy(Strategy&&) = delete;
  Strategy& operator=(Strategy&&) = delete;
  SCOTCH_Strat* get() { return &strategy_; }

 private:
  SCOTCH_Strat strategy_{};
};

/// Scotch takes pointers to what it does not change. None may be null, nor equal to another, where other ranks have
/// something: it takes that as a sign that the weights are left out.
class Pointers {
 public:
  std::int64_t* operator()(const std::vector<std::int64_t>& values) {
    return values.empty() ? &nothing_[next_++] : const_cast<std::int64_t*>(values.data());
  }

 private:
  std::array<std::int64_t, 8> nothing_{};
  std::size_t next_ = 0;
};

/// Weights of the vertices for Scotch, in proportion, each at least 1. Scotch 7.0 makes poor parts, up to twice the
/// edge cut, of weights that sum to 2^33 and more. Collective: one reduction.
std::vector<std::int64_t> weights_for_scotch(const par::Comm& comm, const std::vector<std::int64_t>& weight) {
  constexpr std::int64_t most = std::int64_t{1} << 31U;
  std::int64_t unit = 1;
  for (auto total = comm.sum(std::accumulate(weight.begin(), weight.end(), std::int64_t{0})); total > most; total /= 2)
    unit *= 2;
  auto result = weight;
  for (auto& w : result) w = std::max<std::int64_t>(1, (w + unit / 2) / unit);
  return result;
}

}  // namespace

bool has_scotch() { return true; }

std::vector<Rank> scotch_partition(const par::Comm& comm, const DualGraph& graph, Rank n_parts, double tolerance) {
  PAMR_EXPECTS(n_parts >= 1 && graph.n_global_vertices >= n_parts && graph.arc_begin.size() == graph.n_vertices() + 1);
  last_complaint().clear();
  require_integer_size(comm);
  Context context;
  Graph plain(comm), bound(comm);
  require_success(comm, plain.code() + bound.code(), "SCOTCH_dgraphInit");
  Pointers pointer;
  const auto n = static_cast<SCOTCH_Num>(graph.n_vertices());
  const auto n_arcs = static_cast<SCOTCH_Num>(graph.neighbor.size());
  const auto weight = weights_for_scotch(comm, graph.weight);
  const auto build = [&] {
    return SCOTCH_dgraphBuild(plain.get(), 0, n, n, pointer(graph.arc_begin), nullptr, pointer(weight), nullptr, n_arcs,
                              n_arcs, pointer(graph.neighbor), nullptr, pointer(graph.n_faces));
  };
  require_success(comm, comm.in_library(build), "SCOTCH_dgraphBuild");
  require_success(comm, SCOTCH_contextBindDgraph(context.get(), plain.get(), bound.get()), "SCOTCH_contextBindDgraph");
  Strategy strategy;
  require_success(comm,
                  SCOTCH_stratDgraphMapBuild(strategy.get(), SCOTCH_STRATBALANCE, comm.size(), n_parts, tolerance),
                  "SCOTCH_stratDgraphMapBuild");
  std::vector<std::int64_t> part(graph.n_vertices(), 0);
  const auto divide = [&] { return SCOTCH_dgraphPart(bound.get(), n_parts, strategy.get(), pointer(part)); };
  require_success(comm, comm.in_library(divide), "SCOTCH_dgraphPart");

  std::vector<Rank> result;
  result.reserve(part.size());
  par::agree(comm, [&] {
    for (const auto p : part) {
      if (p < 0 || p >= n_parts)
        throw Error(fmt::format("partition: expected parts 0 to {} from Scotch, found {}", n_parts - 1, p));
      result.push_back(static_cast<Rank>(p));
    }
  });
  return result;
}

}  // namespace pamr::balance
