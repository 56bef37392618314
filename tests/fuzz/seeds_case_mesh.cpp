// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <fstream>

#include "case_files.hpp"
#include "meshing/read_mesh_case.hpp"
#include "mutate.hpp"
#include "seeds.hpp"
#include "support/triangulations.hpp"

namespace pamr::fuzz {

namespace {

constexpr std::array<const char*, 6> cases{"charged-spheres/paper.toml",  "sphere-pair/case.toml",
                                           "supersonic-sphere/case.toml", "blunt-cone/case.toml",
                                           "charged-rod/case.toml",       "ellipsoid-plate/case.toml"};

/// One surface of each kind, and the sizes that the others do not have.
constexpr const char* all_kinds = R"([mesh]
shape = "surfaces"
length_unit = "mm"
region = "+box & -ball & (+tube | -slope) & -peak & -ring & -vase & -egg & -hill & -body"
bounds = [[-2, -2, -2], [2, 2, 2.5]]
seed = 7

[mesh.sizes]
far = 0.5
growth = 0.3
near = { ball = 0.1, "body" = 0.2 }

[[surface]]
name = "box"
kind = "plane"
point = [0, 0, -1]
normal = [0, 0, 1]

[[surface]]
name = "ball"
kind = "sphere"
center = [0.5, 0, 0]
radius = 0.25

[[surface]]
name = "tube"
kind = "cylinder"
point = [0, 0, 0]
axis = [0, 0, 1]
radius = 0.75

[[surface]]
name = "slope"
kind = "plane"
point = [1.0, 0, 0]
normal = [1.0, 0.5, 0]

[[surface]]
name = "peak"
kind = "cone"
apex = [0, 0, 2]
axis = [0, 0, -1]
half_angle = 20.0

[[surface]]
name = "ring"
kind = "torus"
center = [0, 0, 0]
axis = [0, 0, 1]
major_radius = 1.5
minor_radius = 0.2

[[surface]]
name = "vase"
kind = "revolution"
origin = [0, 0, 0]
axis = [1, 0, 0]
profile = [
  { from = [0, 0], to = [0.25, 0.4330127018922193], center = [0.5, 0] },
  { from = [0.25, 0.4330127018922193], to = [1.25, 1.0103629710818452] },
  { from = [1.25, 1.0103629710818452], to = [1.55, 0.8371578903249575], center = [1.35, 0.8371578903249575] },
  { from = [1.55, 0.8371578903249575], to = [1.55, 0] },
]

[[surface]]
name = "egg"
kind = "quadric"
coefficients = [1, 1, 0.25, 0, 0, 0, -2, 0, 0, 0]

[[surface]]
name = "hill"
kind = "polynomial"
segments = [
  { x = [0, 1, 0, 0, 0, 0], y = [0, 0, 1, 0, 0, 0], z = [5, 0, 0, 1, 0, 1], u = [-1, 0], v = [-1, 1] },
  { x = [0, 1, 0, 0, 0, 0], y = [0, 0, 1, 0, 0, 0], z = [5, 0, 0, 1, 0, 1], u = [0, 1], v = [-1, 1] },
]

[[surface]]
name = "body"
kind = "triangulation"
file = "body.stl"
feature_angle = 30.0
near = [1.0, 0, 0]
)";

}  // namespace

// cases of the project, and one of all kinds of surfaces
int n_seed_files() { return static_cast<int>(cases.size()) + 1; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& /*comm*/, const std::filesystem::path& file) {
  (void)meshing::read_mesh_case(text_of(file), file.string());
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".toml"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  for (int i = 0; i + 1 < n_seed_files(); ++i)
    std::ofstream(folder / seed_name(i)) << case_of_project(cases.at(static_cast<std::size_t>(i)));
  std::ofstream(folder / seed_name(n_seed_files() - 1)) << all_kinds;
  for (const auto* body : {"body.stl", "ellipsoid.stl"})
    std::ofstream(folder / body, std::ios::binary) << testing::as_stl_bytes(testing::icosphere(1));
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
