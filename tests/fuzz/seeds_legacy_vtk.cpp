// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <fstream>
#include <vector>

#include "mutate.hpp"
#include "pamr/io/vtk/read_legacy_vtk.hpp"
#include "pamr/validate/validate.hpp"
#include "seeds.hpp"

namespace pamr::fuzz {

namespace {

/// Numbers as text, or with the greatest byte first.
template <class T>
std::string numbers(const std::vector<T>& values, bool is_binary) {
  std::string result;
  for (const auto value : values) {
    if (!is_binary) {
      result += fmt::format("{} ", value);
      continue;
    }
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    std::reverse(bytes.begin(), bytes.end());
    result.append(bytes.data(), bytes.size());
  }
  return result + "\n";
}

/// The unit cube as six tetrahedra with two tagged triangles, with data of several kinds.
void write_cube(const std::filesystem::path& file, bool is_binary, bool is_new) {
  std::vector<double> points;
  for (int i = 0; i < 8; ++i)
    for (int axis = 0; axis < 3; ++axis) points.push_back(i >> axis & 1);
  const std::vector<std::int64_t> corners{0, 3, 1, 0, 2, 3, 0, 1, 3, 7, 0, 5, 1, 7, 0,
                                          3, 2, 7, 0, 2, 6, 7, 0, 4, 5, 7, 0, 6, 4, 7};
  std::vector<std::int32_t> counted;
  std::vector<std::int64_t> offsets{0};
  for (std::size_t c = 0, next = 0; c < 8; ++c) {
    const std::size_t n = c < 2 ? 3 : 4;
    counted.push_back(static_cast<std::int32_t>(n));
    for (std::size_t k = 0; k < n; ++k) counted.push_back(static_cast<std::int32_t>(corners[next + k]));
    next += n;
    offsets.push_back(static_cast<std::int64_t>(next));
  }
  std::ofstream out(file, std::ios::binary);
  out << "# vtk DataFile Version " << (is_new ? "5.1" : "3.0") << "\na title\n"
      << (is_binary ? "BINARY" : "ASCII") << "\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n"
      << numbers(points, is_binary) << "METADATA\nINFORMATION 0\n\n";
  if (is_new)
    out << "CELLS 9 30\nOFFSETS vtktypeint64\n"
        << numbers(offsets, is_binary) << "CONNECTIVITY vtktypeint64\n"
        << numbers(corners, is_binary);
  else
    out << "CELLS 8 38\n" << numbers(counted, is_binary);
  out << "CELL_TYPES 8\n"
      << numbers(std::vector<std::int32_t>{5, 5, 10, 10, 10, 10, 10, 10}, is_binary)
      << "POINT_DATA 8\nVECTORS v double\n"
      << numbers(points, is_binary) << "CELL_DATA 8\nSCALARS patch int 1\nLOOKUP_TABLE default\n"
      << numbers(std::vector<std::int32_t>{4, 4, 0, 0, 0, 0, 0, 0}, is_binary) << "FIELD FieldData 2\na%20b 1 8 float\n"
      << numbers(std::vector<float>{0, 1, 2, 3, 4, 5, 6, 7.5F}, is_binary) << "on 1 8 bit\n"
      << (is_binary ? "\xa7\n" : "1 0 1 0 0 1 1 1\n");
}

}  // namespace

// 0 text of version 3; 1 bytes; 2 text of version 5; 3 bytes
int n_seed_files() { return 4; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  validate::require_valid(comm, io::read_legacy_vtk(comm, file, {.split_prisms = true}).mesh, file.string());
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".vtk"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  for (int i = 0; i < n_seed_files(); ++i) write_cube(folder / seed_name(i), i % 2 == 1, i >= 2);
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
