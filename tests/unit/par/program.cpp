// SPDX-License-Identifier: GPL-3.0-or-later
/// A user's program that fails as told, for the test of how programs end: `program HOW`.
#include <cstdio>
#include <new>
#include <stdexcept>
#include <string>

#include "pamr/base/error.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/runtime.hpp"

namespace {

using pamr::Error;
using pamr::par::Comm;

void fail(const std::string& how, const Comm& comm) {
  const bool is_last = comm.rank() == comm.size() - 1;
  if (how == "error") pamr::par::agree(comm, [] { throw Error("file 'cube.hdf': expected a file, found none"); });
  if (how == "error-on-one" && is_last) throw Error("cell 7: expected a cell");
  if (how == "memory-on-one" && is_last) throw std::bad_alloc();
  if (how == "other-error") throw std::out_of_range("slot 12 of 4");
  comm.barrier();
}

void work(int argc, char** argv, const std::string& how) {
  const pamr::par::Runtime runtime(argc, argv);
  const Comm comm(runtime.world());
  fail(how, comm);
  comm.barrier();
}

}  // namespace

int main(int argc, char** argv) {
  const std::string how = argc > 1 ? argv[1] : "";
  const auto caught = how.rfind("caught-", 0) == 0;
  if (!caught) {
    work(argc, argv, how);
    return 0;
  }
  try {
    work(argc, argv, how.substr(7));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "the program says: %s\n", error.what());
    return 5;
  }
  return 0;
}
