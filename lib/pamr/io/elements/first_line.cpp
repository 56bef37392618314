// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/first_line.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>

#include "pamr/base/byte_order_mark.hpp"

namespace pamr::io {

namespace {

struct Beginning {
  std::string_view text;  ///< after blanks and empty lines; letters in either case
  std::string_view what;
};

constexpr std::array<Beginning, 32> beginnings{{
    {"$NOD", "a file of Gmsh's format 1: gmsh OLD.msh -save -format msh41 -o NEW.msh"},
    {"$MeshFormat", "a mesh of Gmsh: its name has to end in .msh"},
    {"MeshVersionFormatted", "a mesh of Medit: its name has to end in .mesh"},
    {"MFEM mesh v1", "a mesh of MFEM: its name has to end in .mfem or .mesh"},
    {"MFEM",
     "a mesh of MFEM of another kind than \"MFEM mesh v1.0\": in MFEM, Mesh::MakeSimplicial and Mesh::Save write that"},
    {"# vtk DataFile", "a legacy file of VTK: its name has to end in .vtk"},
    {"<VTKFile", "a file of VTK in XML: its name has to end in .vtu"},
    {"<?xml", "a file in XML: a grid of VTK has a name that ends in .vtu"},
    {"NDIME", "a mesh of SU2: its name has to end in .su2"},
    {"NZONE", "a mesh of SU2: its name has to end in .su2"},
    {"\x89HDF", "an HDF5 file: PAMR's have names that end in .hdf, those of CGNS in .cgns"},
    {"@(#)ADF Database", "a CGNS file in the old form ADF: adf2hdf OLD.cgns NEW.cgns makes HDF5 of it"},
    {"FoamFile", "a file of OpenFOAM: give the folder of the case"},
    {"(0 ", "a mesh of Fluent: OpenFOAM's fluentMeshToFoam makes a case of it, which is read"},
    {"(1 ", "a mesh of Fluent: OpenFOAM's fluentMeshToFoam makes a case of it, which is read"},
    {"(2 ", "a mesh of Fluent: OpenFOAM's fluentMeshToFoam makes a case of it, which is read"},
    {"(10 ", "a mesh of Fluent: OpenFOAM's fluentMeshToFoam makes a case of it, which is read"},
    {"mesh3d", "a mesh of Netgen: \"Gmsh2 Format\" among its exports is read"},
    {"solid", "a surface in STL: pamr-mesh meshes the space in or around it"},
    {"*HEADING", "a mesh of Abaqus: meshio convert OLD.inp NEW.vtu writes one that is read"},
    {"*NODE", "a mesh of Abaqus: meshio convert OLD.inp NEW.vtu writes one that is read"},
    {"BEGIN BULK", "a mesh of Nastran: gmsh OLD.bdf -save -format msh41 -o NEW.msh writes one that is read"},
    {"CEND", "a mesh of Nastran: gmsh OLD.bdf -save -format msh41 -o NEW.msh writes one that is read"},
    {"-1", "a universal file (UNV): gmsh OLD.unv -save -format msh41 -o NEW.msh writes one that is read"},
    {"TITLE", "a file of Tecplot: meshio convert OLD.dat NEW.vtu writes one that is read"},
    {"VARIABLES", "a file of Tecplot: meshio convert OLD.dat NEW.vtu writes one that is read"},
    {"CDF", "a netCDF file, as Exodus has them: meshio convert OLD.exo NEW.vtu writes one that is read"},
    {"<!DOCTYPE html", "a page in HTML, as servers send it instead of a file"},
    {"<html", "a page in HTML, as servers send it instead of a file"},
    {"\x1f\x8b", "a file packed by gzip: gunzip it"},
    {"\xff\xfe", "a text in UTF-16: save it as UTF-8"},
    {"\xfe\xff", "a text in UTF-16: save it as UTF-8"},
}};

bool begins_with(std::string_view bytes, std::string_view text) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return bytes.size() >= text.size() &&
         std::equal(text.begin(), text.end(), bytes.begin(), [&](char a, char b) { return lower(a) == lower(b); });
}

/// FreeFEM begins with three counts alone in a line: of vertices, elements and boundary elements.
bool is_freefem(std::string_view line) {
  int n_words = 0;
  bool in_word = false;
  for (const char c : line) {
    const bool is_digit = c >= '0' && c <= '9';
    if (!is_digit && c != ' ' && c != '\t' && c != '\r') return false;
    if (is_digit && !in_word) ++n_words;
    in_word = is_digit;
  }
  return n_words == 3;
}

std::string known(std::string_view bytes) {
  const auto* found = std::find_if(beginnings.begin(), beginnings.end(),
                                   [&](const Beginning& one) { return begins_with(bytes, one.text); });
  if (found != beginnings.end()) return std::string(found->what);
  if (is_freefem(bytes.substr(0, bytes.find('\n'))))
    return "a mesh of FreeFEM: savemesh(Th, \"NEW.mesh\") writes one of three dimensions that is read";
  return {};
}

std::string_view without_blanks(std::string_view bytes) {
  bytes = without_byte_order_mark(bytes);
  const auto begin = bytes.substr(0, 1000).find_first_not_of(" \t\r\n");
  return begin == std::string_view::npos ? std::string_view() : bytes.substr(begin);
}

}  // namespace

std::string what_begins(std::string_view bytes) {
  bytes = without_blanks(bytes);
  if (bytes.empty()) return "an empty file";
  if (auto what = known(bytes); !what.empty()) return what;
  std::string shown;
  for (const char c : bytes.substr(0, std::min<std::size_t>(bytes.find('\n'), 40)))
    shown += c >= ' ' && c <= '~' ? c : '?';
  return "another beginning: \"" + shown + "\"";
}

std::string what_begins(const std::filesystem::path& file) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) return {};
  std::string bytes(2000, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  return known(without_blanks(bytes));
}

}  // namespace pamr::io
