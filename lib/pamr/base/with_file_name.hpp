// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <filesystem>

#include "pamr/base/error.hpp"

namespace pamr {

/// What `work()` returns; an `Error` that it throws gets the name of the file in front, where what is wrong was found
/// in values that know nothing of the file they came from. `work` may communicate, because an `Error` reaches every
/// rank.
template <class Work>
auto with_file_name(const std::filesystem::path& file, Work&& work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Error(fmt::format("file '{}': {}", file.string(), error.what()));
  }
}

}  // namespace pamr
