// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>
#include <fstream>
#include <iterator>
#include <pamr/geometry/cad/read_cad.hpp>
#include <string>

int main(int, char** argv) {
  std::ifstream file(argv[1]);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::printf("%zu faces\n", pamr::geometry::read_cad(text, 1e-3).faces.size());
}
