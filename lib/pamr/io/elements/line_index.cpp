// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/line_index.hpp"

#include <algorithm>

namespace pamr::io {

namespace {

std::int64_t count_lines(std::string_view text) { return std::count(text.begin(), text.end(), '\n'); }

}  // namespace

LineIndex::LineIndex(const par::Comm& comm, std::string_view bytes, std::size_t chunk) : bytes_(bytes), chunk_(chunk) {
  const auto n_chunks = (bytes.size() + chunk - 1) / chunk;
  before_.assign(n_chunks + 1, 0);
  const auto own = par::block_range(static_cast<GlobalId>(n_chunks), comm.rank(), comm.size());
  for (auto k = own.begin; k < own.end; ++k)
    before_[static_cast<std::size_t>(k) + 1] = count_lines(bytes.substr(static_cast<std::size_t>(k) * chunk, chunk));
  comm.sum_in_place(before_);
  for (std::size_t k = 0; k < n_chunks; ++k) before_[k + 1] += before_[k];
}

std::size_t LineIndex::after_lines(std::size_t from, std::int64_t n) const {
  if (from >= bytes_.size()) return std::string_view::npos;
  const auto first = from / chunk_;
  const auto target = before_[first] + count_lines(bytes_.substr(first * chunk_, from - first * chunk_)) + n;
  const auto beyond = std::lower_bound(before_.begin(), before_.end(), target);  // the chunk before it holds the target
  if (beyond == before_.end()) return std::string_view::npos;
  const auto k = static_cast<std::size_t>(beyond - before_.begin()) - 1;
  auto at = k * chunk_;
  for (auto left = target - before_[k]; left > 0; --left) at = bytes_.find('\n', at) + 1;
  return at;
}

}  // namespace pamr::io
