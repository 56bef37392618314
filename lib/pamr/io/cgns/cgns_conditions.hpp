// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pamr/io/cgns/cgns_nodes.hpp"
#include "pamr/io/elements/whole_mesh.hpp"

namespace pamr::io::cgns {

/// Where the elements of one dimension, by their numbers in the file, are in a mesh.
class Elements {
 public:
  /// The first of those that an element is, or was cut into, and their number.
  struct Pieces {
    std::size_t first = 0, n = 0;
  };
  /// Elements with numbers in a row, of as many pieces each, whose pieces are in a row.
  struct Run {
    std::int64_t number = 0, n = 0;
    Pieces pieces;  ///< of the first element

    std::int64_t end() const { return number + n; }
    Pieces of(std::int64_t element) const {
      return {pieces.first + static_cast<std::size_t>(element - number) * pieces.n, pieces.n};
    }
  };

  void add(std::int64_t number, Pieces pieces);
  /// To be called before what follows. Throws `Error` where two elements have the same number.
  void put_in_order();
  /// No pieces where there is no such element.
  Pieces find(std::int64_t number) const;
  /// The first run that ends after this number.
  std::vector<Run>::const_iterator run_after(std::int64_t number) const;
  /// Numbers in ascending order.
  const std::vector<Run>& runs() const { return runs_; }
  std::int64_t size() const;
  /// Whether the pieces were in order before `put_in_order`.
  bool were_in_order() const { return were_in_order_; }

 private:
  std::vector<Run> runs_;
  bool were_in_order_ = true;
};

/// Cells that a section has or a condition names.
struct CellGroup {
  std::string name;
  std::vector<std::string> members;  ///< the groups that it stands for where these are several
};

/// The elements of a zone and the groups that they are in.
struct ZoneElements {
  Elements cells, triangles;
  std::vector<std::int32_t> group_of_cell;  ///< its place in `group`
  std::vector<CellGroup> group;
  std::map<std::string, std::int32_t> group_of_name;
  bool has_named_cells = false;  ///< by conditions
  std::map<std::string, std::int64_t> tag_of_name;

  /// The place of the group of this name, a new one for a new name.
  std::int32_t group_of(const CellGroup& named);
  /// The number of the patch of this name, a new one for a new name.
  std::int64_t tag_of(const std::string& name, WholeMesh& mesh);
};

/// Boundary conditions of a zone give triangles their patch and cells their region: first those on elements, then those
/// on vertices, which have the triangles whose three corners they name. A condition of a family without a type that
/// names several groups, as Gmsh has them, makes a patch or region `A+B` that is in all of these. Patches of sections
/// of which no triangle is left are no patches. Local. Throws `Error` for damaged nodes. Source: CGNS SIDS, "Boundary
/// Conditions".
void read_conditions(const Tree& tree, const std::string& base, const std::string& zone, ZoneElements& elements,
                     WholeMesh& mesh);

}  // namespace pamr::io::cgns
