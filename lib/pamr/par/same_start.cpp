// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/same_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <system_error>

#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"

namespace pamr::par {

namespace {

/// All that has to be the same, in the order in which differences are reported.
std::vector<std::string> words_of(const Start& start) {
  std::vector<std::string> words{start.version, start.folder};
  words.insert(words.end(), start.arguments.begin(), start.arguments.end());
  return words;
}

std::uint64_t hash_of(const std::vector<std::string>& words) {
  std::uint64_t h = words.size();
  for (const auto& word : words) {
    h = combine(h, word.size());
    for (const char c : word) h = combine(h, static_cast<unsigned char>(c));
  }
  return h;
}

/// Words as they are on the first rank. Collective.
std::vector<std::string> of_first(const Comm& comm, const std::vector<std::string>& words) {
  std::string joined;
  for (const auto& word : words) (joined += word) += '\0';
  joined = comm.broadcast(std::move(joined));
  std::vector<std::string> result;
  for (std::size_t begin = 0, end = 0; (end = joined.find('\0', begin)) != std::string::npos; begin = end + 1)
    result.push_back(joined.substr(begin, end - begin));
  return result;
}

std::string shown(const std::vector<std::string>& words, std::size_t i) {
  return i < words.size() ? fmt::format("'{}'", words[i]) : "none";
}

}  // namespace

Start start_of(std::string version, int argc, char** argv) {
  Start start{std::move(version), {}, {}};
  for (int i = 1; i < argc; ++i) start.arguments.emplace_back(argv[i]);
  std::error_code failed;
  const auto folder = std::filesystem::current_path(failed);
  if (!failed) start.folder = folder.string();
  return start;
}

void require_same_start(const Comm& comm, const Start& start) {
  const auto here = words_of(start);
  const auto hash = std::bit_cast<std::int64_t>(hash_of(here));
  if (comm.min(hash) == comm.max(hash)) return;
  const auto first = of_first(comm, here);
  agree(comm, [&] {
    for (std::size_t i = 0; i < std::max(here.size(), first.size()); ++i) {
      if (i < here.size() && i < first.size() && here[i] == first[i]) continue;
      const auto what = i == 0   ? std::string("the same version of the program")
                        : i == 1 ? std::string("the same working folder")
                                 : fmt::format("the same arguments (number {})", i - 1);
      throw Error(fmt::format("expected {} on all ranks, found {} on rank 0 and {} on rank {}", what, shown(first, i),
                              shown(here, i), comm.rank()));
    }
  });
}

}  // namespace pamr::par
