// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>

#include "mutate.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/io/elements/numbers.hpp"
#include "pamr/io/medit/read_medit.hpp"
#include "pamr/io/medit/write_medit.hpp"
#include "pamr/validate/validate.hpp"
#include "seeds.hpp"
#include "support/meshes.hpp"

namespace pamr::fuzz {

namespace {

/// One tetrahedron with its faces in version 4 or 1, the greatest byte first, behind a keyword that nobody knows.
std::string binary_tetrahedron(std::int32_t version) {
  std::string bytes;
  const auto word = [&](std::int32_t value) { io::append_bytes(bytes, value, true); };
  const auto integer = [&](std::int64_t value) {
    version == 4 ? io::append_bytes(bytes, value, true) : word(static_cast<std::int32_t>(value));
  };
  const auto real = [&](float value) {
    version == 1 ? io::append_bytes(bytes, value, true) : io::append_bytes(bytes, double{value}, true);
  };
  const std::int64_t w = version == 4 ? 8 : 4, r = version == 1 ? 4 : 8;
  const auto section = [&](std::int32_t keyword, std::int64_t n_bytes) {
    const auto next = static_cast<std::int64_t>(bytes.size()) + 4 + w + n_bytes;
    word(keyword);
    integer(next);
  };
  word(1);
  word(version);
  section(3, 4);
  word(3);
  section(5, w + 3 * w);  // an edge
  for (const int value : {1, 1, 2, 0}) integer(value);
  section(4, w + 4 * (3 * r + w));
  integer(4);
  for (int node = 0; node < 4; ++node) {
    for (int axis = 1; axis <= 3; ++axis) real(node == axis ? 1.0F : 0.0F);
    integer(0);
  }
  section(6, w + 4 * 4 * w);
  integer(4);
  for (const int value : {1, 2, 3, 7, 1, 2, 4, 7, 2, 3, 4, 7, 1, 3, 4, 9}) integer(value);
  section(8, w + 5 * w);
  integer(1);
  for (const int value : {1, 2, 3, 4, 2}) integer(value);
  word(54);
  integer(0);
  return bytes;
}

}  // namespace

// 0 our own text, 1 our own bytes; 2 text as other programs write it; 3 and 4 the other order of bytes, versions 1, 4
int n_seed_files() { return 5; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  validate::require_valid(comm, io::read_medit(comm, file, {{.split_prisms = true}, {}, {}}).mesh, file.string());
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + (i == 0 || i == 2 ? ".mesh" : ".meshb"); }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  const auto mesh = assemble::assemble(comm, test::random_mesh(comm, 1, 2));
  for (const int i : {0, 1}) io::write_medit(comm, folder / seed_name(i), mesh);
  std::ofstream(folder / seed_name(2)) << " MeshVersionFormatted 1\n# a comment\n Dimension\n 3\n Vertices\n 4\n"
                                          "  0 0 0 1\n 1 0 0 1\n 0 1. 0 1\n 0 0 +1e0 1 # the last\n\nRidges\n1\n1\n"
                                          " Triangles\n 4\n1 2 3 7\n1 2 4 7\n2 3 4 7\n1 3 4 9\nCorners 2\n1\n2\n"
                                          " Tetrahedra 1\n1 2 3 4 2\nQuadrilaterals 0\n End\n";
  for (const int i : {3, 4})
    std::ofstream(folder / seed_name(i), std::ios::binary) << binary_tetrahedron(i == 3 ? 1 : 4);
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
