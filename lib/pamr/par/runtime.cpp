// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/runtime.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>

#include "pamr/base/error.hpp"
#include "pamr/base/one_line.hpp"
#include "pamr/par/lone_start.hpp"
#include "pamr/par/mpi_memory.hpp"
#include "pamr/par/parent_job.hpp"
#include "pamr/par/wait_asleep.hpp"

namespace pamr::par {

namespace {

// Exit codes, as of the tools.
constexpr int bad_input = 2, internal = 3;
/// How long a rank that fails waits for the others to do the same, in seconds.
constexpr double grace_period = 3;

/// For the handler of uncaught exceptions; null when MPI does not run.
const Runtime* running = nullptr;

/// One write, which lines of other processes do not cut.
void print_line(const std::string& program, const char* what, const std::string& text) {
  std::fputs((program + ": " + what + ": " + one_line(text) + "\n").c_str(), stderr);
  std::fflush(nullptr);
}
void print_error(const std::string& program, const std::string& text) { print_line(program, "error", text); }

/// MPI's code; an error does not end the process.
int finalize(MPI_Comm& of_end) {
  for (const auto comm : {of_end, MPI_COMM_WORLD}) MPI_Comm_set_errhandler(comm, MPI_ERRORS_RETURN);
  const int freed = MPI_Comm_free(&of_end), ended = MPI_Finalize();
  return freed != MPI_SUCCESS ? freed : ended;
}

struct Failure {
  int code = internal;
  std::string text = "ended without an exception";
};

Failure current_failure() {
  try {
    if (const auto failure = std::current_exception()) std::rethrow_exception(failure);
  } catch (const Error& error) {
    return {bad_input, error.what()};
  } catch (const std::bad_alloc&) {
    return {internal, "out of memory"};
  } catch (const std::exception& failure) {
    return {internal, std::string("uncaught exception: ") + failure.what()};
  } catch (...) {
    return {internal, "uncaught exception of an unknown type"};
  }
  return {};
}

/// Nothing has been unwound: no destructor waits for ranks that never come.
[[noreturn]] void end_uncaught() {
  std::set_terminate(std::abort);  // a failure in here
  const auto failure = current_failure();
  if (running == nullptr) {
    print_error(program_invocation_short_name, failure.text);
    std::_Exit(failure.code);
  }
  const int code = running->end(failure.code, failure.text, grace_period);
  (void)running->settle(code, 1);  // who aborts first takes the others along: not before the report
  running->abort(code);
}

/// Runs when `main` has returned, or exit was called.
void abort_at_exit() {
  std::fflush(nullptr);
  MPI_Abort(MPI_COMM_WORLD, bad_input);
}

}  // namespace

Runtime::Runtime(int& argc, char**& argv) : n_exceptions_(std::uncaught_exceptions()) {
  leave_parent_job();
  // hwloc, which Open MPI asks for the machine's cores, asks an X server for graphics cards; an X server that ends then
  // ends the process.
  setenv("HWLOC_COMPONENTS", "-gl", 0);
  // Errors of these calls end the program: MPI's own error handler is in force until a `Comm` replaces it.
  {
    const LoneStart alone;
    MPI_Init(&argc, &argv);
  }
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  if (!has_mpi_memory(size_)) {
    std::fprintf(stderr, "%s: error: out of memory\n", program_invocation_short_name);
    abort(internal);
  }
  MPI_Comm_dup(MPI_COMM_WORLD, &end_);
  running = this;
  terminate_before_ = std::set_terminate(end_uncaught);
}

Runtime::~Runtime() {
  running = nullptr;
  if (std::get_terminate() == end_uncaught) std::set_terminate(terminate_before_);
  const bool unwinds = std::uncaught_exceptions() > n_exceptions_;
  if (unwinds && size_ > 1 && !settle(bad_input, grace_period)) {
    // Others wait for this rank in a call that it has left, and MPI_Finalize would wait for them.
    print_error(program_invocation_short_name,
                "rank " + std::to_string(rank_) +
                    " is left by an exception, and others go on without it: all are ended when its main has returned");
    std::atexit(abort_at_exit);
    return;
  }
  if (const int failed = finalize(end_); failed != MPI_SUCCESS)
    print_line(
        program(), "warning",
        fmt::format("MPI did not end as it should (its error {}), when all work was done{}", failed, said_behind()));
}

std::string Runtime::program() const {
  return at_failure_.program.empty() ? program_invocation_short_name : at_failure_.program;
}

std::string Runtime::said_behind() const { return at_failure_.said_behind ? at_failure_.said_behind() : std::string(); }

std::optional<Runtime::Outcome> Runtime::settle(int code, double seconds) const {
  // The greatest code first, then the lowest rank, in one number.
  constexpr std::int64_t ranks = std::int64_t{1} << 32U;
  const std::int64_t here = std::int64_t{code} * ranks + (ranks - 1 - rank_);
  std::int64_t greatest = 0;
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallreduce(&here, &greatest, 1, MPI_INT64_T, MPI_MAX, end_, &request);
  if (!wait_asleep(request, seconds)) return std::nullopt;
  return Outcome{static_cast<int>(greatest / ranks), static_cast<Rank>(ranks - 1 - greatest % ranks)};
}

int Runtime::end(int code, const std::string& error, double seconds) const {
  const auto& add = at_failure_;
  if (!error.empty() && add.clean_up) add.clean_up();
  const auto outcome = settle(code, seconds);
  if (!error.empty() && (!outcome || outcome->reporter == rank_)) {
    if (add.before_print) add.before_print();
    print_error(program(), error + (outcome ? "" : fmt::format(" (on rank {})", rank_)) + said_behind());
  }
  if (!outcome) abort(code);
  return outcome->code;
}

void Runtime::abort(int code) const {
  if (at_failure_.before_abort) at_failure_.before_abort();
  std::fflush(nullptr);
  if (size_ > 1) MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);  // alone: without the notice that MPI_Abort prints
}

}  // namespace pamr::par
