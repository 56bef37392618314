// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/view_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "report/pack.hpp"

namespace pamr::report {

namespace {

using nlohmann::json;

constexpr double largest_part = (1 << 24) - 1;
/// Level, mean ratio and closure are wanted before fields of nodes.
constexpr std::size_t n_first_columns = 3;

std::array<double, 3> coordinates(geometry::Vec3 p) { return {p.x, p.y, p.z}; }

template <std::size_t N>
std::string packed_rows(const std::vector<std::array<std::int64_t, N>>& rows) {
  std::vector<std::int64_t> flat;
  flat.reserve(N * rows.size());
  for (const auto& row : rows) flat.insert(flat.end(), row.begin(), row.end());
  return pack_integers(flat);
}

json positions(const check::MeshView& view) {
  json axes = json::array();
  for (std::size_t d = 0; d < 3; ++d) {
    const double side = view.box.high[d] - view.box.low[d];
    std::vector<std::int64_t> part;
    part.reserve(view.nodes.position.size());
    for (const auto& p : view.nodes.position)
      part.push_back(side > 0 ? std::llround((coordinates(p)[d] - view.box.low[d]) / side * largest_part) : 0);
    axes.push_back(pack_integers(part));
  }
  return axes;
}

json packed_column(const check::ViewColumn& column) {
  json result{{"name", column.name}, {"unit", column.unit}, {"integer", column.is_integer}};
  if (!column.is_integer) {
    result["data"] = pack_reals(column.value);
    return result;
  }
  std::vector<std::int64_t> integers;
  integers.reserve(column.value.size());
  for (const auto value : column.value) integers.push_back(std::llround(value));
  result["data"] = pack_integers(integers);
  return result;
}

std::size_t packed_bytes(const json& part) {
  if (part.is_string()) return part.get_ref<const std::string&>().size();
  std::size_t sum = 0;
  for (const auto& item : part)
    if (item.is_structured() || item.is_string()) sum += packed_bytes(item);
  return sum;
}

/// The columns of one kind of elements, one after the other as long as there is room.
class Columns {
 public:
  Columns(json& view, std::size_t limit) : view_(&view), limit_(limit), used_(packed_bytes(view)) {}

  void add(const char* elements, const check::ViewColumn& column) {
    auto entry = packed_column(column);
    const auto size = packed_bytes(entry);
    if (used_ + size > limit_) {
      auto& left_out = (*view_)["left_out"];
      if (std::find(left_out.begin(), left_out.end(), column.name) == left_out.end()) left_out.push_back(column.name);
      return;
    }
    used_ += size;
    (*view_)[elements]["columns"].push_back(std::move(entry));
  }

  void add(const char* elements, const std::vector<check::ViewColumn>& columns, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < std::min(end, columns.size()); ++i) add(elements, columns[i]);
  }

 private:
  json* view_;
  std::size_t limit_, used_;
};

}  // namespace

json view_json(const check::MeshView& view, std::size_t limit) {
  json result{{"unit", view.length_unit},
              {"n_nodes", view.nodes.number.size()},
              {"n_cells", view.cells.number.size()},
              {"n_faces", view.faces.cell.size()},
              {"box", {coordinates(view.box.low), coordinates(view.box.high)}},
              {"all_cells", view.has_all_cells},
              {"window", view.window},
              {"merged", view.nodes_are_merged},
              {"left_out", json::array()},
              {"patches", json::array()},
              {"worst", json::array()}};
  for (std::size_t p = 0; p < view.patches.size(); ++p)
    result["patches"].push_back(
        {{"name", view.patches[p].name}, {"kind", view.patches[p].kind}, {"surface", view.surface_of_patch[p]}});
  for (const auto& worst : view.worst) result["worst"].push_back(worst.cell);
  result["nodes"] = {
      {"number", pack_integers(view.nodes.number)}, {"position", positions(view)}, {"columns", json::array()}};
  result["cells"] = {
      {"number", pack_integers(view.cells.number)}, {"node", packed_rows(view.cells.node)}, {"columns", json::array()}};
  result["faces"] = {{"cell", pack_integers(view.faces.cell)},
                     {"node", packed_rows(view.faces.node)},
                     {"patch", pack_integers(view.faces.patch)},
                     {"columns", json::array()}};
  Columns columns(result, limit);
  columns.add("faces", view.faces.columns, 0, n_first_columns);
  columns.add("cells", view.cells.columns, 0, n_first_columns);
  columns.add("nodes", view.nodes.columns, 0, view.nodes.columns.size());
  columns.add("faces", view.faces.columns, n_first_columns, view.faces.columns.size());
  columns.add("cells", view.cells.columns, n_first_columns, view.cells.columns.size());
  return result;
}

}  // namespace pamr::report
