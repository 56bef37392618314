// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

/// Data of a solver that belongs to cells and is no field: particles, histories, unknowns, as many in each cell as it
/// likes. A refined mesh names the cell that each of its cells comes from (field `parent`); here that cell's data is
/// fetched from wherever it is kept.
///
///     const auto numbers = mesh.cell_global;             // kept: refine() takes the mesh over
///     adapt::CellRows<Particle> particles = ...;         // of those cells
///     auto [fine, report] = adapt::refine(comm, std::move(mesh), flags);
///     const auto of_parent = adapt::data_of_parents(comm, n_cells_before, numbers, particles, fine);
///
/// Cell fields need none of this: they are in the refined mesh already, a child with its parent's value and, where a
/// closure family was undone, with the mean of its members weighted by volume, so that integrals are kept.
namespace pamr::adapt {

/// Rows of different lengths: that of cell i is `value[offset[i] .. offset[i+1])`.
template <class T>
struct CellRows {
  std::vector<std::size_t> offset{0};  ///< n + 1
  std::vector<T> value;

  std::span<const T> row(Exact<std::size_t> i) const {
    return std::span<const T>(value).subspan(offset[i], offset[i + 1] - offset[i]);
  }
};

namespace detail {
/// Rows of items of `item_bytes` each; offsets count items. Only references.
struct ByteRows {
  std::span<const std::size_t> offset;
  std::span<const std::byte> value;
  std::size_t item_bytes = 1;
};
template <class T>
ByteRows bytes_of(const CellRows<T>& rows) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {rows.offset, std::as_bytes(std::span(rows.value)), sizeof(T)};
}
/// The same for items of a size that shows when the program runs.
CellRows<std::byte> fetch_cell_rows(const par::Comm& comm, IdRange cells, std::span<const GlobalId> held,
                                    const ByteRows& rows, std::span<const GlobalId> wanted);
/// Values of the field `parent`. Throws `Error` where the mesh has none. Collective.
std::vector<GlobalId> parents_of(const par::Comm& comm, const mesh::DistMesh& fine);
}  // namespace detail

/// The rows of the cells `wanted`, in this order, which may name a cell several times.
/// - `cells`: all cells by number; `held`: those whose rows this rank gives, each on one rank.
/// - `rows`: one for each cell of `held`; T can be copied byte by byte.
/// Collective: seven sparse exchanges. Throws `Error` on every rank for a cell that nobody holds or whose number is out
/// of range, and for lists of different lengths.
template <class T>
CellRows<T> fetch_cell_rows(const par::Comm& comm, IdRange cells, std::span<const GlobalId> held,
                            const CellRows<T>& rows, std::span<const GlobalId> wanted) {
  const auto fetched = detail::fetch_cell_rows(comm, cells, held, detail::bytes_of(rows), wanted);
  CellRows<T> result{fetched.offset, std::vector<T>(fetched.value.size() / sizeof(T))};
  if (!result.value.empty()) std::memcpy(result.value.data(), fetched.value.data(), fetched.value.size());
  return result;
}

/// For each cell of the refined mesh the row of the cell that it comes from. `before`: the cells of the mesh before, of
/// which this rank holds `held`, with `rows`; `fine` has the field `parent`. Collective; as `fetch_cell_rows`.
template <class T>
CellRows<T> data_of_parents(const par::Comm& comm, IdRange before, std::span<const GlobalId> held,
                            const CellRows<T>& rows, const mesh::DistMesh& fine) {
  return fetch_cell_rows(comm, before, held, rows, detail::parents_of(comm, fine));
}

}  // namespace pamr::adapt
