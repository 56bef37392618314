// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/flags.hpp"

#include <fmt/format.h>

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
  return read_flags<std::int8_t>(comm, mesh, name, -1, "-1 (may go), 0 (keep) or 1 (split)");
}

std::vector<std::uint8_t> splits_of(std::span<const std::int8_t> flags) {
  std::vector<std::uint8_t> split;
  split.reserve(flags.size());
  for (const auto flag : flags) split.push_back(flag > 0 ? 1 : 0);
  return split;
}

void require_flags(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags) {
  par::agree(comm, [&] {
    if (flags.size() != at(mesh.n_cells()))
      throw Error(fmt::format("refine: expected one flag for each of the {} cells of rank {}, found {}", mesh.n_cells(),
                              comm.rank(), flags.size()));
  });
}

}  // namespace pamr::adapt
