// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/fem_domain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/find_patches.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/poisson_boltzmann/fem/elements.hpp"
#include "solvers/poisson_boltzmann/fem/preconditioner.hpp"
#include "solvers/poisson_boltzmann/fem/sheets.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

void require_patches(const mesh::DistMesh& mesh, const Case& problem, const std::string& where) {
  const auto& patches = mesh.info.patches;
  if (patches.size() > 64) throw Error(fmt::format("expected a mesh of at most 64 patches, found {}", patches.size()));
  const auto exists = [&](const std::string& name) {
    for (const auto& patch : patches)
      if (patch.name == name) return true;
    return false;
  };
  for (const auto& b : problem.boundary)
    if (!exists(b.patch))
      throw Error(fmt::format("{}: expected [boundary.X] for a patch of the mesh ({}), found \"{}\"", where,
                              mesh::list_patches(patches), b.patch));
  const auto& midplane = problem.force.midplane;
  if (!midplane.empty() && !exists(midplane))
    throw Error(fmt::format("{}: expected a patch of the mesh ({}), found \"{}\"", where, mesh::list_patches(patches),
                            midplane));
  for (const auto& goal : problem.estimator.goals) {
    bool is_known = goal.body.empty() || exists(goal.body);
    for (const auto& body : problem.bodies) is_known = is_known || body.name == goal.body;
    if (!is_known)
      throw Error(fmt::format("{}: expected goal_patch to be a patch of the mesh ({}) or a [[body]], found \"{}\"",
                              where, mesh::list_patches(patches), goal.body));
  }
}

/// The nodes of a body's patch must lie on the body that the case states. Collective.
void require_bodies(const par::Comm& comm, const Domain& domain, const Case& problem, const std::string& where) {
  const auto require_near = [&](const std::string& patch, double size, const std::string& body, auto&& distance) {
    const int number = domain.patch_number(patch);
    if (number < 0)
      throw Error(fmt::format("{}: expected a patch of the mesh ({}), found \"{}\"", where,
                              mesh::list_patches(domain.mesh->info.patches), patch));
    double worst = 0;
    const auto n_corners = domain.mesh->node_position.size();  // middles of straightened edges may be off
    for (std::size_t i = 0; i < n_corners; ++i)
      if ((domain.node_patches[i] >> static_cast<unsigned>(number) & 1U) != 0)
        worst = std::max(worst, std::abs(distance(domain.point[i])));
    worst = comm.max(worst);
    if (worst > 1e-3 * size)
      throw Error(fmt::format("{}: expected the nodes of patch \"{}\" on {}, found some {:g} Debye lengths away", where,
                              patch, body, worst));
  };
  for (const auto& s : problem.spheres)
    if (!s.patch.empty())
      require_near(s.patch, s.radius,
                   fmt::format("the sphere of radius {:g} about ({:g}, {:g}, {:g})", s.radius, s.center.x, s.center.y,
                               s.center.z),
                   [&](Vec3 p) { return norm(p - s.center) - s.radius; });
  if (problem.plate) {
    // Within its layer, or where split puts the plate's potential at its nodes, within what rounding may do.
    const double layer = problem.term().layer_thickness(problem.plate->potential);
    require_near(problem.plate->patch, std::max(layer, 1e-6),
                 fmt::format("the plate z = {:g}", problem.plate->position),
                 [&](Vec3 p) { return p.z - problem.plate->position; });
  }
}

/// `slot_of_face` gets the corner of its cell that lies opposite each face.
std::vector<BoundaryFace> find_faces(const mesh::DistMesh& mesh, const Case& problem, const std::vector<Vec3>& point,
                                     std::vector<int>& slot_of_face) {
  const mesh::InnerPatches inner(mesh);
  const auto is_sheet = sheets_of(problem, mesh.info.patches);
  std::vector<BoundaryFace> faces;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const auto neighbor = mesh.cell_to_cell[at(c)][slot];
      BoundaryFace face;
      face.cell = c;
      face.is_inside = neighbor >= 0;
      face.patch = inner.of_any({c, static_cast<int>(slot)});
      if (face.is_inside && (face.patch < 0 || !is_sheet[at(face.patch)])) continue;
      std::array<Vec3, 3> p;
      for (std::size_t k = 0; k < 3; ++k) {
        face.node[k] = mesh.cell_to_node[at(c)][at(mesh::tet::face_to_corner[slot][k])];
        p[k] = point[at(face.node[k])];
      }
      const auto normal = cross(p[1] - p[0], p[2] - p[0]);
      face.area = 0.5 * norm(normal);
      face.normal = face.area > 0 ? (0.5 / face.area) * normal : Vec3{};
      faces.push_back(face);
      slot_of_face.push_back(static_cast<int>(slot));
    }
  return faces;
}

template <class Element>
std::vector<PatchShape> measure(const par::Comm& comm, const Element& element) {
  const auto n_patches = element.domain.mesh->info.patches.size();
  std::vector<par::ExactSum> area(n_patches);
  std::vector<std::int64_t> count(n_patches, 0), inside(n_patches, 0), off_axis(3 * n_patches, 0);
  std::vector<double> highest(3 * n_patches, -std::numeric_limits<double>::infinity());
  for (std::size_t f = 0; f < element.domain.faces.size(); ++f) {
    const auto& face = element.domain.faces[f];
    const auto p = at(face.patch);
    element.face(f).at_areas([&](double of_point) { area[p].add(face.weight() * of_point); });
    ++count[p];
    inside[p] += face.is_inside ? 1 : 0;
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(std::abs(face.normal[at(axis)]) - 1) > 1e-9) ++off_axis[3 * p + at(axis)];
    for (std::size_t axis = 0; axis < 3; ++axis)
      highest[3 * p + axis] = std::max(highest[3 * p + axis], element.domain.point[at(face.node[0])][axis]);
  }
  const auto areas = par::reproducible_sums(comm, area);
  comm.sum_in_place(count);
  comm.sum_in_place(inside);
  comm.sum_in_place(off_axis);
  std::vector<PatchShape> patches(n_patches);
  for (std::size_t p = 0; p < n_patches; ++p) {
    patches[p].area = areas[p];
    patches[p].n_faces = count[p];
    patches[p].has_inside = inside[p] > 0;
    for (int axis = 0; axis < 3; ++axis)
      if (count[p] > 0 && off_axis[3 * p + at(axis)] == 0) patches[p].axis = axis;
    if (patches[p].axis >= 0) patches[p].level = comm.max(highest[3 * p + at(patches[p].axis)]);
  }
  return patches;
}

}  // namespace

int Domain::patch_number(std::string_view name) const {
  for (std::size_t p = 0; p < mesh->info.patches.size(); ++p)
    if (mesh->info.patches[p].name == name) return static_cast<int>(p);
  return -1;
}

Domain make_domain(const par::Comm& comm, const mesh::DistMesh& mesh, const Case& problem, const std::string& where) {
  require_patches(mesh, problem, where);
  const auto scale = debye_lengths_in(mesh.info.length_unit, problem.electrolyte, where);
  if (!scale)
    throw Error(fmt::format("expected a mesh in Debye lengths (unit \"1\"), m, um or nm, found the length unit \"{}\"",
                            mesh.info.length_unit));
  Domain domain{&mesh, NodeMap(comm, mesh), *scale, {}, {}, {}, {}, {}};
  domain.point.reserve(mesh.node_position.size());
  for (const auto& p : mesh.node_position) domain.point.push_back(*scale * p);
  domain.node_volume.assign(domain.point.size(), 0);
  for (std::size_t c = 0; c < mesh.cell_to_node.size(); ++c) {
    const double quarter = geometry::volume(domain.points(c)) / 4;
    for (const auto node : mesh.cell_to_node[c]) domain.node_volume[at(node)] += quarter;
  }
  domain.nodes.sum_copies(comm, domain.node_volume);
  std::vector<int> slot_of_face;
  domain.faces = find_faces(mesh, problem, domain.point, slot_of_face);
  if (problem.solver.order == 2) make_quadratic(comm, slot_of_face, domain);
  domain.node_volume.resize(domain.point.size(), 0);
  domain.node_patches.assign(domain.point.size(), 0);
  for (std::size_t f = 0; f < domain.faces.size(); ++f)
    for (const auto node : domain.face_nodes(f))
      domain.node_patches[at(node)] |= std::uint64_t{1} << static_cast<unsigned>(domain.faces[f].patch);
  par::fold_shared(par::Exchange(comm, domain.nodes.shared()), domain.node_patches,
                   [](std::uint64_t& mine, std::uint64_t theirs) { mine |= theirs; });
  require_bodies(comm, domain, problem, where);
  domain.patches = with_element(domain, [&](const auto& element) { return measure(comm, element); });
  add_sheet_sides(comm, domain);
  for (std::size_t p = 0; p < domain.patches.size(); ++p)
    if (domain.patches[p].n_faces > 0 && problem.find_boundary(mesh.info.patches[p].name) == nullptr)
      throw Error(
          fmt::format("{}: expected a table [boundary.{}] for that patch of the mesh, found none (a name may stand "
                      "for several, such as \"*\")",
                      where, mesh.info.patches[p].name));
  return domain;
}

Memory memory_needed(const mesh::DistMesh& mesh, const Case& problem) {
  const auto n_nodes = static_cast<std::int64_t>(mesh.node_position.size());
  const auto n_cells = static_cast<std::int64_t>(mesh.cell_to_node.size());
  std::int64_t n_outer_faces = 0;
  for (const auto& slots : mesh.cell_to_cell)
    for (const auto slot : slots) n_outer_faces += mesh.is_own(slot) ? 0 : 1;
  // Euler's formula, nodes - edges + faces - cells = 1 for a ball, with 2 faces = 4 cells + outer faces.
  const auto n_edges = n_cells == 0 ? 0 : n_nodes + n_cells + n_outer_faces / 2 - 1;
  const bool is_linear = problem.solver.order == 1;
  Memory memory;
  // Of second order a corner meets all nodes of the cells around it, some 65, a mid-edge node some 25.
  memory.n_entries = is_linear ? n_nodes + 2 * n_edges : 65 * n_nodes + 25 * n_edges;
  memory.mesh = static_cast<std::int64_t>(mesh::bytes_at_rest(mesh));
  // Two matrices of 8 + 4 bytes an entry, or one and the rows that it is assembled from, and half of them again. Some 55 numbers a node: conditions, vectors of the solvers, gradients, fields of the answer. 11 a cell:
  // gradients and error estimates.
  memory.program = 50'000'000;
  memory.solve = 30 * memory.n_entries + 440 * (is_linear ? n_nodes : n_nodes + n_edges) +
                 (is_linear ? 88 : 240) * n_cells + 56 * n_outer_faces;
  // The error of second order: a block of 210 entries and 20 numbers a cell, some ten numbers a function of third
  // order.
  if (!is_linear) memory.solve += 1100 * n_cells + 80 * (n_nodes + 2 * n_edges);
  // The multigrid hierarchy: hypre's copy of the matrix, its coarser ones and what moves between them.
  if (choose_preconditioner(problem.solver, mesh.info.n_global_nodes) == Preconditioner::boomeramg)
    memory.solve += 25 * memory.n_entries;
  return memory;
}

}  // namespace pamr::poisson_boltzmann
