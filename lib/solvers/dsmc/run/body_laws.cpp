// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/body_laws.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "solvers/dsmc/sampling/exact_walls.hpp"
#include "solvers/dsmc/sampling/free_molecular.hpp"

namespace pamr::dsmc {

std::int64_t patch_that_leaves_its_plane(const par::Comm& comm, const std::vector<BoundaryFace>& faces,
                                         const std::vector<BoundaryCondition>& conditions,
                                         const std::vector<bool>& among, double allowed) {
  std::int64_t found = -1;
  for (const auto& face : faces)
    if (among[at(face.patch)] && leaves_its_plane(conditions[at(face.patch)], face.normal, allowed))
      found = std::max<std::int64_t>(found, face.patch);
  return comm.max(found);
}

bool has_body(const Case& c, const Setup& setup, const std::vector<mesh::Patch>& patches) {
  const auto body = reference_patches(c.reference, patches, setup.patch);
  const auto& free = c.stream.front();
  return std::find(body.begin(), body.end(), true) != body.end() && norm(free.velocity) > 0 && free.density > 0;
}

BodyLaws body_laws(const par::Comm& comm, const Case& c, const Setup& setup, const std::vector<mesh::Patch>& patches,
                   const std::vector<BoundaryFace>& faces) {
  const auto& free = c.stream.front();
  const auto body = reference_patches(c.reference, patches, setup.patch);
  Gas gas = c.gas;
  gas.fraction = free.fraction;
  const Scale scale(gas, free, c.reference);
  const auto of_law = [&](const SurfaceLaw& law) {
    return scale.coefficients(sum_of(integrate_law(comm, faces, law, c.reference.point, body.size()), body));
  };
  constexpr double rounding = 1e-6;
  BodyLaws laws;
  laws.newtonian = of_law(newtonian_law(gas, free));
  if (const auto moving = patch_that_leaves_its_plane(comm, faces, setup.patch, body, rounding); moving >= 0)
    laws.moving_wall = patches[at(moving)].name;
  else
    laws.free_molecular = of_law(free_molecular_law(gas, free, setup.patch));
  return laws;
}

Coefficients error_of_facets(const par::Comm& comm, const Case& c, const Setup& setup, const mesh::DistMesh& mesh,
                             const std::vector<BoundaryFace>& boundary) {
  const auto& patches = setup.patches_on(mesh);
  if (!has_body(c, setup, patches)) return {};
  const auto& surfaces = *mesh.info.surfaces;
  for (const auto& patch : patches)
    if (patch.surface >= 0 && !surfaces.get(patch.surface))
      throw Error(fmt::format("expected the surface of the patch {}, found a mesh that was read without its surfaces",
                              patch.name));
  const auto flat = body_laws(comm, c, setup, patches, boundary);
  const auto curved = body_laws(comm, c, setup, patches, faces_on_surfaces(boundary, patches, surfaces, setup.unit));
  Coefficients error;
  const auto widen = [&error](const Coefficients& one, const Coefficients& other) {
    const auto wider = [](double known, double difference) {
      return std::max(known, 16.0 / 15 * std::fabs(difference));  // a sixteenth is left to the surface
    };
    error.drag = wider(error.drag, one.drag - other.drag);
    error.lift = wider(error.lift, one.lift - other.lift);
    error.moment = wider(error.moment, one.moment - other.moment);
    error.heat = wider(error.heat, one.heat - other.heat);
  };
  widen(flat.newtonian, curved.newtonian);
  if (flat.free_molecular && curved.free_molecular) widen(*flat.free_molecular, *curved.free_molecular);
  return error;
}

}  // namespace pamr::dsmc
