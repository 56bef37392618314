// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pamr/geometry/cad/cad_model.hpp"
#include "pamr/geometry/shared_edges.hpp"
#include "pamr/geometry/surface.hpp"

namespace pamr::geometry {

/// Some faces of a CAD shape as one surface. Edges between two of them are its creases, smooth ones too: nodes on the
/// edges of a shape stay there. With other surfaces of the same shape it shares edges and corners, which are found by
/// their curves and not by intersecting surfaces: faces that are tangent at a fillet have no other curve.
class CadSurface final : public Surface, public Creases, public SharedEdges {
 public:
  /// Faces by number from 0. Throws `Error` for an empty list, for a number that is none and for one that stands twice.
  CadSurface(std::shared_ptr<const CadModel> model, std::vector<int> faces);

  Vec3 project(Vec3 point) const override { return nearest(point).foot.point; }
  Vec3 normal(Vec3 point) const override;
  double distance(Vec3 point) const override { return nearest(point).foot.distance; }
  /// Nearest point of the edges between its faces; of all its edges where there are none.
  Vec3 project_to_seam(Vec3 point) const override;
  const Creases* creases() const override { return inner_edges_.empty() ? nullptr : this; }
  int piece_at(Vec3 point) const override { return nearest(point).face; }
  std::optional<Vec3> crease_between(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const override;
  std::optional<Vec3> project_to_common(std::span<const Surface* const> surfaces, Vec3 point) const override;
  bool is_flat() const override;
  double magnitude() const override { return model_->magnitude(); }

  const CadModel& model() const { return *model_; }
  const std::shared_ptr<const CadModel>& shared_model() const { return model_; }
  const std::vector<int>& faces() const { return faces_; }

 private:
  struct Place {
    CadFoot foot;
    int face = -1;
  };
  Place nearest(Vec3 point) const;
  bool has(int face) const;
  /// Nearest point of these edges; `reachable_only`: of those that are longer than twice the way to them.
  std::optional<Vec3> nearest_of(const std::vector<int>& edges, Vec3 point, bool reachable_only) const;
  std::optional<Vec3> nearest_corner(std::span<const CadSurface* const> parts, Vec3 point) const;
  /// How far a triangle's middle lies from a face.
  double off_face(int face, Vec3 a, Vec3 b, Vec3 c) const;

  std::shared_ptr<const CadModel> model_;
  std::vector<int> faces_;        // ascending
  std::vector<int> edges_;        // around them, ascending
  std::vector<int> inner_edges_;  // between two of them, ascending
};

}  // namespace pamr::geometry
