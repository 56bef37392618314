// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/version_text.hpp"

#include <fmt/format.h>

#include <string_view>

#include "pamr/base/version.hpp"
#include "pamr/io/native/hdf5_version.hpp"
#include "pamr/par/mpi_version.hpp"
#include "pamr_commit.hpp"

namespace pamr::cli {

std::string version_text(const std::string& tool) {
  constexpr std::string_view commit = PAMR_COMMIT, scotch = PAMR_SCOTCH_VERSION, left_out = PAMR_LEFT_OUT;
  return fmt::format("{} {}{}\n{}, HDF5 {}, CGAL {}{}{}", tool, version(),
                     commit.empty() ? "" : fmt::format(" (commit {})", commit), par::mpi_version(), io::hdf5_version(),
                     PAMR_CGAL_VERSION, scotch.empty() ? "" : fmt::format(", Scotch {} (64-bit integers)", scotch),
                     left_out.empty() ? "" : fmt::format("\nleft out of this build: {}", left_out));
}

std::string commit_of_sources() { return PAMR_COMMIT; }

}  // namespace pamr::cli
