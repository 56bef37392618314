// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/flags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"

namespace pamr::adapt {

namespace {

/// The field's values, which are at least `min` and at most 1. `words`: what they mean. Collective.
template <class Flag>
std::vector<Flag> read_flags(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& name,
                             std::int64_t min, const char* words) {
  std::vector<Flag> flags(at(mesh.n_cells()));
  par::agree(comm, [&] {
    const auto* field = mesh.find_cell_field(name);
    if (field == nullptr)
      throw Error(
          fmt::format("marks: expected a cell field '{}', found none of that name (pamr-mark writes it; --marks FIELD "
                      "names another)",
                      name));
    if (!field->holds_integers() || field->n_components != 1)
      throw Error(fmt::format("marks: expected an integer field of one component, found cell field '{}' of {}", name,
                              field->holds_integers() ? fmt::format("{} components", field->n_components) : "reals"));
    const auto& value = field->integer();
    for (std::size_t c = 0; c < flags.size(); ++c) {
      if (value[c] < min || value[c] > 1)
        throw Error(fmt::format("marks: expected {}, found {} in cell field '{}' at cell {}", words, value[c], name,
                                mesh.cell_global[c]));
      flags[c] = static_cast<Flag>(value[c]);
    }
  });
  return flags;
}

}  // namespace

std::vector<std::uint8_t> flags_from_field(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& name) {
  return read_flags<std::uint8_t>(comm, mesh, name, 0, "0 (keep) or 1 (split)");
}

std::vector<std::int8_t> signed_flags_from_field(const par::Comm& comm, const mesh::DistMesh& mesh,
                                                 const std::string& name) {
  return read_flags<std::int8_t>(comm, mesh, name, -1, "-1 (may be coarsened), 0 (keep) or 1 (split)");
}

std::vector<std::uint8_t> splits_of(std::span<const std::int8_t> flags) {
  std::vector<std::uint8_t> split;
  split.reserve(flags.size());
  for (const auto flag : flags) split.push_back(flag > 0 ? 1 : 0);
  return split;
}

std::vector<std::int8_t> signed_flags(std::span<const std::uint8_t> marks, std::span<const std::uint8_t> may_go) {
  std::vector<std::int8_t> flags;
  flags.reserve(marks.size());
  for (std::size_t c = 0; c < marks.size(); ++c)
    flags.push_back(static_cast<std::int8_t>(marks[c] != 0 ? 1 : may_go[c] != 0 ? -1 : 0));
  return flags;
}

std::vector<std::int8_t> signed_flags(std::span<const std::uint8_t> marks) {
  std::vector<std::int8_t> flags;
  flags.reserve(marks.size());
  for (const auto mark : marks) flags.push_back(mark != 0 ? 1 : 0);
  return flags;
}

bool has_sign(std::span<const std::int8_t> flags, int sign) {
  return std::any_of(flags.begin(), flags.end(), [sign](std::int8_t flag) { return sign * flag > 0; });
}

std::vector<std::int8_t> checked_signs(const par::Comm& comm, const mesh::DistMesh& mesh,
                                       std::span<const std::int8_t> flags, const refine::Options& options) {
  refine::require_sound(options);
  par::agree(comm, [&] {
    if (flags.size() != at(mesh.n_cells()))
      throw Error(fmt::format("adapt: expected one flag for each of the {} cells of rank {}, found {}", mesh.n_cells(),
                              comm.rank(), flags.size()));
    if (has_sign(flags, -1) && options.quality_control != refine::QualityControl::removable)
      throw Error("adapt: expected the quality control 'removable' for coarsening (flags below 0), found another one");
  });
  std::vector<std::int8_t> signs;
  signs.reserve(flags.size());
  for (const auto flag : flags) signs.push_back(static_cast<std::int8_t>((flag > 0 ? 1 : 0) - (flag < 0 ? 1 : 0)));
  return signs;
}

}  // namespace pamr::adapt
