// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/foam/foam_patches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>

#include "pamr/base/index.hpp"
#include "pamr/io/elements/cut_elements.hpp"
#include "pamr/io/elements/element_parts.hpp"
#include "pamr/io/foam/foam_tokens.hpp"
#include "pamr/io/text.hpp"
#include "pamr/mesh/periodic_patches.hpp"

namespace pamr::io::foam {

namespace {

std::string kind_of_type(const std::string& type) {
  if (type == "wall" || type == "symmetry" || type == "symmetryPlane") return type;
  if (type.starts_with("cyclic")) return mesh::periodic_kind;
  return {};
}

/// The entry of a patch in the file `boundary`.
struct Entry {
  std::string name, type = "patch";
  std::int64_t start = -1, size = -1;
  std::vector<std::string> groups;
};

/// The words up to the semicolon but for what makes a list of them: `2(inlet walls)`, `List<word> 1(walls)`, `(walls)`.
std::vector<std::string> words_of_list(FoamFile& in) {
  constexpr std::string_view marks = "(){}[]";
  std::vector<std::string> words;
  bool is_first = true;
  for (std::string word(in.word("a list of groups")); word != ";"; word = in.word("a semicolon")) {
    const bool is_count =
        is_first && std::all_of(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (word == "List<word>") continue;
    is_first = false;
    if (is_count || marks.find(word) != std::string_view::npos) continue;
    if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
  }
  return words;
}

/// Reads one patch; other entries are counted by their keys in `left_out`.
Entry read_entry(FoamFile& in, std::map<std::string, std::int64_t>& left_out) {
  Entry entry;
  entry.name = in.word("the name of a patch");
  const auto rest = in.dictionary([&](const std::string& key) {
    if (key == "inGroups") {
      entry.groups = words_of_list(in);
      return true;
    }
    if (key != "nFaces" && key != "startFace") return false;
    (key == "nFaces" ? entry.size : entry.start) = in.integer(key);
    in.require(";");
    return true;
  });
  for (const auto& [key, value] : rest)
    if (key == "type")
      entry.type = value;
    else
      ++left_out[shown_text(key) + " of patches"];
  return entry;
}

/// The groups of a mesh for those that a patch has.
std::vector<mesh::Group> groups_of(const Entry& entry) {
  std::vector<mesh::Group> groups;
  std::string joined;
  for (const auto& name : entry.groups) {
    if (name == entry.type || name == entry.name) continue;
    groups.push_back({-1, name});
    joined += (joined.empty() ? "" : "+") + name;
  }
  if (!groups.empty() && joined != entry.name) groups.insert(groups.begin(), {-1, entry.name});
  return groups;
}

}  // namespace

void add_face(std::span<const std::int64_t> nodes, std::int64_t tag, WholeMesh& mesh) {
  if (nodes.size() == 3) {
    mesh.triangle.push_back({nodes[0], nodes[1], nodes[2]});
    mesh.tag.push_back(tag);
  } else if (nodes.size() == 4) {
    for (const auto& triangle : triangles_of(element_type::quadrangle, nodes)) {
      mesh.triangle.push_back(triangle);
      mesh.tag.push_back(tag);
    }
  }  // others are of cells that are counted
}

void read_patches(const std::filesystem::path& folder, const CaseFaces& faces, WholeMesh& mesh) {
  FoamFile in(folder / "boundary");
  const auto n = in.count(8, "patches"), n_faces = static_cast<std::int64_t>(faces.nodes.size());
  in.require("(");
  for (std::int64_t p = 0; p < n; ++p) {
    const auto entry = read_entry(in, mesh.left_out);
    if (entry.start < faces.n_inner || entry.size < 0 || entry.start > n_faces || entry.size > n_faces - entry.start)
      in.fail(fmt::format("faces of patch '{}' within the boundary", entry.name),
              fmt::format("{} from {} on", entry.size, entry.start));
    if (entry.type == "processor" && entry.size > 0)
      in.fail("the mesh of a whole case", "a part for one processor (reconstructParMesh joins them)");
    const auto kind = kind_of_type(entry.type);
    mesh.patch_of_tag[p] = {.name = entry.name, .kind = kind, .groups = groups_of(entry)};
    if (entry.size > 0 && entry.type != "patch" && kind.empty())
      mesh.remarks.push_back(
          fmt::format("the type '{}' of the patch '{}' was left out", shown_text(entry.type), entry.name));
    for (auto f = at(entry.start); f < at(entry.start + entry.size); ++f) add_face(faces.nodes[f], p, mesh);
  }
  in.require(")");
}

}  // namespace pamr::io::foam
