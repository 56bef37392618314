// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/require_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/listed.hpp"

namespace pamr::mesh {

namespace {

std::string shown(FieldValues values, int n_components) {
  const auto* kind = values == FieldValues::real ? "real " : values == FieldValues::integer ? "integer " : "";
  return fmt::format("{} {}component{}", n_components, kind, n_components == 1 ? "" : "s");
}

std::string begin_of_message(const WantedField& wanted) {
  return wanted.used_for.empty() ? std::string() : fmt::format("{}: ", wanted.used_for);
}

const Field& find(const std::vector<Field>& fields, const WantedField& wanted, std::string_view place) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == wanted.name; });
  if (found == fields.end())
    throw Error(fmt::format("{}expected a {} field \"{}\", found none of that name (the mesh has: {})",
                            begin_of_message(wanted), place, wanted.name, names_of(fields)));
  return require_field(*found, wanted, place);
}

/// What makes it another field; empty if nothing does.
std::string difference(const DistMesh& mesh, const CellField& field, const OwnField& own) {
  if (field.name == region_field) return "the regions of the mesh";
  if (field.n_components != 1) return fmt::format("{} components", field.n_components);
  if (!field.holds_integers()) return "reals";
  if (own.type && field.storage != *own.type) return "integers of another type";
  const auto& values = field.integer();
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i] < own.low || values[i] > own.high)
      return fmt::format("{} in cell {}", values[i], mesh.cell_global[i]);
  return {};
}

}  // namespace

const Field& require_field(const Field& field, const WantedField& wanted, std::string_view place) {
  const auto held = field.holds_integers() ? FieldValues::integer : FieldValues::real;
  if (field.n_components == wanted.n_components && (wanted.values == FieldValues::any || wanted.values == held))
    return field;
  throw Error(fmt::format("{}{} field \"{}\": expected {}, found {}", begin_of_message(wanted), place, field.name,
                          shown(wanted.values, wanted.n_components), shown(held, field.n_components)));
}

const CellField& require_cell_field(const DistMesh& mesh, const WantedField& wanted) {
  return find(mesh.cell_fields, wanted, "cell");
}

const NodeField& require_node_field(const DistMesh& mesh, const WantedField& wanted) {
  return find(mesh.node_fields, wanted, "node");
}

std::string names_of(const std::vector<Field>& fields) {
  return fields.empty() ? "none" : listed(fields, {.most = all_items}, &Field::name);
}

void require_replaceable(const par::Comm& comm, const DistMesh& mesh, const OwnField& own) {
  const auto* field = mesh.find_cell_field(own.name);
  par::agree(comm, [&] {
    if (field == nullptr) return;
    if (const auto found = difference(mesh, *field, own); !found.empty())
      throw Error(fmt::format("cell field '{}', which {} would replace: expected integers from {} to {}, found {}",
                              own.name, own.holds, own.low, own.high, found));
  });
}

void put_field(std::vector<Field>& fields, Field field) {
  const auto old = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == field.name; });
  if (old == fields.end())
    fields.push_back(std::move(field));
  else
    *old = std::move(field);
}

void remove_field(std::vector<Field>& fields, std::string_view name) {
  std::erase_if(fields, [&](const Field& field) { return field.name == name; });
}

}  // namespace pamr::mesh
