// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "mutate.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/io/export/write_vtu.hpp"
#include "pamr/io/vtk/read_vtu.hpp"
#include "pamr/validate/validate.hpp"
#include "seeds.hpp"
#include "support/meshes.hpp"

namespace pamr::fuzz {

namespace {

/// One array of the file, as text and as the bytes in memory.
struct SeedArray {
  std::string type, name, text, bytes;
  int n_components = 1;
};

template <class T>
SeedArray array_of(const std::string& type, const std::string& name, int n_components, const std::vector<T>& values) {
  SeedArray array{type, name, {}, std::string(values.size() * sizeof(T), '\0'), n_components};
  for (const auto value : values) array.text += fmt::format("{} ", value);
  if (!values.empty()) std::memcpy(array.bytes.data(), values.data(), array.bytes.size());
  return array;
}

std::string base64(const std::string& bytes) {
  constexpr auto digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[word >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

std::string words(const std::vector<std::uint32_t>& values) {
  std::string bytes(4 * values.size(), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// An array in base64: its length before it, or packed by zlib in blocks of 256 bytes.
std::string encoded(const SeedArray& array, bool is_packed) {
  const auto n = static_cast<std::uint32_t>(array.bytes.size());
  if (!is_packed) return base64(words({n}) + array.bytes);
  constexpr std::uint32_t block = 256;
  std::vector<std::uint32_t> head{(n + block - 1) / block, block, n % block};
  std::string packed;
  for (std::uint32_t begin = 0; begin < n; begin += block) {
    const auto part = array.bytes.substr(begin, block);
    auto size = compressBound(part.size());
    std::string room(size, '\0');
    if (compress(reinterpret_cast<Bytef*>(room.data()), &size, reinterpret_cast<const Bytef*>(part.data()),
                 part.size()) != Z_OK)
      throw std::runtime_error("zlib cannot pack");
    head.push_back(static_cast<std::uint32_t>(size));
    packed += room.substr(0, size);
  }
  return base64(words(head)) + base64(packed);
}

/// The unit cube as six tetrahedra with two tagged triangles.
void write_cube(const std::filesystem::path& file, const std::string& format, bool is_packed) {
  std::vector<double> points;
  for (int i = 0; i < 8; ++i)
    for (int axis = 0; axis < 3; ++axis) points.push_back(i >> axis & 1);
  const std::vector<std::int64_t> corners{0, 3, 1, 0, 2, 3, 0, 1, 3, 7, 0, 5, 1, 7, 0,
                                          3, 2, 7, 0, 2, 6, 7, 0, 4, 5, 7, 0, 6, 4, 7};
  const std::vector<std::int64_t> ends{3, 6, 10, 14, 18, 22, 26, 30};
  const auto data = [&](const SeedArray& array) {
    return fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"{}\">\n{}\n</DataArray>\n", array.type,
        array.name, array.n_components, format, format == "ascii" ? array.text : encoded(array, is_packed));
  };
  std::ofstream out(file, std::ios::binary);
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt32\""
      << (is_packed ? " compressor=\"vtkZLibDataCompressor\"" : "")
      << ">\n<UnstructuredGrid><Piece NumberOfPoints=\"8\" NumberOfCells=\"8\">\n<Points>\n"
      << data(array_of("Float64", "Points", 3, points)) << "</Points>\n<Cells>\n"
      << data(array_of("Int64", "connectivity", 1, corners)) << data(array_of("Int64", "offsets", 1, ends))
      << data(array_of("Int32", "types", 1, std::vector<std::int32_t>{5, 5, 10, 10, 10, 10, 10, 10}))
      << "</Cells>\n<PointData>\n"
      << data(array_of("Float64", "v", 3, points)) << "</PointData>\n<CellData>\n"
      << data(array_of("Int32", "patch", 1, std::vector<std::int32_t>{4, 4, 0, 0, 0, 0, 0, 0}))
      << "</CellData>\n</Piece></UnstructuredGrid>\n</VTKFile>\n";
}

}  // namespace

// 0 our own: raw data behind the text; 1 text; 2 base64; 3 base64 packed
int n_seed_files() { return 4; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  validate::require_valid(comm, io::read_vtu(comm, file, {.split_prisms = true}).mesh, file.string());
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".vtu"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  io::write_vtu(comm, folder / seed_name(0), assemble::assemble(comm, test::random_mesh(comm, 1, 2)));
  write_cube(folder / seed_name(1), "ascii", false);
  write_cube(folder / seed_name(2), "binary", false);
  write_cube(folder / seed_name(3), "binary", true);
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
