// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mpi.h>

#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "pamr/base/types.hpp"

namespace pamr::par {

/// MPI from its start to its end; one object per process, made in `main`. An application that has initialized MPI
/// itself makes a `Comm` from its communicator and needs no `Runtime`.
///
/// While it lives, an exception that nobody catches ends all ranks with one line on standard error, `<program>: error:
/// <what>`, and exit code 2 for `pamr::Error`, 3 for others: by a handler of std::terminate, to which a program may add
/// (`on_failure`) and which it may replace. Where an exception leaves the object on some ranks alone (its handler is further out), those ranks say so,
/// go on to their handlers, and end all ranks with code 2 when their `main` returns; MPI_Finalize would wait for ever.
/// An error of MPI_Finalize is a warning: it changes nothing that the program has done.
class Runtime {
 public:
  /// Initializes MPI. Collective over all processes. A program that a rank of another MPI job has started (a solver
  /// that calls a tool) runs alone (`leave_parent_job`). Ends all with exit code 3 where one has no memory left for
  /// MPI.
  Runtime(int& argc, char**& argv);
  /// Finalizes MPI. Collective, unless an exception ends it.
  ~Runtime();
  Runtime(const Runtime&) = delete;
  Runtime& operator=(const Runtime&) = delete;
  Runtime(Runtime&&) = delete;
  Runtime& operator=(Runtime&&) = delete;

  MPI_Comm world() const { return MPI_COMM_WORLD; }
  Rank rank() const { return rank_; }
  Rank size() const { return size_; }

  /// How all ranks ended: the greatest exit code, and the lowest of the ranks that have it.
  struct Outcome {
    int code = 0;
    Rank reporter = 0;
  };
  /// The common outcome of a program whose part on this rank ended with `code` (>= 0); nothing when some rank did not
  /// come here within `seconds` (it waits in a collective that this rank has left, say). Collective unless it fails,
  /// and called equally often on all ranks. Runs beside whatever else is under way: it has a communicator of its own.
  std::optional<Outcome> settle(int code, double seconds) const;

  /// What a program adds to its end with an error, on each rank that has one. None may throw; all may be null.
  struct AtFailure {
    std::string program;                       ///< in front of the error; empty: the name of the executable
    std::function<std::string()> said_behind;  ///< appended to the error: what is complete all the same
    std::function<void()> clean_up;            ///< before anything else: nothing is unwound
    std::function<void()> before_print;        ///< makes room for the error
    std::function<void()> before_abort;        ///< before this process ends the others
  };
  /// Local.
  void on_failure(AtFailure what) { at_failure_ = std::move(what); }

  /// Ends this rank's part of a program, with an error unless that is empty, which is printed once if all ranks come
  /// here within `seconds`; else by this rank, and all are ended. Returns the common exit code. Collective as `settle`.
  int end(int code, const std::string& error, double seconds) const;

  /// Ends all ranks at once with this exit code.
  [[noreturn]] void abort(int code) const;

 private:
  std::string program() const;
  std::string said_behind() const;

  MPI_Comm end_ = MPI_COMM_NULL;
  int n_exceptions_;  ///< under way when it was made
  std::terminate_handler terminate_before_ = nullptr;
  AtFailure at_failure_;
  Rank rank_ = 0;
  Rank size_ = 1;
};

}  // namespace pamr::par
