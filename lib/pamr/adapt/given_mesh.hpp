// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <variant>

#include "pamr/base/memory.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::adapt {

/// A mesh that something new is made of: one that is handed over (`std::move(mesh)`), whose arrays are freed or changed
/// on the way, or one that is lent, which is only read and has to live as long as this.
class GivenMesh {
 public:
  GivenMesh(mesh::DistMesh&& mesh) : mesh_(std::move(mesh)) {}
  GivenMesh(const mesh::DistMesh& mesh) : mesh_(&mesh) {}

  bool is_lent() const { return std::holds_alternative<const mesh::DistMesh*>(mesh_); }
  const mesh::DistMesh& get() const {
    return is_lent() ? *std::get<const mesh::DistMesh*>(mesh_) : std::get<mesh::DistMesh>(mesh_);
  }
  /// The mesh itself; of one that is lent a copy.
  mesh::DistMesh take() && {
    return is_lent() ? *std::get<const mesh::DistMesh*>(mesh_) : std::get<mesh::DistMesh>(std::move(mesh_));
  }
  /// Frees the links from cell to cell of a mesh that is not lent, when they are of no use any more.
  void drop_links() {
    if (!is_lent()) free_array(std::get<mesh::DistMesh>(mesh_).cell_to_cell);
  }
  /// Frees the numbers of its cells likewise, where those of the input take their place.
  void drop_replaced_numbers() {
    if (!is_lent() && !get().cell_origin.empty()) free_array(std::get<mesh::DistMesh>(mesh_).cell_global);
  }
  /// Frees the values of one of its fields likewise.
  void drop_values(const mesh::Field& field) {
    if (is_lent()) return;
    auto& mesh = std::get<mesh::DistMesh>(mesh_);
    for (auto* fields : {&mesh.node_fields, &mesh.cell_fields})
      for (auto& one : *fields)
        if (&one == &field) std::visit([](auto& values) { free_array(values); }, one.value);
  }

 private:
  std::variant<mesh::DistMesh, const mesh::DistMesh*> mesh_;
};

}  // namespace pamr::adapt
