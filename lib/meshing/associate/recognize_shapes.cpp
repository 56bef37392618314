// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/associate/recognize_shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "meshing/associate/patch_sample.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/surface.hpp"

namespace pamr::meshing {

namespace {

using geometry::FittedShape;
using geometry::ShapeKind;
using geometry::Vec3;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t n_kinds = geometry::shape_kinds.size();

/// A fit as it goes from the rank that made it to all: place, axis, radius, radius of the tube, and minus the largest
/// distance; minus infinity where there is none.
constexpr std::size_t n_of_fit = 9;

/// The fits of all kinds for all patches, on every rank. Collective: one sparse exchange and one reduction.
std::vector<double> fit_all(const par::Comm& comm, const std::vector<PatchFace>& faces,
                            const std::vector<std::int64_t>& n_faces) {
  std::vector<double> fits(n_faces.size() * n_kinds * n_of_fit, -infinity);
  for (const auto& [patch, point, normal] : sample_patches(comm, faces, n_faces))
    for (std::size_t k = 0; k < n_kinds; ++k) {
      const auto found = geometry::fit_shape(geometry::shape_kinds[k], point, normal);
      if (!found) continue;
      const auto& s = found->shape;
      const std::array<double, n_of_fit> row{s.place.x, s.place.y, s.place.z, s.axis.x,     s.axis.y,
                                             s.axis.z,  s.radius,  s.of_tube, -found->worst};
      std::copy(row.begin(), row.end(), &fits[(at(patch) * n_kinds + k) * n_of_fit]);
    }
  comm.max_in_place(fits);
  return fits;
}

/// The kind that fits, if it is one alone: others must fit a hundred times worse, beyond rounding. -1: none.
int kind_that_fits(const double* fits, double size) {
  std::array<double, n_kinds> worst{};
  for (std::size_t k = 0; k < n_kinds; ++k) worst[k] = -fits[k * n_of_fit + n_of_fit - 1];
  const auto best = static_cast<std::size_t>(std::min_element(worst.begin(), worst.end()) - worst.begin());
  if (!(worst[best] < infinity)) return -1;
  const double rival = std::max(100 * worst[best], 1e-12 * size);
  const auto n = std::count_if(worst.begin(), worst.end(), [&](double w) { return w <= rival; });
  return n == 1 ? static_cast<int>(best) : -1;
}

FittedShape shape_from(int kind, const double* fit) {
  return {static_cast<ShapeKind>(kind), {fit[0], fit[1], fit[2]}, {fit[3], fit[4], fit[5]}, fit[6], fit[7]};
}

/// A shape that a patch may fit, and what its faces say.
struct Candidate {
  FittedShape shape;
  geometry::DescribedSurface described;
  double size = 0;
  double worst_distance = 0, worst_turn = 0;  // the latter is 1 - cosine
  double turn_of_normals = 1;                 // its part that normals show: those of a flat cone hardly turn
  std::int64_t n_exact = 0;                   // corners of faces within `certain_distance`
  bool faces_outward = false, faces_inward = false, is_unexplained = false;
};

/// Whether the face's normal is off the shape's at its corner k by no more than its edges explain: along an edge of
/// length l the shape rises by l * curvature / 2, and a face of corner angle t tilts by what its two edges rise, over
/// sin t.
bool is_explained(const PatchFace& face, std::size_t k, double cosine, double curvature) {
  constexpr double margin = 1.5, rounding = 1e-6;
  const Vec3 p = face.corner[k], a = face.corner[(k + 1) % 3] - p, b = face.corner[(k + 2) % 3] - p;
  const double la = norm(a), lb = norm(b), sine = norm(cross(a, b)) / (la * lb);
  const double tangent = std::sqrt(std::max(1 - cosine * cosine, 0.0)) / cosine;
  return tangent <= margin * 0.5 * curvature * (la + lb) / sine + rounding;
}

void look_at(const PatchFace& face, Candidate& candidate) {
  const auto& surface = *candidate.described.surface;
  Vec3 of_face = cross(face.corner[1] - face.corner[0], face.corner[2] - face.corner[0]);
  of_face = (1 / norm(of_face)) * of_face;
  std::array<Vec3, 3> normal;
  std::array<bool, 3> is_tip{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 p = face.corner[k];
    const double off = surface.distance(p);
    candidate.worst_distance = std::max(candidate.worst_distance, off);
    if (off <= certain_distance * candidate.size) ++candidate.n_exact;
    const double curvature = candidate.shape.curvature(p);
    is_tip[k] = curvature * candidate.size > 1e5;  // of a cone: it has no normal there
    if (is_tip[k]) continue;
    normal[k] = surface.normal(p);
    const double cosine = dot(normal[k], of_face);
    (cosine > 0 ? candidate.faces_outward : candidate.faces_inward) = true;
    if (!is_explained(face, k, std::abs(cosine), curvature)) candidate.is_unexplained = true;
  }
  for (std::size_t k = 0; k < 3; ++k)
    if (const auto next = (k + 1) % 3; !is_tip[k] && !is_tip[next])
      candidate.worst_turn =
          std::max(candidate.worst_turn, (1 - dot(normal[k], normal[next])) / candidate.turn_of_normals);
}

/// Puts together what the ranks have seen. Collective: two reductions.
void agree_on(const par::Comm& comm, std::vector<std::pair<int, Candidate>>& candidates) {
  std::vector<double> worst;
  std::vector<std::int64_t> count;
  for (const auto& [patch, c] : candidates) {
    worst.insert(worst.end(), {c.worst_distance + 0.0, c.worst_turn + 0.0});
    for (const bool flag : {c.faces_outward, c.faces_inward, c.is_unexplained}) count.push_back(flag ? 1 : 0);
    count.push_back(c.n_exact);
  }
  comm.max_in_place(worst);
  comm.sum_in_place(count);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    auto& c = candidates[i].second;
    c.worst_distance = worst[2 * i];
    c.worst_turn = worst[2 * i + 1];
    c.faces_outward = count[4 * i] > 0;
    c.faces_inward = count[4 * i + 1] > 0;
    c.is_unexplained = count[4 * i + 2] > 0;
    c.n_exact = count[4 * i + 3];
  }
}

double turn_for(double degrees) { return 1 - std::cos(degrees * std::numbers::pi / 180); }

/// Diagonals of the patches' boxes. Collective: one reduction.
std::vector<double> sizes_of(const par::Comm& comm, const std::vector<PatchFace>& faces, std::size_t n_patches) {
  std::vector<double> bound(6 * n_patches, -infinity);
  for (const auto& face : faces)
    for (const auto& p : face.corner)
      for (std::size_t k = 0; k < 3; ++k) {
        auto* row = &bound[6 * at(face.patch)];
        row[k] = std::max(row[k], p[k] + 0.0);
        row[3 + k] = std::max(row[3 + k], 0.0 - p[k]);
      }
  comm.max_in_place(bound);
  std::vector<double> sizes;
  for (std::size_t p = 0; p < n_patches; ++p) {
    const auto* row = &bound[6 * p];
    sizes.push_back(norm(Vec3{row[0] + row[3], row[1] + row[4], row[2] + row[5]}));
  }
  return sizes;
}

}  // namespace

std::vector<RecognizedShape> recognize_shapes(const par::Comm& comm, const mesh::DistMesh& mesh,
                                              const std::vector<bool>& is_wanted) {
  if (std::find(is_wanted.begin(), is_wanted.end(), true) == is_wanted.end()) return {};
  const auto faces = faces_of_patches(mesh, is_wanted);
  std::vector<std::int64_t> n_faces(is_wanted.size(), 0);
  for (const auto& face : faces) ++n_faces[at(face.patch)];
  comm.sum_in_place(n_faces);
  const auto size = sizes_of(comm, faces, is_wanted.size());
  const auto fits = fit_all(comm, faces, n_faces);

  std::vector<std::pair<int, Candidate>> candidates;
  std::vector<int> row(is_wanted.size(), -1);
  par::agree(comm, [&] {
    for (std::size_t p = 0; p < is_wanted.size(); ++p) {
      const auto* of_patch = &fits[p * n_kinds * n_of_fit];
      const int kind = kind_that_fits(of_patch, size[p]);
      if (kind < 0) continue;
      Candidate candidate;
      candidate.shape = shape_from(kind, of_patch + at(kind) * n_of_fit);
      candidate.size = size[p];
      if (candidate.shape.kind == ShapeKind::cone)
        candidate.turn_of_normals = std::cos(candidate.shape.radius) * std::cos(candidate.shape.radius);
      candidate.described = geometry::described_shape(mesh.info.patches[p].name, candidate.shape);
      row[p] = static_cast<int>(candidates.size());
      candidates.emplace_back(static_cast<int>(p), std::move(candidate));
    }
  });
  for (const auto& face : faces)
    if (const int r = row[at(face.patch)]; r >= 0) look_at(face, candidates[at(r)].second);
  agree_on(comm, candidates);

  std::vector<RecognizedShape> result;
  for (auto& [patch, c] : candidates) {
    if (c.worst_distance > suggested_distance * c.size || c.worst_turn > turn_for(suggested_turn)) continue;
    if ((c.faces_outward && c.faces_inward) || c.is_unexplained) continue;
    const auto n = n_faces[at(patch)];
    const double degrees = std::acos(std::max(1 - c.worst_turn, -1.0)) * 180 / std::numbers::pi;
    result.push_back({patch, c.shape, std::move(c.described), n, c.worst_distance, degrees,
                      4 * c.n_exact >= 3 * (3 * n) && c.worst_turn <= turn_for(certain_turn(c.shape.kind))});
  }
  return result;
}

}  // namespace pamr::meshing
