// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "meshing/closed_triangles.hpp"
#include "meshing/divided_surface.hpp"
#include "pamr/geometry/cad/cad_model.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"
#include "pamr/geometry/cad/read_cad.hpp"
#include "pamr/geometry/triangulated/triangle_tree.hpp"

namespace pamr::meshing {

/// A closed CAD shape as one surface with an inside: nearest points are those of the faces, sides those of triangles on
/// them. Its pieces are the faces; its lines are the edges between faces. The solids of an assembly
/// (`geometry::CadAssembly`) may share faces: inside is what lies in any of them, and distances are those from the
/// faces between them, too.
class CadBody final : public geometry::Surface, public DividedSurface {
 public:
  /// `longest_error`: how far the triangles may lie off the faces, length units. Throws `Error` for a shape that is not
  /// closed, solids that are not clear of one another, and faces beside solids.
  CadBody(std::shared_ptr<const geometry::CadModel> model, double longest_error);

  geometry::Vec3 project(geometry::Vec3 point) const override { return faces_.project(point); }
  /// At a face between two solids it points out of the one that the point lies in.
  geometry::Vec3 normal(geometry::Vec3 point) const override;
  double distance(geometry::Vec3 point) const override { return faces_.distance(point); }
  /// From the triangles.
  double signed_distance(geometry::Vec3 point) const override;
  double magnitude() const override { return faces_.magnitude(); }

  std::size_t n_pieces() const override { return model_->faces().size(); }
  std::shared_ptr<const geometry::Surface> piece(int number) const override;
  int piece_at(geometry::Vec3 point) const override;
  void for_each_sample(const std::function<void(int, geometry::Vec3)>& use) const override;
  std::size_t n_lines() const override { return line_.size(); }
  const std::vector<geometry::Vec3>& line(std::size_t number) const override { return line_[number].point; }
  geometry::Vec3 nearest_on_line(std::size_t number, geometry::Vec3 point) const override;
  std::vector<int> pieces_of_line(std::size_t number) const override { return line_[number].face; }

  const geometry::CadModel& model() const { return *model_; }
  /// Of each solid; none for a closed shape without solids.
  const std::vector<double>& volumes() const { return volume_; }

  /// The solid of an assembly that a point lies in, -1 outside. On a face between two it is one of them.
  int solid_at(geometry::Vec3 point) const;
  /// The piece nearest to a point among those that have no solid on their outside.
  int outer_piece_at(geometry::Vec3 point) const;

  /// Triangles on the faces, counter-clockwise seen from outside; those between two solids twice.
  std::vector<std::array<geometry::Vec3, 3>> triangles() const;

  /// A pole at which a face has no normal: the apex of a cone.
  struct Tip {
    int face = 0;
    geometry::Vec3 point;
    bool along_u = true;  ///< lines of constant u, otherwise of constant v, end in it
    bool at_low = true;   ///< at the lower end of their other parameter
  };
  const std::vector<Tip>& tips() const { return tip_; }
  /// A point of the face `distance` from the tip, on the line at `part` of the way around it from the seam.
  geometry::Vec3 around(const Tip& tip, double part, double distance) const;

 private:
  struct Line {
    int edge = 0;
    std::vector<int> face;
    std::vector<geometry::Vec3> point;
  };
  void add_inside(std::span<const std::array<int, 3>> corner, std::span<const int> face);
  void add_solids(const geometry::CadSolids& solids);
  bool is_between_solids(int face) const { return second_solid_[static_cast<std::size_t>(face)] >= 0; }
  void add_lines(double longest_error);
  void find_tips();

  std::shared_ptr<const geometry::CadModel> model_;
  geometry::CadSurface faces_;
  std::vector<double> volume_;
  std::vector<Line> line_;
  std::vector<Tip> tip_;
  // of the triangles
  std::vector<int> face_;
  std::vector<std::array<int, 3>> corner_;
  std::vector<geometry::Vec3> point_;
  std::vector<ClosedTriangles> inside_;  ///< of each solid of an assembly, else of all
  // of an assembly
  std::vector<int> second_solid_;  ///< by face, -1: it has one solid only
  std::unique_ptr<const geometry::TriangleTree> all_, outer_;
  std::vector<int> outer_face_;  ///< of the triangles of `outer_`
};

/// Throws `Error` where there are some: faces beside solids bound nothing.
void require_no_loose_faces(std::size_t n_solids, const std::vector<geometry::CadLooseFace>& loose);

}  // namespace pamr::meshing
