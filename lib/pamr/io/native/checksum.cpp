// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/checksum.hpp"

#include <algorithm>

namespace pamr::io {

namespace {

std::uint64_t hash_of_row(GlobalId row, std::span<const std::uint64_t> words) {
  auto hash = static_cast<std::uint64_t>(row);
  for (const auto word : words) hash = combine(hash, word);
  return mix(hash);
}

std::uint64_t chain(GlobalId n_rows, std::span<const std::uint64_t> blocks) {
  auto hash = static_cast<std::uint64_t>(n_rows);
  for (const auto block : blocks) hash = combine(hash, block);
  return hash;
}

}  // namespace

void Checksum::add(GlobalId first_row, std::size_t width, std::span<const std::uint64_t> words) {
  const auto n = static_cast<GlobalId>(words.size() / width);
  for (GlobalId i = 0; i < n;) {
    const auto block = static_cast<std::size_t>((first_row + i) / block_rows);
    const auto end = std::min(n, (static_cast<GlobalId>(block) + 1) * block_rows - first_row);
    auto sum = block_[block];
    for (; i < end; ++i) sum += hash_of_row(first_row + i, words.subspan(static_cast<std::size_t>(i) * width, width));
    block_[block] = sum;
  }
}

std::uint64_t Checksum::result(const par::Comm& comm) const { return results(comm, {this, 1}).front(); }

std::vector<std::uint64_t> Checksum::results(const par::Comm& comm, std::span<const Checksum> checksums) {
  // The two halves of a word are added apart, so that the signed sums of the communicator cannot overflow.
  constexpr std::uint64_t low_half = 0xffffffffU;
  std::vector<std::int64_t> halves;
  for (const auto& checksum : checksums)
    for (const auto sum : checksum.block_) {
      halves.push_back(static_cast<std::int64_t>(sum & low_half));
      halves.push_back(static_cast<std::int64_t>(sum >> 32U));
    }
  comm.sum_in_place(halves);
  std::vector<std::uint64_t> result;
  std::size_t at = 0;
  for (const auto& checksum : checksums) {
    std::vector<std::uint64_t> blocks(checksum.block_.size());
    for (auto& block : blocks) {
      block = static_cast<std::uint64_t>(halves[at]) + (static_cast<std::uint64_t>(halves[at + 1]) << 32U);
      at += 2;
    }
    result.push_back(chain(checksum.n_rows_, blocks));
  }
  return result;
}

std::uint64_t checksum_of(std::span<const std::string> texts) {
  std::vector<std::uint64_t> block((texts.size() + Checksum::block_rows - 1) / Checksum::block_rows, 0);
  std::vector<std::uint64_t> words;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    words.assign(1, texts[i].size());
    for (const auto c : texts[i]) words.push_back(static_cast<unsigned char>(c));
    block[i / Checksum::block_rows] += hash_of_row(static_cast<GlobalId>(i), words);
  }
  return chain(static_cast<GlobalId>(texts.size()), block);
}

}  // namespace pamr::io
