// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/make_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "meshing/flip_between.hpp"
#include "meshing/mesh3.hpp"
#include "meshing/order_raw_mesh.hpp"
#include "meshing/peel.hpp"
#include "meshing/repair/find_wall_ears.hpp"
#include "meshing/repair/open_wall_ears.hpp"
#include "meshing/snap.hpp"
#include "meshing/to_block_mesh.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/check/tears.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/triangulated/self_intersection.hpp"
#include "pamr/geometry/triangulated/shells.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::meshing {
namespace {

constexpr double thin_factor = 1.5;  // longest edges over the thickness that need no word

/// A factor of sizes, 0.97 to 1.03, that has no symmetry. Equal edges at a corner of two regions would put four nodes
/// of the plane between them on one circle: they make a flat cell, whose middle may be far away and outside, so that
/// CGAL takes its faces for a boundary and refines them until rounding ends it.
double unevenness(const Domain& domain, geometry::Vec3 p) {
  if (domain.regions.empty()) return 1;
  const auto q = (1 / domain.radius) * (p - domain.center);
  return 1 + 0.01 * (std::sin(7.1 * q.x) + std::sin(8.3 * q.y + 1) + std::sin(9.7 * q.z + 2));
}

/// What CGAL makes of a domain, with sizes that are 3 % smaller or larger where it fails with those that were asked
/// for.
RawMesh mesh_interior(const Domain& domain, unsigned seed, const Listener& listener) {
  Mesh3Watch watch;
  watch.progress = [&](std::int64_t nodes, std::int64_t expected) {
    listener.progress(0, fmt::format("interior, {} nodes of about {}", nodes, expected).c_str());
  };
  bool is_told = false;
  watch.slow = [&](const std::string& why) {
    if (!std::exchange(is_told, true)) listener.note("meshing takes long: " + why);
  };
  std::optional<MesherFailure> failure;  // with the sizes that were asked for
  for (const double factor : {1.0, 0.97, 1.03}) {
    auto changed = domain;
    changed.size = [&domain, factor](geometry::Vec3 p) { return factor * unevenness(domain, p) * domain.size(p); };
    try {
      auto raw = run_mesh3(changed, seed, watch);
      if (failure)
        listener.warn(fmt::format("all sizes were multiplied by {}, since with those that were asked for {}", factor,
                                  failure->what()));
      return raw;
    } catch (const MesherFailure& now) {
      if (!failure) failure = now;
    }
  }
  throw MesherFailure(*failure);
}

RawMesh mesh_domain(const Domain& domain, unsigned seed, const Listener& listener) {
  auto raw = mesh_interior(domain, seed, listener);
  listener.progress(1, "boundary");
  place_boundary(domain, raw);
  peel(domain, raw);
  flip_between(domain, raw);
  listener.progress(2, "quality");
  improve(domain, raw);
  raw = ordered(raw);
  listener.progress(Listener::n_steps, "");
  return raw;
}

/// The mesh that begins with points on the closed pieces instead of with balls along the curves, where it would not:
/// between the circles of a pipe with a ball in it the balls' cells are so flat that refinement piles up nodes in
/// places. Nothing where that does not help.
std::optional<RawMesh> mesh_from_points(Domain domain, unsigned seed, const Listener& listener) {
  if (domain.points_first || domain.curves.empty()) return std::nullopt;
  if (std::all_of(domain.pieces.begin(), domain.pieces.end(), [](const auto& piece) { return piece.start.empty(); }))
    return std::nullopt;
  domain.points_first = true;
  try {
    return mesh_domain(domain, seed, listener);
  } catch (const Error&) {  // the first error says more
    return std::nullopt;
  }
}

/// Whether two domains that differ by their sizes differ in these anywhere inside: on a grid.
bool differ_in_sizes(const Domain& a, const Domain& b) {
  constexpr int n = 32;
  const double step = 2 * a.radius / n;
  for (int i = 0; i < n * n * n; ++i) {
    const int x = i % n - n / 2, y = i / n % n - n / 2, z = i / n / n - n / 2;
    const geometry::Vec3 grid{x + 0.5, y + 0.5, z + 0.5};
    const auto p = a.center + step * grid;
    if (Domain::region_of(a.label(p)) >= 0 && a.size(p) != b.size(p)) return true;
  }
  return false;
}

/// With edges in gaps of at most `factor` times the width of the gap; nothing where that changes no size or does not
/// help.
std::optional<RawMesh> mesh_with_gaps(const MeshCase& mesh_case, const Domain& domain, double factor,
                                      const Listener& listener) {
  auto finer_case = mesh_case;
  finer_case.combination.gap_factor = factor;
  try {
    const auto finer = domain_of(finer_case);
    if (!differ_in_sizes(domain, finer)) return std::nullopt;
    return mesh_domain(finer, mesh_case.seed, listener);
  } catch (const Error&) {  // the first error says more
    return std::nullopt;
  }
}

/// What to do where a body is thinner than the edges that are wanted there; empty where none is.
std::string advice_for_thin(const MeshCase& mesh_case, const Domain& domain) {
  if (domain.thin.size == 0) return {};
  const bool has_option = geometry::is_cad_file(mesh_case.where);
  return fmt::format(". The body is {:.3g} thick near {}, and edges of {:.3g} are wanted there: give {} {:.3g} or less",
                     domain.thin.thickness, geometry::decimal(domain.thin.point), domain.thin.size,
                     has_option ? "--size" : "[mesh.sizes] far, or near of the surface,", domain.thin.thickness);
}

RawMesh mesh_here(const MeshCase& mesh_case, const Domain& domain, const Listener& listener) {
  try {
    return mesh_domain(domain, mesh_case.seed, listener);
  } catch (const Error& first) {
    if (auto raw = mesh_from_points(domain, mesh_case.seed, listener)) return *std::move(raw);
    if (mesh_case.combination.surfaces)
      for (const double factor : {3.0, 1.5}) {
        auto raw = mesh_with_gaps(mesh_case, domain, factor, listener);
        if (!raw) continue;
        listener.warn(
            fmt::format("{}: two surfaces are nearer to each other than edges of the wanted sizes can follow: "
                        "edges in the gaps are at most {:g} times as long as these are wide",
                        mesh_case.where, factor));
        return *std::move(raw);
      }
    throw Error(mesh_case.where + ": " + first.what() + advice_for_thin(mesh_case, domain));
  }
}

/// Refuses triangulated surfaces that have no inside within the bounds; warns of those that cut themselves elsewhere.
void require_insides(const MeshCase& mesh_case, const Listener& listener) {
  if (!mesh_case.combination.surfaces) return;
  const geometry::Box bounds{mesh_case.combination.low, mesh_case.combination.high};
  for (const auto& remark : mesh_case.combination.surfaces->remarks()) listener.warn(remark);
  for (const auto& surface : mesh_case.combination.surfaces->triangulations) {
    const auto inside = geometry::find_inside(*surface, bounds);
    if (inside.fault) throw Error(mesh_case.where + ": " + *inside.fault);
    const auto warning = geometry::self_intersection_warning(*surface, inside.self_intersections);
    if (!warning.empty()) listener.warn(warning);
  }
}

/// Says that bodies apart from one another are not told apart. Collective.
void note_pieces(const par::Comm& comm, const MeshCase& mesh_case, const mesh::DistMesh& mesh,
                 const Listener& listener) {
  if (!mesh.info.regions.empty()) return;
  if (const auto n = check::count_pieces(comm, mesh); n > 1 && comm.is_first())
    listener.note(
        fmt::format("{}: the mesh is in {} pieces that no face joins, and they are one region: tables [[mesh.region]] "
                    "make regions of what different surfaces bound, and pamr-mesh of a STEP, IGES or BREP file itself "
                    "of each solid",
                    mesh_case.where, n));
}

/// The mesh in canonical blocks, without wall ears, valid.
LevelZero finished(const par::Comm& comm, mesh::BlockMesh block) {
  const auto destination = block_destinations(comm, block);
  auto mesh = assemble::assemble(comm, std::move(block), destination);
  const auto ears = find_wall_ears(comm, mesh);
  mesh = open_wall_ears(comm, std::move(mesh), ears);
  validate::require_valid(comm, mesh, "the new mesh");
  return {.mesh = std::move(mesh), .split_edges = std::ssize(ears.edge), .split_faces = std::ssize(ears.face)};
}

}  // namespace

LevelZero make_mesh(const par::Comm& comm, const MeshCase& mesh_case, const Listener& listener) {
  Domain domain;
  par::agree(comm, [&] {
    if (comm.is_first()) require_insides(mesh_case, listener);
    domain = domain_of(mesh_case);
    for (const auto& note : domain.notes)
      if (comm.is_first()) listener.note(mesh_case.where + ": " + note);
    if (comm.is_first() && domain.thin.size > thin_factor * domain.thin.thickness)
      listener.warn(mesh_case.where +
                    ": edges are wanted that are longer than the body is thick, which takes long and "
                    "may fail" +
                    advice_for_thin(mesh_case, domain));
  });
  RawMesh raw;
  par::agree(comm, [&] {
    if (comm.is_first()) raw = mesh_here(mesh_case, domain, listener);
  });
  auto block = to_block_mesh(comm, domain, raw);
  block.info.provenance = describe(mesh_case);
  auto result = finished(comm, std::move(block));
  result.body_volume = domain.volume;
  result.region_volumes.resize(result.mesh.info.regions.size());
  for (const auto& part : domain.regions) result.region_volumes[at(part.number - 1)] += part.volume;
  note_pieces(comm, mesh_case, result.mesh, listener);
  return result;
}

LevelZero make_kuhn_cube(const par::Comm& comm, int n) {
  auto block = assemble::kuhn_cube(comm, n);
  block.info.provenance = fmt::format("pamr-mesh: shape kuhn-cube, n {}", n);
  return finished(comm, std::move(block));
}

MeshSummary summary_of(const par::Comm& comm, const mesh::DistMesh& mesh) {
  MeshSummary result;
  result.faces.resize(mesh.info.patches.size());
  const auto& regions = mesh.info.regions;
  const auto* region_of_cell = regions.empty() ? nullptr : mesh::find_regions(mesh);
  std::vector<par::ExactSum> volume(1 + (region_of_cell == nullptr ? 0 : regions.size()));  // of all, then by region
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const double here = geometry::volume(mesh.points(c));
    volume[0].add(here);
    for (std::size_t r = 1; r < volume.size(); ++r)
      if (regions[r - 1].number == region_of_cell->integer()[at(c)]) volume[r].add(here);
    result.min_mean_ratio = std::min(result.min_mean_ratio, geometry::mean_ratio(mesh.points(c)));
    for (const auto slot : mesh.cell_to_cell[at(c)])
      if (slot < 0) ++result.faces[at(mesh::slot_to_patch(slot))];
  }
  comm.sum_in_place(result.faces);
  const auto inner = mesh::count_inner_faces(comm, mesh);
  for (std::size_t p = 0; p < inner.size(); ++p) result.faces[p] += inner[p];
  const auto sums = par::reproducible_sums(comm, std::span<par::ExactSum>(volume));
  result.volume = sums.front();
  result.region_volumes.assign(sums.begin() + 1, sums.end());
  result.min_mean_ratio = comm.min(result.min_mean_ratio);
  return result;
}

}  // namespace pamr::meshing
