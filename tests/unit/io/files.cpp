// SPDX-License-Identifier: GPL-3.0-or-later
#include "files.hpp"

#include <unistd.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "hdf5_edit.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "support/meshes.hpp"

namespace pamr::test {

Folder::Folder(const par::Comm& comm) : comm_(&comm) {
  std::string path;
  if (comm.is_first()) {
    path = (std::filesystem::temp_directory_path() / "pamr io test XXXXXX").string();
    if (mkdtemp(path.data()) == nullptr) throw std::runtime_error("cannot make a folder for the test");
  }
  path_ = comm.broadcast(path);
}

Folder::~Folder() {
  comm_->barrier();
  std::error_code ignored;
  if (comm_->is_first()) std::filesystem::remove_all(path_, ignored);
}

std::size_t Folder::n_entries() const {
  comm_->barrier();
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
}

mesh::DistMesh mesh_with_fields(const par::Comm& comm, int n, std::uint64_t seed) {
  using mesh::StorageType;
  auto block = random_mesh(comm, seed, n);
  block.info.length_unit = "m";
  block.info.regions = {{-3, "gaz"}, {7, "région solide"}};
  block.info.surfaces =
      surfaces_of("[[surface]]\nname = \"ball\"\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1.0\n");
  block.info.patches[1].surface = 0;
  const auto n_cells = static_cast<std::int64_t>(block.cell_to_node.size());
  const auto first_node = par::block_range(block.info.n_global_nodes, comm.rank(), comm.size()).begin;
  const auto n_nodes = static_cast<std::int64_t>(block.node_position.size());
  const auto word = [&](std::int64_t row, int salt) {
    return combine(seed + static_cast<std::uint64_t>(salt), static_cast<std::uint64_t>(row));
  };
  const auto reals = [&](std::int64_t first, std::int64_t count, int width, int salt) {
    std::vector<double> values;
    for (auto row = first * width; row < (first + count) * width; ++row)
      values.push_back(static_cast<double>(static_cast<float>(word(row, salt) >> 40U)) / 1024.0 - 7.0);
    return values;
  };
  const auto integers = [&](std::int64_t first, std::int64_t count, unsigned shift, int salt) {
    std::vector<std::int64_t> values;
    for (auto row = first; row < first + count; ++row)
      values.push_back(static_cast<std::int64_t>(word(row, salt) >> shift));
    return values;
  };
  block.cell_fields.push_back({"refine", "", 1, StorageType::uint8, integers(block.first_cell, n_cells, 56, 1)});
  block.cell_fields.push_back({"stress", "Pa", 9, StorageType::float64, reals(block.first_cell, n_cells, 9, 2)});
  block.cell_fields.push_back({"région", "", 1, StorageType::int16, integers(block.first_cell, n_cells, 49, 3)});
  block.node_fields.push_back({"potential", "kT/e", 1, StorageType::float32, reals(first_node, n_nodes, 1, 4)});
  block.node_fields.push_back({"number", "", 1, StorageType::int64, integers(first_node, n_nodes, 1, 5)});
  const auto destination = random_destinations(comm, block, seed);
  return assemble::assemble(comm, std::move(block), destination);
}

mesh::Level0Cell level0_cell(GlobalId row) {
  mesh::Level0Cell cell;
  const auto r = static_cast<double>(row);
  cell.row = row;
  cell.node = {row, row + 1, row + 2, 20};
  cell.corner = {{{r, 0, 0}, {r, 0, 1}, {r, 1, 0}, {r + 1, 0.1, 0}}};
  for (std::size_t e = 0; e < 6; ++e) cell.bulge[e] = {0.01 * static_cast<double>(e), -0.02 - r, 1e-300};
  cell.face_patch[1] = 1;  // on the ball; the other patches have no surface
  cell.edge_patch[0] = {1, 1};
  cell.edge_patch[1] = {0, 1};
  cell.edge_patch[5] = {1, 1};
  cell.beside[1] = {0, 0, -1};
  cell.sharp_edges = 1U << 1U;
  cell.creases = 1U << 5U;
  cell.bent_corners = static_cast<std::uint8_t>(row + 1);
  return cell;
}

mesh::DistMesh mesh_with_level0(const par::Comm& comm) {
  using mesh::Level0Key;
  auto mesh = mesh_with_fields(comm, 2, 5);
  constexpr GlobalId n_rows = 3;
  std::vector<std::int64_t> row_of_cell;
  for (const auto id : mesh.cell_global) row_of_cell.push_back(id % 4 < n_rows ? id % 4 : -1);
  auto keys = mesh::empty_key_field();
  for (const auto id : mesh.node_global) {
    const auto of_node = Level0Key::of_node(id);
    mesh::append_key(keys, id % 3 == 0   ? Level0Key{}
                           : id % 3 == 1 ? of_node
                                         : mesh::middle(Level0Key::of_node(0), of_node));
  }
  std::vector<mesh::Level0Cell> cells;
  for (GlobalId row = 0; row < n_rows; ++row)
    if (std::find(row_of_cell.begin(), row_of_cell.end(), row) != row_of_cell.end()) cells.push_back(level0_cell(row));
  mesh.node_fields.push_back(std::move(keys));
  mesh.cell_fields.push_back({mesh::level0_cell_field, "", 1, mesh::StorageType::int64, std::move(row_of_cell)});
  mesh.info.level0 = std::make_shared<const mesh::Level0Map>(std::move(cells), n_rows, mesh.info);
  return mesh;
}

void on_first_rank(const par::Comm& comm, const std::function<void()>& edit) {
  comm.barrier();
  if (comm.is_first()) edit();
  comm.barrier();
}

std::string error_of_reading(const par::Comm& comm, const std::filesystem::path& file) {
  try {
    io::read_native(comm, file, {.remark = [](const std::string& remark) { throw Error(remark); }});
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

void write_plain_vtkhdf(const std::filesystem::path& file, bool chunked) {
  const Storage storage{chunked ? hsize_t{3} : hsize_t{0}, 0};
  create_file(file);
  create_group(file, "/VTKHDF");
  write_attribute(file, "/VTKHDF", "Version", std::vector<std::int64_t>{1, 0});
  write_attribute(file, "/VTKHDF", "Type", std::string("UnstructuredGrid"));
  write_dataset<std::int64_t>(file, "/VTKHDF/NumberOfPoints", {1}, {8});
  write_dataset<std::int64_t>(file, "/VTKHDF/NumberOfCells", {1}, {6});
  write_dataset<std::int64_t>(file, "/VTKHDF/NumberOfConnectivityIds", {1}, {24});
  write_dataset<float>(file, "/VTKHDF/Points", {8, 3},
                       {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1}, storage);
  write_dataset<std::int32_t>(file, "/VTKHDF/Connectivity", {24},
                              {0, 1, 3, 7, 0, 5, 1, 7, 0, 3, 2, 7, 0, 2, 6, 7, 0, 4, 5, 7, 0, 6, 4, 7}, storage);
  write_dataset<std::int64_t>(file, "/VTKHDF/Offsets", {7}, {0, 4, 8, 12, 16, 20, 24}, storage);
  write_dataset<std::uint8_t>(file, "/VTKHDF/Types", {6}, {10, 10, 10, 10, 10, 10}, storage);
  create_group(file, "/VTKHDF/CellData");
  write_dataset<std::int8_t>(file, "/VTKHDF/CellData/mark", {6}, {0, 1, 0, -1, 0, 5}, storage);
  create_group(file, "/VTKHDF/PointData");
  write_dataset<double>(file, "/VTKHDF/PointData/velocity", {8, 2},
                        {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}, {storage.chunk, H5T_IEEE_F64BE});
}

}  // namespace pamr::test
