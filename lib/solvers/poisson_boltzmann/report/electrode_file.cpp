// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/report/electrode_file.hpp"

#include "pamr/base/index.hpp"
#include "pamr/io/export/write_surface_vtu.hpp"
#include "solvers/poisson_boltzmann/goals/wall_stress.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// Mean values of a face.
struct FaceValues {
  double charge_density = 0;
  Vec3 stress;
};

FaceValues values_on(const BoundaryFace& face, const Problem& problem, const Solution& solution,
                     const Analysis& analysis) {
  FaceValues result;
  const Vec3 n = -face.normal;  // from the body into the liquid
  Vec3 field;
  double pressure = 0;
  for (const auto node : face.node) {
    const auto i = at(node);
    field += (1.0 / 3) * analysis.field[i];
    pressure += problem.term.pressure(analysis.psi[i], 0) / 3;
    const auto by_reaction = reaction_charge(problem, solution.reaction, face.normal, i);
    result.charge_density += (by_reaction ? *by_reaction : dot(analysis.field[i], n)) / 3;
  }
  result.stress = stress(field, n, pressure);
  return result;
}

}  // namespace

void write_electrodes(const par::Comm& comm, const std::filesystem::path& file, const Problem& problem,
                      const Solution& solution, const Analysis& analysis) {
  const auto& mesh = *problem.domain.mesh;
  io::SurfaceField potential{.name = "potential"};
  io::SurfaceField charge{.name = "charge_density"}, stress{.name = "stress", .n_components = 3};
  io::SurfaceField patch{.name = "patch", .is_integer = true};
  io::SurfaceTriangles triangles{.all_cells = mesh.info.cell_ids()};
  for (const auto& face : problem.domain.faces) {
    if (face.is_inside) continue;
    triangles.cell.push_back(mesh.cell_global[at(face.cell)]);
    auto& corner = triangles.corner.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = mesh.node_position[at(face.node[k])];
      potential.value.push_back(analysis.psi[at(face.node[k])]);
    }
    const auto values = values_on(face, problem, solution, analysis);
    charge.value.push_back(values.charge_density);
    stress.value.insert(stress.value.end(), {values.stress.x, values.stress.y, values.stress.z});
    patch.value.push_back(face.patch);
  }
  triangles.corner_fields = {std::move(potential)};
  triangles.fields = {std::move(charge), std::move(stress), std::move(patch)};
  io::write_surface_vtu(comm, file, triangles,
                        {.shares_points = false,
                         .coordinate_digits = 9,
                         .names_scalars = true,
                         .attributes = " byte_order=\"LittleEndian\""});
}

}  // namespace pamr::poisson_boltzmann
