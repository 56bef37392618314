// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/associate/find_cad_faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/untagged_patch.hpp"

namespace pamr::meshing {

namespace {

using geometry::CadModel;
using geometry::Vec3;

constexpr double usual_tolerance = 1e-6;  // of the mesh's size, as for other surfaces
constexpr double like_a_unit = 0.05;      // how far a ratio of sizes may be from one of units to be named

/// A boundary face of this rank.
struct BoundaryFace {
  LocalId cell = 0;
  std::size_t slot = 0;
  int patch = 0;
  int face = -1;  ///< of the shape, -1: none
};

/// Finds the face under boundary faces; remembers what is near the nodes.
class FaceFinder {
 public:
  FaceFinder(const mesh::DistMesh& mesh, const CadModel& model, double tolerance)
      : mesh_(&mesh), model_(&model), tolerance_(tolerance) {}

  int face_under(LocalId cell, std::size_t slot) {
    std::array<LocalId, 3> node{};
    for (std::size_t k = 0; k < 3; ++k) node[k] = mesh_->cell_to_node[at(cell)][at(mesh::tet::face_to_corner[slot][k])];
    std::vector<int> common = near(node[0]);
    for (std::size_t k = 1; k < 3; ++k) {
      const auto& other = near(node[k]);
      std::erase_if(common, [&](int f) { return !std::binary_search(other.begin(), other.end(), f); });
    }
    if (common.size() < 2) return common.empty() ? -1 : common.front();
    // the same bits in whatever order the cell has its corners
    std::array<Vec3, 3> p{mesh_->point(node[0]), mesh_->point(node[1]), mesh_->point(node[2])};
    std::sort(p.begin(), p.end(), geometry::lexicographically_less);
    const Vec3 middle = (1.0 / 3) * (p[0] + p[1] + p[2]);
    int best = -1;
    double least = std::numeric_limits<double>::infinity();
    for (const int f : common) {
      const double distance = model_->faces()[at(f)].project(middle).distance;
      if (distance < least) best = f;
      least = std::min(least, distance);
    }
    return best;
  }

  /// Distance of the corner that is farthest from the shape.
  double worst_distance(LocalId cell, std::size_t slot) const {
    double worst = 0;
    for (const auto corner : mesh::tet::face_to_corner[slot]) {
      const Vec3 p = mesh_->point(mesh_->cell_to_node[at(cell)][at(corner)]);
      double least = std::numeric_limits<double>::infinity();
      for (const auto& face : model_->faces())
        if (face.distance_at_least(p, least) < least) least = std::min(least, face.project(p).distance);
      worst = std::max(worst, least);
    }
    return worst;
  }

 private:
  const std::vector<int>& near(LocalId node) {
    const auto known = near_.find(node);
    if (known != near_.end()) return known->second;
    return near_.emplace(node, model_->faces_near(mesh_->point(node), tolerance_)).first->second;
  }
  const mesh::DistMesh* mesh_;
  const CadModel* model_;
  double tolerance_;
  std::map<LocalId, std::vector<int>> near_;
};

std::vector<BoundaryFace> find_faces(const mesh::DistMesh& mesh, const CadModel& model, double tolerance,
                                     const std::vector<bool>& is_wanted) {
  FaceFinder finder(mesh, model, tolerance);
  std::vector<BoundaryFace> faces;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const auto next = mesh.cell_to_cell[at(c)][slot];
      if (next >= 0 || !is_wanted[at(mesh::slot_to_patch(next))]) continue;
      faces.push_back({c, slot, mesh::slot_to_patch(next), finder.face_under(c, slot)});
    }
  return faces;
}

/// Counts by patch and face of the shape, `n_faces` + 1 numbers for each patch, the last one of those on none.
/// Collective.
std::vector<std::int64_t> count(const par::Comm& comm, const std::vector<BoundaryFace>& faces, std::size_t n_patches,
                                std::size_t n_faces) {
  std::vector<std::int64_t> counts(n_patches * (n_faces + 1), 0);
  for (const auto& f : faces) ++counts[at(f.patch) * (n_faces + 1) + (f.face < 0 ? n_faces : at(f.face))];
  comm.sum_in_place(counts);
  return counts;
}

std::string name_of_face(const CadModel& model, int face, const std::vector<mesh::Patch>& patches) {
  const auto is_taken = [&](const std::string& name) {
    return std::any_of(patches.begin(), patches.end(), [&](const auto& p) { return p.name == name; });
  };
  const auto& own = model.faces()[at(face)].data().name;
  if (!own.empty() && !is_taken(own)) return own;
  auto name = fmt::format("face_{}", face + 1);
  while (is_taken(name)) name += "_";
  return name;
}

/// Makes a patch of each face of the shape that faces of this patch lie on. Collective.
void split_patch(const par::Comm& comm, mesh::DistMesh& mesh, const CadModel& model, std::size_t patch,
                 std::vector<BoundaryFace>& faces) {
  auto& patches = mesh.info.patches;
  const auto n_faces = model.faces().size();
  const auto counts = count(comm, faces, patches.size(), n_faces);
  const auto* row = &counts[patch * (n_faces + 1)];
  bool is_free = row[n_faces] == 0;  // its number serves the first face
  std::vector<int> patch_of_face(n_faces, -1);
  for (std::size_t f = 0; f < n_faces; ++f) {
    if (row[f] == 0) continue;
    const auto name = name_of_face(model, static_cast<int>(f), patches);
    patch_of_face[f] = static_cast<int>(is_free ? patch : patches.size());
    if (is_free)
      patches[patch].name = name, patches[patch].kind.clear();
    else
      patches.push_back({name, ""});
    is_free = false;
  }
  for (auto& face : faces) {
    if (at(face.patch) != patch || face.face < 0) continue;
    face.patch = patch_of_face[at(face.face)];
    mesh.cell_to_cell[at(face.cell)][face.slot] = mesh::patch_to_slot(face.patch);
  }
}

/// What the sizes say about units, empty: nothing.
std::string hint_at_unit(double of_mesh, double of_shape, const std::string& unit) {
  const std::array<std::pair<const char*, double>, 6> known{
      {{"mm", 1}, {"cm", 10}, {"m", 1000}, {"um", 1e-3}, {"in", 25.4}, {"ft", 304.8}}};
  const auto* used =
      std::find_if(known.begin(), known.end(), [&](const auto& candidate) { return candidate.first == unit; });
  for (const auto& [name, length] : known) {
    const double ratio = of_shape * used->second / length / of_mesh;
    if (name != unit && ratio > 1 - like_a_unit && ratio < 1 + like_a_unit)
      return fmt::format("; the sizes agree if the coordinates of the mesh are in {0}: --unit {0}", name);
  }
  return {};
}

}  // namespace

std::vector<CadPatch> find_cad_faces(const par::Comm& comm, mesh::DistMesh& mesh, const CadModel& model,
                                     const geometry::CadSource& source, const CadSearch& search) {
  const double size = mesh::box_of_nodes(comm, mesh).diagonal();
  const double tolerance =
      search.tolerance < 0 ? std::max(usual_tolerance * size, model.largest_tolerance()) : search.tolerance;
  const auto is_named = [&](const std::string& patch) {
    return std::find(search.named.begin(), search.named.end(), patch) != search.named.end();
  };
  std::vector<bool> is_wanted;
  for (const auto& patch : mesh.info.patches) is_wanted.push_back(!is_named(patch.name));
  auto faces = find_faces(mesh, model, tolerance, is_wanted);
  const auto& patches = mesh.info.patches;
  const auto untagged = mesh::find_untagged(patches);
  if (untagged < patches.size() && !is_named(patches[untagged].name)) split_patch(comm, mesh, model, untagged, faces);

  const auto n_faces = model.faces().size();
  const auto counts = count(comm, faces, patches.size(), n_faces);
  std::vector<double> worst(patches.size(), 0);
  const FaceFinder finder(mesh, model, tolerance);
  for (const auto& face : faces)
    if (face.face < 0)
      worst[at(face.patch)] = std::max(worst[at(face.patch)], finder.worst_distance(face.cell, face.slot));
  comm.max_in_place(worst);

  std::vector<CadPatch> result;
  bool any = false;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (is_named(patches[p].name)) continue;
    CadPatch here{patches[p].name, {}, 0, counts[p * (n_faces + 1) + n_faces], worst[p]};
    for (std::size_t f = 0; f < n_faces; ++f) {
      if (counts[p * (n_faces + 1) + f] == 0) continue;
      here.faces.push_back(static_cast<int>(f + 1));
      here.n_on += counts[p * (n_faces + 1) + f];
    }
    any = any || here.n_on > 0;
    result.push_back(std::move(here));
  }
  if (!any)
    throw Error(
        fmt::format("--cad {}: expected boundary faces of the mesh on faces of the shape (within {:.3g}), found "
                    "none; the mesh is {:.4g} wide, the shape {:.4g}{}",
                    source.file, tolerance, size, model.size(), hint_at_unit(size, model.size(), search.unit)));
  return result;
}

}  // namespace pamr::meshing
