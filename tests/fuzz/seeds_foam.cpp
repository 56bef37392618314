// SPDX-License-Identifier: GPL-3.0-or-later
#include <zlib.h>

#include <array>
#include <cstring>
#include <fstream>
#include <iterator>

#include "mutate.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/io/export/write_foam.hpp"
#include "pamr/io/foam/read_foam.hpp"
#include "pamr/validate/validate.hpp"
#include "seeds.hpp"
#include "support/meshes.hpp"

namespace pamr::fuzz {

namespace {

/// A case is damaged as one file: its parts one after another, each behind a line with its name.
constexpr std::array<const char*, 8> parts{"points",    "points.gz", "faces",     "owner",
                                           "neighbour", "boundary",  "cellZones", "faceZones"};

std::string line_before(const std::string& part) { return "//FILE " + part + "\n"; }

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string head(const std::string& kind, const std::string& name, const char* format) {
  return "FoamFile\n{\n version 2.0;\n format " + std::string(format) +
         ";\n arch \"LSB;label=32;scalar=64\";\n class " + kind + ";\n object " + name + ";\n}\n// * * //\n";
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return "(" + bytes + ")\n";
}

/// A tetrahedron as OpenFOAM writes it in binary.
std::string binary_case() {
  using Labels = std::vector<std::int32_t>;
  return line_before("points") + head("vectorField", "points", "binary") + "4\n" +
         bytes_of(std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}) + line_before("faces") +
         head("faceCompactList", "faces", "binary") + "5\n" + bytes_of(Labels{0, 3, 6, 9, 12}) + "12\n" +
         bytes_of(Labels{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}) + line_before("owner") +
         head("labelList", "owner", "binary") + "4\n" + bytes_of(Labels{0, 0, 0, 0}) + line_before("neighbour") +
         head("labelList", "neighbour", "binary") + "0\n()\n" + line_before("boundary") +
         head("polyBoundaryMesh", "boundary", "ascii") +
         "2\n(\n wall\n {\n type wall;\n inGroups List<word> 1(wall);\n nFaces 3;\n startFace 0;\n }\n"
         " \"far field\" { type patch; nFaces 1; startFace 3; }\n)\n";
}

std::string packed(const std::string& text, const std::filesystem::path& file) {
  auto* out = gzopen(file.c_str(), "wb");
  gzwrite(out, text.data(), static_cast<unsigned>(text.size()));
  gzclose(out);
  return text_of(file);
}

/// A tetrahedron as OpenFOAM writes it in text, with one value for all cells, zones with a cell in common, and packed
/// points.
std::string short_case(const std::filesystem::path& folder) {
  const auto points = head("vectorField", "points", "ascii") + "4\n(\n(0 0 0)\n(1 0 0)\n(0 1 0)\n(0 0 1)\n)\n";
  return line_before("points.gz") + packed(points, folder / "packed") + line_before("faces") +
         head("faceList", "faces", "ascii") + "4\n(\n3(0 2 1)\n3(0 1 3)\n3(0 3 2)\n3(1 2 3)\n)\n" +
         line_before("owner") + head("labelList", "owner", "ascii") + "4{0}\n" + line_before("neighbour") +
         head("labelList", "neighbour", "ascii") + "0()\n" + line_before("boundary") +
         head("polyBoundaryMesh", "boundary", "ascii") + "1\n(\n wall { type wall; nFaces 4; startFace 0; }\n)\n" +
         line_before("cellZones") + head("regIOobject", "cellZones", "ascii") +
         "2\n(\n gas { type cellZone; cellLabels List<label> 1{0}; }\n all { type cellZone; cellLabels List<label> "
         "1(0); }\n)\n" +
         line_before("faceZones") + head("regIOobject", "faceZones", "ascii") +
         "2\n(\n cut { type faceZone; faceLabels List<label> 2(0 1); flipMap List<bool> 2{0}; }\n wall { type "
         "faceZone; "
         "faceLabels List<label> 1{3}; flipMap List<bool> 1(1); }\n)\n";
}

}  // namespace

// 0 our own; 1 binary; 2 packed, with lists of one value
int n_seed_files() { return 3; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  const auto all = text_of(file);
  const std::filesystem::path folder = file.string() + ".case";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(io::foam_folder(folder));
  for (const auto* part : parts) {
    const auto line = line_before(part);
    const auto begin = all.find(line);
    if (begin == std::string::npos) continue;
    const auto text = all.substr(begin + line.size());
    std::ofstream(io::foam_folder(folder) / part, std::ios::binary) << text.substr(0, text.find("//FILE "));
  }
  validate::require_valid(comm, io::read_foam(comm, folder, {.split_prisms = true}).mesh, folder.string());
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".foam"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  auto mesh = assemble::assemble(comm, test::random_mesh(comm, 1, 2));
  std::vector<std::int64_t> region(static_cast<std::size_t>(mesh.n_cells()), 0);
  for (std::size_t c = 0; c < region.size(); c += 2) region[c] = 4;
  mesh.cell_fields.push_back({"region", "", 1, mesh::StorageType::int32, region});
  io::write_foam(comm, folder / "own", mesh);
  std::ofstream own(folder / seed_name(0), std::ios::binary);
  for (const auto* part : parts)
    if (std::filesystem::exists(io::foam_folder(folder / "own") / part))
      own << line_before(part) << text_of(io::foam_folder(folder / "own") / part);
  own.close();
  std::ofstream(folder / seed_name(1), std::ios::binary) << binary_case();
  std::ofstream(folder / seed_name(2), std::ios::binary) << short_case(folder);
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
