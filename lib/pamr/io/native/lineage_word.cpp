// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/lineage_word.hpp"

#include "pamr/base/contract.hpp"
#include "pamr/mesh/families.hpp"

namespace pamr::io {

namespace {

using mesh::FamilyKind;

/// Format 1: kind in bits 0-1, template index 2-4, child 5-6, broken 7, level 8-15.
std::optional<mesh::Lineage> lineage_of_first_format(std::uint64_t word) {
  const auto bits = [word](unsigned from, unsigned n) { return static_cast<int>(word >> from & ((1U << n) - 1)); };
  const auto kind = static_cast<FamilyKind>(bits(0, 2));
  const int index = bits(2, 3), child = bits(5, 2), level = bits(8, 8);
  const bool is_broken = bits(7, 1) != 0;
  const bool is_known = kind == FamilyKind::regular ? index == 0 && child == 0 && !is_broken
                        : kind == FamilyKind::edge  ? index < 6 && child < 2
                        : kind == FamilyKind::face  ? index < 4
                                                    : false;
  if (word > 0xffffU || !is_known) return std::nullopt;
  const mesh::Lineage lineage(kind, index, child, level);
  return is_broken ? lineage.broken() : lineage;
}

}  // namespace

std::optional<mesh::Lineage> lineage_of_word(int format, std::uint64_t word) {
  if (format == 1) return lineage_of_first_format(word);
  const mesh::Lineage lineage(word);
  if (!mesh::is_well_formed(lineage)) return std::nullopt;
  return lineage;
}

bool has_word(int format, mesh::Lineage lineage) { return format > 1 || lineage.kind() != FamilyKind::other; }

std::uint64_t word_of_lineage(int format, mesh::Lineage lineage) {
  PAMR_EXPECTS(has_word(format, lineage));
  if (format > 1) return lineage.bits();
  const auto unsigned_of = [](int value) { return static_cast<unsigned>(value); };
  return static_cast<unsigned>(lineage.kind()) | unsigned_of(lineage.index()) << 2U |
         unsigned_of(lineage.child()) << 5U | (lineage.is_broken() ? 0x80U : 0U) | unsigned_of(lineage.level()) << 8U;
}

}  // namespace pamr::io
