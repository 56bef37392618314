// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "mutate.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/hash.hpp"
#include "seeds.hpp"
#include "solvers/dsmc/state/checkpoint.hpp"
#include "support/dice.hpp"
#include "support/meshes.hpp"
#include "support/strange_values.hpp"
#include "unit/dsmc/stream_case.hpp"

namespace pamr::fuzz {

namespace {

using nlohmann::json;

constexpr std::size_t word_bytes = 8, head_bytes = 4 * word_bytes;

std::uint64_t word_at(const std::string& bytes, std::size_t at) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes.data() + at, word_bytes);
  return word;
}

void set_word(std::string& bytes, std::size_t at, std::uint64_t word) {
  std::memcpy(bytes.data() + at, &word, word_bytes);
}

/// Sets the checksums of the tables that the header lists, as far as they are there.
void set_checksums(json& header, const std::string& tables) {
  if (!header.is_object() || !header.contains("sections") || !header["sections"].is_array()) return;
  for (auto& section : header["sections"]) {
    const auto number = [&](const char* key) -> std::uint64_t {
      const bool is_there = section.is_object() && section.contains(key) && section[key].is_number_unsigned();
      return is_there ? section[key].get<std::uint64_t>() : ~std::uint64_t{0};
    };
    const auto rows = number("rows"), width = number("width"), offset = number("offset"), size = tables.size();
    if (rows > size || width > size || offset > size || word_bytes * rows * width > size - offset) continue;
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < rows * width; ++i) sum += combine(i, word_at(tables, offset + word_bytes * i));
    section["checksum"] = sum;
  }
}

dsmc::Case the_case() { return dsmc::read_case(test::stream_case, "case.toml"); }

const mesh::DistMesh& the_mesh(const par::Comm& comm) {
  static const auto mesh = assemble::assemble(comm, test::random_mesh(comm, 5, 1));
  return mesh;
}

}  // namespace

// of a short run with streams and walls
int n_seed_files() { return 1; }

/// 1 in 4 is damaged as any file is; the others have wrong contents with right sums.
std::string damaged(const std::string& good, std::uint64_t seed) {
  test::Dice dice(seed);
  if (dice.below(4) == 0) return mutate(good, seed);
  const auto text_bytes = word_at(good, 2 * word_bytes);
  auto header = json::parse(good.substr(head_bytes, text_bytes));
  auto tables = good.substr(head_bytes + text_bytes);
  for (auto n = 1 + dice.below(3); n > 0; --n)
    if (dice.below(2) == 0 && header.is_structured() && !header.empty())
      test::damage_json(header, dice);
    else
      set_word(tables, word_bytes * dice.below(tables.size() / word_bytes), test::strange_word(dice));
  set_checksums(header, tables);
  auto text = header.dump();
  text.resize((text.size() + word_bytes - 1) / word_bytes * word_bytes, ' ');
  std::uint64_t hash = 0;
  for (const char c : text) hash = combine(hash, static_cast<unsigned char>(c));
  auto head = good.substr(0, head_bytes);
  set_word(head, 2 * word_bytes, text.size());
  set_word(head, 3 * word_bytes, hash);
  return head + text + tables;
}

/// Goes on from it for two steps.
void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  static const auto problem = the_case();
  const auto computation = test::unfilled(comm, problem, the_mesh(comm));
  computation->restart(file.string());
  for (int step = 0; step < 2; ++step) computation->step();
  const auto& p = computation->flow().particles;
  for (const auto* values : {&p.x, &p.y, &p.z, &p.u, &p.v, &p.w, &p.rotation})
    for (const double value : *values)
      if (!std::isfinite(value)) throw std::logic_error("accepted, but not finite");
}

std::string seed_name(int /*i*/) { return "seed.ck"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  const auto problem = the_case();
  const auto computation = test::filled(comm, problem, the_mesh(comm));
  for (int step = 0; step < 45; ++step) computation->step();
  dsmc::write_checkpoint(comm, (folder / seed_name(0)).string(), computation->snapshot());
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
