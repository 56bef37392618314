// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/combination.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "meshing/bodies.hpp"
#include "meshing/cad_body.hpp"
#include "meshing/feature_curves.hpp"
#include "meshing/inside_grid.hpp"
#include "meshing/pieces.hpp"
#include "meshing/sided_pieces.hpp"
#include "meshing/size_sources.hpp"
#include "meshing/solid.hpp"
#include "meshing/thickness.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/triangulated/triangle_tree.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;

constexpr double triangle_error = 0.02;        // of the shortest wanted edge: how far triangles may lie off CAD faces
constexpr double default_least = 0.1;          // of `far`: edges that curvature asks for are not shorter
constexpr double min_thickness = 0.02;         // of `far`: edges in thin parts are not asked to be shorter
constexpr double thickness_spacing = 1.0 / 6;  // of `far`

/// Looks at a grid of points a little outside each side of the box.
void require_within_bounds(const Solid& solid, const std::string& where) {
  constexpr int n = 40;
  const Vec3 margin = 1e-3 * (solid.high - solid.low), low = solid.low - margin, high = solid.high + margin;
  const auto between = [](double a, double b, int i) { return a + (b - a) * i / n; };
  const auto require_outside = [&](Vec3 p) {
    if (solid.contains(p))
      throw Error(fmt::format("{}: expected bounds that hold the region{}, found ({:g}, {:g}, {:g}) in it", where,
                              solid.regions.size() > 1 ? "s" : "", p.x, p.y, p.z));
  };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      for (const bool above : {false, true}) {
        const Vec3 side = above ? high : low;
        require_outside({side.x, between(low.y, high.y, i), between(low.z, high.z, j)});
        require_outside({between(low.x, high.x, i), side.y, between(low.z, high.z, j)});
        require_outside({between(low.x, high.x, i), between(low.y, high.y, j), side.z});
      }
}

/// Looks at a grid of points in the box, and beside points of the surfaces, where thin parts of a region are: regions
/// may not overlap, and some of each must be there.
void require_some_within_bounds(const Solid& solid, const SurfaceSamples& samples, const std::string& where) {
  constexpr int n = 24;
  std::vector<bool> is_found(solid.regions.size(), false);
  const auto is_all_known = [&](Vec3 p) {  // of one region a point is enough
    const Sides sides = solid.sides(p);
    solid.require_apart(sides, p);
    const int region = solid.region_of(sides);
    if (region >= 0) is_found[at(region)] = true;
    return region >= 0 && is_found.size() == 1;
  };
  const Vec3 size = solid.high - solid.low;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        if (is_all_known(solid.low + Vec3{size.x * (i + 0.5) / n, size.y * (j + 0.5) / n, size.z * (k + 0.5) / n}))
          return;
  const geometry::Box box{solid.low, solid.high};
  for (int s = 0; s < solid.n_surfaces(); ++s)
    for (const Vec3 p : samples[at(s)]) {
      const Vec3 step = 1e-4 * solid.radius() * solid.surface(s).normal(p);
      for (const Vec3 q : {p + step, p - step})
        if (box.contains(q) && is_all_known(q)) return;
    }
  for (std::size_t r = 0; r < is_found.size(); ++r)
    if (!is_found[r])
      throw Error(fmt::format("{}: expected bounds around a part of the region{}, found none of it in them", where,
                              solid.region_names.empty() ? "" : " " + solid.region_names[r]));
}

/// What edges in a gap are bounded to: `factor` times the least sum of the distances from two surfaces whose normals
/// there are within 45 degrees of each other in either sense; at least a sixteenth of `size`.
double bounded_by_gaps(const geometry::SurfaceSet& surfaces, double factor, Vec3 p, double size) {
  constexpr double min_cosine = 0.7071, min_part = 1.0 / 16;
  std::vector<std::pair<double, Vec3>> near;
  for (const auto& surface : surfaces.surface)
    if (const double distance = surface->distance(p); factor * distance < size)
      near.emplace_back(distance, surface->normal(p));
  double bound = size;
  for (std::size_t i = 0; i < near.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::abs(geometry::dot(near[i].second, near[j].second)) > min_cosine)
        bound = std::min(bound, factor * (near[i].first + near[j].first));
  return std::max(bound, min_part * size);
}

using Thicknesses = std::vector<Thickness>;

/// Sizes by the curvature of CAD shapes and, where that is asked for, by their thickness.
SizeSources cad_sources(const Solid& solid, const Combination& c, const Thicknesses& thickness) {
  std::vector<SizeSources::Source> all;
  const double least = c.least > 0 ? c.least : default_least * c.far;
  for (int i = 0; i < solid.n_surfaces(); ++i)
    if (const auto* body = dynamic_cast<const CadBody*>(&solid.surface(i))) {
      const auto own = curvature_sizes(body->model(), c.curvature, least, c.far);
      all.insert(all.end(), own.begin(), own.end());
    }
  for (const auto& place : thickness)
    if (const double size = std::max(c.thickness_factor * place.thickness, min_thickness * c.far);
        c.thickness_factor > 0 && size < c.far)
      all.push_back({place.point, size});
  return {std::move(all), c.growth};
}

std::function<double(Vec3)> size_field(const std::shared_ptr<const Solid>& solid, const Combination& c,
                                       const Thicknesses& thickness, const std::string& where) {
  std::vector<std::pair<const geometry::Surface*, double>> near;
  for (const auto& [name, size] : c.near) {
    const auto* surface = c.surfaces->find(name);
    if (surface == nullptr)
      throw Error(fmt::format("{}: expected the name of a surface for a size, found \"{}\"", where, name));
    near.emplace_back(surface, size);
  }
  const auto curvature = std::make_shared<const SizeSources>(cad_sources(*solid, c, thickness));
  return
      [solid, surfaces = c.surfaces, near, curvature, far = c.far, growth = c.growth, factor = c.gap_factor](Vec3 p) {
        double size = curvature->at(p, far);
        for (const auto& [surface, here] : near)
          if (here < size) size = std::min(size, here + growth * std::max(0.0, surface->distance(p) - here));
        return factor > 0 ? bounded_by_gaps(*solid->surfaces, factor, p, size) : size;
      };
}

/// Answers how far points are from those of curves; infinite where there are none.
class DistanceFromCurves {
 public:
  explicit DistanceFromCurves(const std::vector<FeatureCurve>& curves) {
    for (const auto& curve : curves)
      for (const Vec3 p : curve.polyline) points_.push_back({p, p, p});
    if (!points_.empty()) tree_.emplace(points_);
  }
  double operator()(Vec3 p) const {
    if (!tree_) return std::numeric_limits<double>::infinity();
    return geometry::norm(p - points_[at(tree_->nearest(p).triangle)][0]);
  }

 private:
  std::vector<std::array<Vec3, 3>> points_;  // as triangles
  std::optional<geometry::TriangleTree> tree_;
};

/// Of points on a piece those far from each other and from the curves: no nearer than edges are wanted there, but at
/// least six where there are so many and no curve is near, and at most `most`.
std::vector<Vec3> scattered_points(const std::vector<Vec3>& candidates, const std::vector<double>& from_curves,
                                   bool has_curves, const std::function<double(Vec3)>& size) {
  constexpr std::size_t least = 6, most = 60;
  std::vector<Vec3> chosen;
  auto distance = from_curves;
  while (!candidates.empty() && chosen.size() < most) {
    const auto farthest = std::max_element(distance.begin(), distance.end());
    const Vec3 p = candidates[static_cast<std::size_t>(farthest - distance.begin())];
    if (*farthest == 0 || ((chosen.size() >= least || has_curves) && *farthest < size(p))) break;
    chosen.push_back(p);
    for (std::size_t k = 0; k < candidates.size(); ++k)
      distance[k] = std::min(distance[k], geometry::norm(candidates[k] - p));
  }
  return chosen;
}

/// Tips of CAD shapes that bound the solid, with points around them so that the first facets enclose them.
void add_tips(const Solid& solid, const SidedPieces& pieces, Domain& domain) {
  constexpr std::array<double, 2> ring{1.3, 2.2};  // distance over size
  constexpr int n_around = 4;
  for (int i = 0; i < solid.n_surfaces(); ++i)
    if (const auto* body = dynamic_cast<const CadBody*>(&solid.surface(i)))
      for (const auto& tip : body->tips()) {
        if (!solid.divides(i, solid.sides(tip.point))) continue;
        domain.tips.push_back(tip.point);
        for (std::size_t r = 0; r < ring.size(); ++r)
          for (int k = 0; k < n_around; ++k) {
            const auto p = body->around(tip, (k + 0.5 * static_cast<double>(r) + 0.25) / n_around,
                                        ring[r] * domain.size(tip.point));
            if (const int piece = pieces.at_point(i, p); piece >= 0) domain.pieces[at(piece)].start.push_back(p);
          }
      }
}

/// Gives pieces points to start from: those that no curve touches, all where curves lie in one plane, and faces of CAD
/// shapes, which may be small and far from their curves.
void add_starts(const Solid& solid, const Pieces& pieces, const SidedPieces& sided, const SurfaceSamples& samples,
                Domain& domain) {
  std::vector<std::vector<Vec3>> candidates(domain.pieces.size());
  for (int i = 0; i < solid.n_surfaces(); ++i) {
    const auto add = [&](Vec3 p) {
      if (const int piece = sided.at_point(i, p); piece >= 0) candidates[at(piece)].push_back(p);
    };
    for (const Vec3 p : samples[at(i)]) add(p);
    if (const auto* body = dynamic_cast<const CadBody*>(&solid.surface(i)))
      body->for_each_sample([&](int, Vec3 p) { add(p); });
  }
  const DistanceFromCurves distance_from_curves(domain.curves);
  for (std::size_t k = 0; k < domain.pieces.size(); ++k) {
    const auto& piece = pieces.at(sided.all()[k].piece);
    const bool is_cad = dynamic_cast<const CadBody*>(&solid.surface(piece.surface)) != nullptr;
    const bool has_curve =
        is_cad || std::any_of(domain.curves.begin(), domain.curves.end(), [&](const auto& curve) {
          return piece.shape->distance(curve.polyline[curve.polyline.size() / 2]) < 1e-9 * solid.radius();
        });
    if (has_curve && !domain.points_first && !is_cad) continue;
    std::vector<double> distance;
    for (const Vec3 p : candidates[k])
      distance.push_back(has_curve ? distance_from_curves(p) : std::numeric_limits<double>::infinity());
    domain.pieces[k].start =
        scattered_points(candidates[k], distance, has_curve && !domain.curves.empty(), domain.size);
  }
  add_tips(solid, sided, domain);
}

/// True when all points of the curves lie in one plane, to 1e-6 of the radius.
bool are_in_one_plane(const std::vector<FeatureCurve>& curves, double radius) {
  std::vector<Vec3> points;
  for (const auto& curve : curves) points.insert(points.end(), curve.polyline.begin(), curve.polyline.end());
  if (points.empty()) return false;
  const auto farthest = [&](auto&& distance) {
    return *std::max_element(points.begin(), points.end(), [&](Vec3 a, Vec3 b) { return distance(a) < distance(b); });
  };
  const Vec3 a = points.front(), b = farthest([&](Vec3 p) { return geometry::norm(p - a); });
  const auto square_to_line = [&](Vec3 p) { return geometry::cross(b - a, p - a); };
  const Vec3 normal = square_to_line(farthest([&](Vec3 p) { return geometry::norm(square_to_line(p)); }));
  const double length = geometry::norm(normal);
  return std::all_of(points.begin(), points.end(),
                     [&](Vec3 p) { return std::abs(geometry::dot(p - a, normal)) <= 1e-6 * radius * length; });
}

/// Pieces of the domain, and patches: one for each piece or each named part, which may have several, or for each CAD
/// surface, which may have several faces.
void add_pieces(const std::shared_ptr<const Pieces>& pieces, const SidedPieces& sided_pieces, const Bodies& bodies,
                const Combination& c, Domain& domain) {
  std::vector<int> patch_of_surface(c.surfaces->name.size(), -1);
  for (const auto& sided : sided_pieces.all()) {
    const auto& piece = pieces->at(sided.piece);
    const auto& surface_of_face = bodies.surface_of_face[at(piece.surface)];
    int patch = static_cast<int>(domain.patches.size());
    if (surface_of_face.empty()) {
      const auto same = std::find_if(domain.patches.begin(), domain.patches.end(), [&](const mesh::Patch& known) {
        return known.name == piece.name && known.surface == bodies.first[at(piece.surface)];
      });
      patch = static_cast<int>(same - domain.patches.begin());
      if (same == domain.patches.end()) {
        const int surface = bodies.first[at(piece.surface)];
        domain.patches.push_back({piece.name, "patch", surface});
        if (!piece.part.empty() && piece.name != piece.part)
          domain.notes.push_back(
              fmt::format("surface \"{}\": \"{}\" of its file is the patch '{}', because another patch has that name",
                          c.surfaces->name[at(surface)], piece.part, piece.name));
      }
    } else {
      const int surface = surface_of_face[at(std::max(0, piece.number))];
      auto& known = patch_of_surface[at(surface)];
      if (known < 0) domain.patches.push_back({c.surfaces->name[at(surface)], "patch", surface});
      patch = known = known < 0 ? patch : known;
    }
    domain.pieces.push_back({patch, [pieces, shape = piece.shape](Vec3 p) { return shape->project(p); }});
    domain.pieces.back().region = sided.region;
    if (!c.regions.name.empty()) domain.pieces.back().region = c.regions.of_face[at(std::max(0, piece.number))];
  }
}

std::vector<std::array<Vec3, 3>> corners_of(const geometry::Triangulation& surface) {
  std::vector<std::array<Vec3, 3>> result;
  for (const auto& [a, b, c] : surface.triangles)
    result.push_back({surface.points[at(a)], surface.points[at(b)], surface.points[at(c)]});
  return result;
}

/// Triangles on a closed surface: of a CAD shape, or those that it was made of; nothing for any other.
std::vector<std::array<Vec3, 3>> triangles_on(const Solid& solid, int i, const geometry::SurfaceSet& surfaces) {
  if (const auto* body = dynamic_cast<const CadBody*>(&solid.surface(i))) return body->triangles();
  for (const auto& triangulation : surfaces.triangulations)
    if (triangulation->name == solid.name(i)) return corners_of(*triangulation);
  return {};
}

/// How thick bodies are behind the surfaces that bound a solid on their inner side: those of CAD and of triangles.
Thicknesses thicknesses_of(const Solid& solid, const Combination& c) {
  constexpr int max_places_on_triangles = 4000;  // their distances take longer
  Thicknesses all;
  for (int i = 0; i < solid.n_surfaces(); ++i) {
    const auto bounds_inside = [&](Vec3 p) {
      const Sides inside = solid.sides(p) & ~(Sides{1} << i);
      return solid.region_of(inside) >= 0 && solid.divides(i, inside);
    };
    auto triangles = triangles_on(solid, i, *c.surfaces);
    std::erase_if(triangles, [&](const auto& t) { return !bounds_inside((1.0 / 3) * (t[0] + t[1] + t[2])); });
    ThicknessOptions options{.spacing = thickness_spacing * c.far, .most = c.far};
    if (dynamic_cast<const CadBody*>(&solid.surface(i)) == nullptr) options.max_places = max_places_on_triangles;
    for (const auto& place : thicknesses(solid.surface(i), triangles, options))
      if (bounds_inside(place.point)) all.push_back(place);
  }
  return all;
}

/// Finds the thinnest place for the sizes, and how many nodes edges and thin faces need.
void measure_boundary(const Thicknesses& thickness, Domain& domain) {
  constexpr double even_triangle = 0.866;  // area of a node among even triangles over the square of their edges
  for (const auto& place : thickness) {
    const double size = domain.size(place.point), edge = std::min(size, place.thickness);
    domain.boundary_nodes += place.area / (even_triangle * edge * edge);
    const bool is_thinner = domain.thin.size == 0 || place.thickness < domain.thin.thickness;
    if (place.thickness < size && is_thinner) domain.thin = {place.point, place.thickness, size};
  }
  for (const auto& curve : domain.curves)
    for (std::size_t i = 1; i < curve.polyline.size(); ++i) {
      const Vec3 a = curve.polyline[i - 1], b = curve.polyline[i];
      domain.boundary_nodes += norm(b - a) / domain.size(midpoint(a, b));
    }
}

/// The CAD shape that is the only surface of a solid, if the solid is its inside; else null.
const CadBody* only_body(const Solid& solid) {
  if (solid.n_surfaces() != 1 || solid.region_of(0) < 0 || solid.region_of(1) >= 0) return nullptr;
  return dynamic_cast<const CadBody*>(&solid.surface(0));
}

/// Names and volumes of the regions, and the volume of all where the domain is the inside of a CAD shape.
void add_regions(const Solid& solid, const Combination& c, Domain& domain) {
  const auto& regions = c.regions;
  int n = 0;
  const auto add = [&](const std::string& name) {
    const auto same = std::find_if(domain.regions.begin(), domain.regions.end(),
                                   [&](const DomainRegion& known) { return known.name == name; });
    domain.regions.push_back({name, same == domain.regions.end() ? ++n : same->number});
  };
  for (const auto& name : regions.name) add(name);
  for (const auto& part : c.parts) add(part.name);
  const auto* body = only_body(solid);
  if (body == nullptr) return;
  for (std::size_t s = 0; s < body->volumes().size(); ++s) {
    domain.volume += body->volumes()[s];
    if (!domain.regions.empty())
      domain.regions[regions.name.empty() ? 0 : at(regions.of_solid[s])].volume += body->volumes()[s];
  }
}

/// Sets `Domain::label` and `Domain::around`.
void add_labels(const std::shared_ptr<const Solid>& solid, const std::shared_ptr<const Pieces>& pieces,
                const std::shared_ptr<const SidedPieces>& sided, const AssemblyRegions& regions, Domain& domain) {
  const auto* body = regions.name.empty() ? nullptr : only_body(*solid);
  std::function<int(Vec3)> in_body;  // null: the sides say the region
  if (body != nullptr)
    in_body = [solid, body, of_solid = regions.of_solid](Vec3 p) {
      const int inside = body->solid_at(p);
      return inside >= 0 ? of_solid[at(inside)] : -1;
    };
  const auto deep = InsideGrid::is_exact_for(*solid) ? std::make_shared<InsideGrid>(solid, in_body) : nullptr;
  if (deep)
    domain.around = [solid, deep, in_body](Vec3 p) {
      if (const auto known = deep->around(p); known.region >= 0) return known;
      const auto found = solid->sides_around(p);
      return Domain::Ball{in_body ? in_body(p) : solid->region_of(found.sides), found.radius, p};
    };
  domain.label = [solid, pieces, sided, deep, body, in_body](Vec3 p) {
    if (const int region = deep ? deep->region_at(p) : -1; region >= 0) return Domain::in_region(region);
    if (in_body) {
      const int region = in_body(p);
      return region >= 0 ? Domain::in_region(region) : pieces->of_part(0, body->outer_piece_at(p));
    }
    const auto place = solid->place(p);
    return place.surface < 0 ? Domain::in_region(place.region) : sided->behind(place, p);
  };
}

double shortest_edge(const Combination& c) {
  double least = c.far;
  for (const auto& [name, size] : c.near) least = std::min(least, size);
  return least;
}

}  // namespace

bool Combination::has_cad() const {
  return std::any_of(surfaces->surface.begin(), surfaces->surface.end(), [](const auto& surface) {
    return dynamic_cast<const geometry::CadSurface*>(surface.get()) != nullptr;
  });
}

std::vector<Region> regions_of(const Combination& c, const std::string& where) {
  const auto& names = c.surfaces->name;
  const auto side_of = sides_of(*c.surfaces);
  if (c.parts.empty()) return {Region(c.region, names, side_of, where)};
  std::vector<Region> result;
  Sides used = 0;
  for (const auto& part : c.parts) {
    result.push_back(Region::among_others(part.sides, names, side_of, part.at));
    used |= result.back().used();
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    if ((used >> side_of[i] & 1U) == 0)
      throw Error(fmt::format("{}: expected every surface in a region, found \"{}\" in none", where, names[i]));
  return result;
}

Domain combine(const Combination& c, const std::string& where) {
  auto regions = regions_of(c, where);
  const auto with_place = [&where](auto&& make) {
    try {
      return make();
    } catch (const Error& error) {
      const std::string message = error.what();
      throw Error(message.starts_with(where + ":") ? message : where + ": " + message);
    }
  };
  const auto bodies = with_place([&] { return join_bodies(*c.surfaces, triangle_error * shortest_edge(c)); });
  std::vector<std::string> region_names;
  for (const auto& part : c.parts) region_names.push_back(fmt::format("\"{}\" ({})", part.name, part.at));
  const auto solid = std::make_shared<const Solid>(Solid{bodies.set, std::move(regions), c.low, c.high, region_names});
  const auto samples = sample_surfaces(*solid);
  const auto pieces = with_place([&] { return std::make_shared<const Pieces>(solid, samples); });
  require_within_bounds(*solid, where);
  with_place([&] { return require_some_within_bounds(*solid, samples, where); });
  Domain domain;
  domain.curves = with_place([&] { return trace_feature_curves(solid, pieces, samples); });
  for (auto& crease : pieces->creases()) domain.curves.push_back(std::move(crease));
  const auto sided =
      with_place([&] { return std::make_shared<const SidedPieces>(solid, pieces, samples, domain.curves); });
  add_labels(solid, pieces, sided, c.regions, domain);
  const auto thickness = thicknesses_of(*solid, c);
  domain.size = size_field(solid, c, thickness, where);
  add_regions(*solid, c, domain);
  add_pieces(pieces, *sided, bodies, c, domain);
  measure_boundary(thickness, domain);
  domain.points_first = are_in_one_plane(domain.curves, solid->radius());
  add_starts(*solid, *pieces, *sided, samples, domain);
  if (!domain.tips.empty()) domain.points_first = false;  // nor are the balls
  domain.surfaces = c.surfaces;
  domain.length_unit = c.length_unit;
  domain.center = solid->center();
  domain.radius = 1.05 * solid->radius();
  return domain;
}

}  // namespace pamr::meshing
