// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

enum class FieldValues { any, real, integer };

/// A field that a stage needs: its name, and what it must hold.
struct WantedField {
  std::string_view name;
  FieldValues values = FieldValues::any;
  int n_components = 1;
  std::string_view used_for = {};  ///< begins the message of the error, as "marks: "; empty: nothing does
};

/// The cell field that is wanted. Throws `Error` when the mesh has none of that name (then the message lists those that
/// it has), or one of other values or of another number of components. Local; the same outcome on every rank.
///
///   const auto& marks = mesh::require_cell_field(mesh, {.name = "refine", .values = FieldValues::integer,
///                                                    .used_for = "marks"}).integer();
const CellField& require_cell_field(const DistMesh& mesh, const WantedField& wanted);
/// The same for a field on nodes.
const NodeField& require_node_field(const DistMesh& mesh, const WantedField& wanted);
/// The field itself when it is as wanted; throws as above. `place` is "cell" or "node".
const Field& require_field(const Field& field, const WantedField& wanted, std::string_view place);

/// Names of fields for messages: "a, b, c", or "none".
std::string names_of(const std::vector<Field>& fields);

/// An integer cell field of one component that a stage writes in place of its older one. Users name some of them, and
/// may have data of that name.
struct OwnField {
  std::string name;
  std::string holds;                     ///< for messages: "marks"
  std::int64_t low = 0, high = 0;        ///< of its values
  std::optional<StorageType> type = {};  ///< where the stage knows its own by it
};

/// Throws the same `Error` on every rank if the mesh has a cell field of that name which cannot be an older one of the
/// stage: reals, several components, another type, values below `low` or above `high`, or the regions. Collective: one
/// agreement; O(cells) of each rank.
void require_replaceable(const par::Comm& comm, const DistMesh& mesh, const OwnField& own);

/// Puts a field in place of the one of its name, or behind the others when there is none.
void put_field(std::vector<Field>& fields, Field field);
/// Removes the field of that name when there is one.
void remove_field(std::vector<Field>& fields, std::string_view name);

}  // namespace pamr::mesh
