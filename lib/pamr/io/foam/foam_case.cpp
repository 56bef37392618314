// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/foam/foam_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "pamr/base/counted.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/io/foam/foam_tokens.hpp"
#include "pamr/io/text.hpp"

namespace pamr::io::foam {

namespace {

namespace fs = std::filesystem;

/// Paths of the entries of a folder, sorted by name; none if the folder cannot be listed.
std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed))
    entries.push_back(entry->path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

bool is_folder(const fs::path& path) {
  std::error_code none;
  return fs::is_directory(path, none);
}

/// Folders of times, ascending: their names are numbers.
std::vector<std::pair<double, fs::path>> times_of(const fs::path& case_folder) {
  std::vector<std::pair<double, fs::path>> times;
  for (const auto& path : entries_of(case_folder)) {
    const auto name = path.filename().string();
    double time = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), time);
    if (error == std::errc() && std::isfinite(time) && end == name.data() + name.size() && is_folder(path))
      times.emplace_back(time, path);
  }
  std::sort(times.begin(), times.end());
  return times;
}

/// Zones of points, sets, levels of OpenFOAM's own refinement, ...
void tell_of_other_files(const fs::path& mesh_folder, WholeMesh& mesh) {
  constexpr std::array<std::string_view, 7> known{"points",   "faces",     "owner",    "neighbour",
                                                  "boundary", "cellZones", "faceZones"};
  std::set<std::string> others;
  for (const auto& path : entries_of(mesh_folder)) {
    const auto name = path.extension() == ".gz" ? path.stem() : path.filename();
    if (std::find(known.begin(), known.end(), name.string()) == known.end()) others.insert(shown_text(name.string()));
  }
  if (!others.empty()) mesh.remarks.push_back("left out was what else polyMesh has: " + listed(others));
}

}  // namespace

std::vector<std::string> regions_of_case(const fs::path& case_folder) {
  std::vector<std::string> regions;
  for (const auto& path : entries_of(case_folder / "constant"))
    if (is_present(path / "polyMesh" / "owner")) regions.push_back(shown_text(path.filename().string()));
  return regions;
}

void tell_of_other_data(const fs::path& case_folder, const fs::path& mesh_folder, WholeMesh& mesh) {
  tell_of_other_files(mesh_folder, mesh);
  std::vector<std::string> with_fields, with_mesh;
  for (const auto& [time, folder] : times_of(case_folder)) {
    const auto entries = entries_of(folder);
    const auto name = folder.filename().string();
    if (std::any_of(entries.begin(), entries.end(), [](const fs::path& path) { return !is_folder(path); }))
      with_fields.push_back(name);
    if (is_present(folder / "polyMesh" / "points")) with_mesh.push_back(name);
  }
  if (!with_mesh.empty())
    mesh.remarks.push_back(fmt::format("the mesh of constant was read: {} of its own: {}",
                                       counted(std::ssize(with_mesh), "time has one", "times have one"),
                                       listed(with_mesh)));
  if (!with_fields.empty())
    mesh.notes.push_back(fmt::format("{} left out (pamr.openfoam.read_fields of Python reads them): {}",
                                     counted(std::ssize(with_fields), "time with fields was", "times with fields were"),
                                     listed(with_fields)));
  if (const auto regions = regions_of_case(case_folder); !regions.empty())
    mesh.notes.push_back(fmt::format(
        "{} a mesh of its own, which was left out: {}",
        counted(std::ssize(regions), "region of the case has", "regions of the case have each"), listed(regions)));
}

}  // namespace pamr::io::foam
