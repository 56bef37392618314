// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/mesh/ring.hpp"
#include "solvers/poisson_boltzmann/fem/problem.hpp"
#include "solvers/poisson_boltzmann/fem/quadrature.hpp"

/// The finite element space of a domain, of first or second order. An integral is written once, as a template of the
/// element; `with_element` chooses the element, and nothing else asks for the order but what truly differs.
///
/// Both elements have the same parts. A `Cell` or a `Face` calls `use(point)` for the points of its quadrature rule;
/// a point has the values of the shape functions there, its position, and the volume or area that it stands for
/// (`weight`, `area`). `field(values at all nodes)` is a function on the cell, with `at(point)` and `gradient(point)`.
/// All of it is local.
namespace pamr::poisson_boltzmann {

/// The values at the nodes of a cell or a face of what has these values at all nodes.
template <class T, std::size_t N>
std::array<T, N> at_nodes(const std::array<LocalId, N>& nodes, std::span<const T> value) {
  std::array<T, N> result{};
  for (std::size_t k = 0; k < N; ++k) result[k] = value[at(nodes[k])];
  return result;
}

template <std::size_t N>
std::array<geometry::Vec3, N> positions(const Domain& domain, const std::array<LocalId, N>& nodes) {
  return at_nodes<geometry::Vec3>(nodes, domain.point);
}

inline geometry::Vec3 interpolated(std::span<const double> shape, std::span<const LocalId> nodes,
                                   std::span<const geometry::Vec3> value) {
  geometry::Vec3 sum;
  for (std::size_t k = 0; k < shape.size(); ++k) sum += shape[k] * value[at(nodes[k])];
  return sum;
}

template <class Nodes>
bool is_constant(std::span<const double> value, const Nodes& nodes) {
  return std::all_of(nodes.begin(), nodes.end(), [&](LocalId node) { return value[at(node)] == value[at(nodes[0])]; });
}

/// A point of a boundary face with the values of its N functions there.
template <std::size_t N>
struct PointOnFace : PlacedFacePoint {
  std::array<double, N> value{};
  std::size_t index = 0;  ///< of the points of the rule
};

/// Four functions with constant gradients on straight cells. Rules: Gauss points of degree 2 in cells, of degree 4 on
/// faces; what walls hold is lumped at the corners of their faces, as the source term is with nodal quadrature.
class LinearElement {
 public:
  static constexpr std::size_t n_nodes = 4;
  static constexpr std::size_t n_left = 7;        ///< entries of a row left of the diagonal, about
  static constexpr bool has_lumped_walls = true;  ///< a node of a wall has an area, and its reaction is a density

  struct Point {
    const std::array<double, 4>& value;
    geometry::Vec3 position;
    geometry::Vec3 middle;  ///< of the cell: where a force applies
    double weight = 0;
    std::size_t index = 0;
  };

  struct Field {
    std::array<double, 4> value{};
    geometry::Vec3 slope;

    double at(const Point& point) const { return interpolated(point.value, value); }
    template <class AnyPoint>
    geometry::Vec3 gradient(const AnyPoint&) const {
      return slope;
    }
  };

  /// A cell for what needs no gradients.
  class Points {
   public:
    Points(const Domain& domain, std::size_t cell)
        : nodes(domain.mesh->cell_to_node[cell]), corner_(domain.points(cell)), volume(geometry::volume(corner_)) {}

    template <class Use>
    void at_points(const Use& use) const {
      geometry::Vec3 middle;
      for (const auto& corner : corner_) middle += 0.25 * corner;
      for (std::size_t g = 0; g < gauss_points.size(); ++g) {
        Point point{gauss_points[g].weight_of_corner, {}, middle, volume * gauss_points[g].weight, g};
        for (std::size_t k = 0; k < 4; ++k) point.position += point.value[k] * corner_[k];
        use(point);
      }
    }

    const mesh::CellNodes& nodes;

   private:
    geometry::TetPoints corner_;

   public:
    double volume;
  };

  class Cell : public Points {
   public:
    Cell(const Domain& domain, std::size_t cell) : Points(domain, cell), shape_(domain.shape(cell)) {}

    Field field(std::span<const double> value) const {
      Field result{at_nodes(nodes, value), {}};
      for (std::size_t k = 0; k < 4; ++k) result.slope += result.value[k] * shape_.gradient[k];
      return result;
    }
    /// Calls `use(weight, gradients)` for the points that products of two gradients take.
    template <class Use>
    void at_gradients(const Use& use) const {
      use(shape_.volume, shape_.gradient);
    }
    const std::array<geometry::Vec3, 4>& gradients() const { return shape_.gradient; }

   private:
    CellShape shape_;
  };

  class Face {
   public:
    Face(const Domain& domain, std::size_t face)
        : nodes(domain.faces[face].node), number(face), domain_(domain), face_(domain.faces[face]) {}

    using Point = PointOnFace<3>;
    template <class Use>
    void at_points(const Use& use) const {
      for (std::size_t p = 0; p < triangle_points.size(); ++p)
        use(point_at(triangle_points[p].weight_of_corner, triangle_points[p].weight * face_.area, p));
    }
    /// Calls `use(area)` for the parts that the area is the sum of.
    template <class Use>
    void at_areas(const Use& use) const {
      use(face_.area);
    }
    /// The points of the rule for what walls hold.
    template <class Use>
    void at_wall_points(const Use& use) const {
      constexpr std::array<std::array<double, 3>, 3> corner{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
      for (std::size_t p = 0; p < 3; ++p) use(point_at(corner[p], face_.area / 3, p));
    }
    std::array<double, 3> values(std::span<const double> value) const { return at_nodes(nodes, value); }
    /// A function on the cell behind, for its gradient at points of the face.
    Field behind(std::span<const double> value) const { return cell().field(value); }
    Cell cell() const { return {domain_, at(face_.cell)}; }
    /// The functions of the cell behind at a point of the face.
    std::array<double, 4> values_behind(const Point& point) const {
      std::array<double, 4> result{};
      const auto& corners = domain_.mesh->cell_to_node[at(face_.cell)];
      for (std::size_t k = 0; k < 3; ++k) result[at(mesh::slot_of(corners, nodes[k]))] = point.value[k];
      return result;
    }
    /// psi0 at a point, between its values at the nodes, which are exact at a plate; and its slope, the mean over the
    /// face: bounded where that at a plate is not.
    double split_potential(const Problem& problem, const Point& point) const {
      return interpolated(point.value, values(problem.conditions.psi0));
    }
    double split_slope(const Problem& problem, const Point&) const { return problem.split_slope(nodes); }

    const std::array<LocalId, 3>& nodes;
    std::size_t number;

   private:
    Point point_at(const std::array<double, 3>& value, double area, std::size_t index) const {
      Point point{{{}, face_.normal, area, {}}, value, index};
      for (std::size_t k = 0; k < 3; ++k) {
        point.position += value[k] * domain_.point[at(nodes[k])];
        point.middle += (1.0 / 3) * domain_.point[at(nodes[k])];
      }
      return point;
    }
    const Domain& domain_;
    const BoundaryFace& face_;
  };

  explicit LinearElement(const Domain& on) : domain(on) {}
  const std::vector<mesh::CellNodes>& cells() const { return domain.mesh->cell_to_node; }
  Cell cell(std::size_t number) const { return {domain, number}; }
  Points points(std::size_t cell) const { return {domain, cell}; }
  Face face(std::size_t number) const { return {domain, number}; }

  const Domain& domain;
};

/// Ten functions on curved or straight cells. Rules: degree 5 in cells, 6 on faces; nothing is lumped, as the lumped
/// masses of corners would be negative.
class QuadraticElement {
 public:
  static constexpr std::size_t n_nodes = 10, n_left = 14;
  static constexpr bool has_lumped_walls = false;

  struct Point {
    const OfCellNodes<double>& value;
    PlacedPoint placed;
    geometry::Vec3 position, middle;  ///< both the point
    double weight = 0;
    std::size_t index = 0;  ///< of `cell_points()`
  };

  struct Field {
    OfCellNodes<double> value{};

    double at(const Point& point) const { return interpolated(point.value, value); }
    geometry::Vec3 gradient(const Point& point) const { return gradient_of(point.placed, value); }
  };

  class Cell {
   public:
    Cell(const Domain& domain, std::size_t cell)
        : nodes(domain.quadratic->cell_to_node[cell]), position_(positions(domain, nodes)) {}

    Field field(std::span<const double> value) const { return {poisson_boltzmann::at_nodes(nodes, value)}; }
    template <class Use>
    void at_points(const Use& use) const {
      at_each(cell_points(), use);
    }
    /// The ten nodes as points, of no weight.
    template <class Use>
    void at_nodes(const Use& use) const {
      at_each(cell_nodes_as_points(), use);
    }
    template <class Use>
    void at_gradients(const Use& use) const {
      for (const auto& point : cell_points()) {
        const auto placed = place(position_, point);
        use(point.weight * placed.jacobian / 6, placed.gradient);
      }
    }

    const OfCellNodes<LocalId>& nodes;

   private:
    template <class Points, class Use>
    void at_each(const Points& points, const Use& use) const {
      for (std::size_t p = 0; p < points.size(); ++p) {
        const auto placed = place(position_, points[p]);
        const double weight = points[p].weight * placed.jacobian / 6;
        use(Point{points[p].value, placed, placed.position, placed.position, weight, p});
      }
    }
    OfCellNodes<geometry::Vec3> position_;
  };

  using Points = Cell;

  class Face {
   public:
    Face(const Domain& domain, std::size_t face)
        : nodes(domain.quadratic->face_to_node[face]),
          number(face),
          domain_(domain),
          cell_(at(domain.faces[face].cell)),
          position_(positions(domain, nodes)) {}

    using Point = PointOnFace<6>;
    struct FieldBehind {
      const Face& face;
      OfCellNodes<double> value{};

      geometry::Vec3 gradient(const Point& point) const {
        return gradient_of(face.placed_behind(face.point_behind(point)), value);
      }
    };
    template <class Use>
    void at_points(const Use& use) const {
      for (std::size_t p = 0; p < face_points().size(); ++p) {
        const auto& point = face_points()[p];
        use(Point{place(position_, point), point.value, p});
      }
    }
    template <class Use>
    void at_areas(const Use& use) const {
      at_points([&](const Point& point) { use(point.area); });
    }
    template <class Use>
    void at_wall_points(const Use& use) const {
      at_points(use);
    }
    OfFaceNodes<double> values(std::span<const double> value) const { return at_nodes(nodes, value); }
    FieldBehind behind(std::span<const double> value) const {
      return {*this, at_nodes(domain_.quadratic->cell_to_node[cell_], value)};
    }
    /// A point as the cell behind sees it, and that cell there.
    CellPoint point_behind(const Point& point) const {
      std::array<double, 4> l{};
      for (std::size_t k = 0; k < 3; ++k)
        l[at(mesh::slot_of(domain_.mesh->cell_to_node[cell_], nodes[k]))] = face_points()[point.index].barycentric[k];
      return cell_point(l);
    }
    PlacedPoint placed_behind(const CellPoint& point) const {
      return place(positions(domain_, domain_.quadratic->cell_to_node[cell_]), point);
    }
    double split_potential(const Problem& problem, const Point& point) const {
      return problem.split_potential(point.position.z);
    }
    double split_slope(const Problem& problem, const Point& point) const {
      return problem.split_slope(point.position.z);
    }

    const OfFaceNodes<LocalId>& nodes;
    std::size_t number;

   private:
    const Domain& domain_;
    std::size_t cell_;
    OfFaceNodes<geometry::Vec3> position_;
  };

  explicit QuadraticElement(const Domain& on) : domain(on) {}
  const std::vector<OfCellNodes<LocalId>>& cells() const { return domain.quadratic->cell_to_node; }
  Cell cell(std::size_t number) const { return {domain, number}; }
  Points points(std::size_t cell) const { return {domain, cell}; }
  Face face(std::size_t number) const { return {domain, number}; }

  const Domain& domain;
};

/// Returns `use(element)` with the element of the domain.
template <class Use>
decltype(auto) with_element(const Domain& domain, const Use& use) {
  if (domain.quadratic) return use(QuadraticElement(domain));
  return use(LinearElement(domain));
}

}  // namespace pamr::poisson_boltzmann
