// SPDX-License-Identifier: GPL-3.0-or-later
#include "convert/formats.hpp"

#include <array>
#include <filesystem>
#include <span>
#include <string_view>

#include "pamr/base/error.hpp"

namespace pamr::convert {

namespace {

constexpr std::array<std::string_view, 9> known_inputs{".hdf",   ".vtkhdf", ".msh",       ".vtu",     ".mesh",
                                                       ".meshb", ".su2",    ".lb8.ugrid", ".b8.ugrid"};
constexpr std::array<std::string_view, 15> known_outputs{".hdf",   ".vtkhdf", ".msh",       ".vtu",      ".mesh",
                                                         ".meshb", ".su2",    ".lb8.ugrid", ".b8.ugrid", ".cgns",
                                                         ".stl",   ".obj",    ".ply",       ".off",      ".vtp"};

std::string ending(const std::string& file, std::span<const std::string_view> known) {
  const auto path = std::filesystem::path(file);
  const auto found = path.extension().string();
  std::string list;
  for (const auto name : known) {
    if (found == name || (found == ".ugrid" && path.stem().extension().string() + found == name)) return found;
    list += (list.empty() ? "" : ", ") + std::string(name);
  }
  for (const auto* of_surface : {".stl", ".obj", ".ply", ".off"})
    if (found == of_surface)
      throw Error(
          "file '" + file + "': expected a mesh of tetrahedra (" + list +
          "), found a surface: pamr-mesh meshes the space in or around it (shape = \"surfaces\"), --surface lets "
          "a patch of a mesh lie on it");
  throw Error("file '" + file + "': expected a name that ends in " + list + ", found \"" + found + "\"");
}

bool ends_in(const std::string& file, std::initializer_list<std::string_view> endings) {
  const auto found = std::filesystem::path(file).extension().string();
  for (const auto name : endings)
    if (found == name) return true;
  return false;
}

}  // namespace

std::string ending_of_input(const std::string& file) { return ending(file, known_inputs); }
std::string ending_of_output(const std::string& file) { return ending(file, known_outputs); }
bool is_native_file(const std::string& file) { return ends_in(file, {".hdf", ".vtkhdf"}); }
bool is_medit_file(const std::string& file) { return ends_in(file, {".mesh", ".meshb"}); }
bool is_file_of_elements(const std::string& file) {
  return ends_in(file, {".msh", ".mesh", ".meshb", ".su2", ".ugrid"});
}

}  // namespace pamr::convert
