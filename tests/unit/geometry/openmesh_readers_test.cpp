// SPDX-License-Identifier: GPL-3.0-or-later
// OpenMesh as an independent reference: it reads what our files hold, and our readers read what it writes.
#include <gtest/gtest.h>
#include <unistd.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "pamr/geometry/triangulated/read_triangulation.hpp"
#include "support/triangulations.hpp"

namespace pamr::geometry {
namespace openmesh_readers_test {

struct InDoubles : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
};
using Judge = OpenMesh::TriMesh_ArrayKernelT<InDoubles>;
using Corners = std::array<Vec3, 3>;

std::vector<Corners> corners_of(const Triangulation& surface) {
  std::vector<Corners> corners;
  for (const auto& [a, b, c] : surface.triangles) {
    const auto point = [&](int i) { return surface.points[static_cast<std::size_t>(i)]; };
    corners.push_back({point(a), point(b), point(c)});
  }
  return corners;
}

std::vector<Corners> corners_of(const Judge& mesh) {
  std::vector<Corners> corners;
  for (const auto face : mesh.faces()) {
    Corners& here = corners.emplace_back();
    std::size_t k = 0;
    for (const auto vertex : mesh.fv_range(face)) {
      const auto p = mesh.point(vertex);
      here[k++] = {p[0], p[1], p[2]};
    }
  }
  return corners;
}

/// The same triangles in the same order and sense, whichever corner comes first; coordinates in single precision, as
/// OpenMesh reads and writes some of them.
void expect_same(const std::vector<Corners>& ours, const std::vector<Corners>& theirs, const std::string& what) {
  ASSERT_EQ(ours.size(), theirs.size()) << what;
  for (std::size_t t = 0; t < ours.size(); ++t) {
    double least = 1e300;
    for (std::size_t turn = 0; turn < 3; ++turn) {
      double worst = 0;
      for (std::size_t k = 0; k < 3; ++k) worst = std::max(worst, norm(ours[t][k] - theirs[t][(k + turn) % 3]));
      least = std::min(least, worst);
    }
    ASSERT_LT(least, 2e-7) << what << ", triangle " << t;
  }
}

/// Folder of its own, removed at the end.
class Folder {
 public:
  Folder() : path_(std::filesystem::temp_directory_path() / ("pamr_judge_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  Folder(Folder&&) = delete;
  Folder& operator=(Folder&&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// A closed body with sharp edges, a round one, and one with coordinates of every digit.
std::vector<std::pair<std::string, Triangulation>> bodies() {
  auto crooked = ::pamr::testing::icosphere(2);
  for (auto& p : crooked.points)
    p = {1.1 * p.x + 0.3 * std::sin(3 * p.y), 0.7 * p.y - 0.01 / 3, p.z + 0.2 * std::cos(2 * p.x)};
  return {{"part", ::pamr::testing::bored_cube(24)}, {"ball", ::pamr::testing::icosphere(3)}, {"crooked", crooked}};
}

TEST(SurfaceFileJudge, OpenMeshReadsTheSameTrianglesFromOurFiles) {
  const Folder folder;
  for (const auto& [name, surface] : bodies()) {
    const std::vector<std::pair<std::string, std::string>> files{
        {"text.stl", ::pamr::testing::as_stl_text(surface)}, {"bytes.stl", ::pamr::testing::as_stl_bytes(surface)},
        {"a.obj", ::pamr::testing::as_obj(surface)},         {"a.off", ::pamr::testing::as_off(surface)},
        {"text.ply", ::pamr::testing::as_ply_text(surface)}, {"bytes.ply", ::pamr::testing::as_ply_bytes(surface)}};
    for (const auto& [file, bytes] : files) {
      const auto path = folder / (name + file);
      std::ofstream(path, std::ios::binary) << bytes;
      Judge oracle;

      ASSERT_TRUE(OpenMesh::IO::read_mesh(oracle, path.string())) << path;

      expect_same(corners_of(parse_triangulation(bytes, path.string())), corners_of(oracle), name + file);
    }
  }
}

TEST(SurfaceFileJudge, OurReadersFindTheTrianglesThatOpenMeshWrites) {
  using Option = OpenMesh::IO::Options;
  const std::vector<std::pair<std::string, Option>> kinds{{"text.stl", Option::Default},
                                                          {"bytes.stl", Option::Binary},
                                                          {"a.obj", Option::Default},
                                                          {"a.off", Option::Default},
                                                          {"text.ply", Option::Default},
                                                          {"little.ply", Option(Option::Binary) + Option(Option::LSB)},
                                                          {"big.ply", Option(Option::Binary) + Option(Option::MSB)}};
  const Folder folder;
  for (const auto& [name, surface] : bodies()) {
    Judge oracle;
    std::vector<Judge::VertexHandle> vertex;
    for (const Vec3 p : surface.points) vertex.push_back(oracle.add_vertex({p.x, p.y, p.z}));
    for (const auto& [a, b, c] : surface.triangles)
      ASSERT_TRUE(oracle
                      .add_face(vertex[static_cast<std::size_t>(a)], vertex[static_cast<std::size_t>(b)],
                                vertex[static_cast<std::size_t>(c)])
                      .is_valid());
    for (const auto& [file, option] : kinds) {
      const auto path = folder / (name + file);
      ASSERT_TRUE(OpenMesh::IO::write_mesh(oracle, path.string(), option, 17)) << path;

      const auto read = read_triangulation(path.string());

      EXPECT_EQ(read.points.size(), surface.points.size()) << path;
      expect_same(corners_of(read), corners_of(oracle), name + file);
    }
  }
}

}  // namespace openmesh_readers_test
}  // namespace pamr::geometry
