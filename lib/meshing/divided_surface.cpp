// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/divided_surface.hpp"

#include "meshing/cad_body.hpp"
#include "pamr/geometry/triangulated/triangulated_surface.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;

class DividedTriangulation final : public DividedSurface {
 public:
  explicit DividedTriangulation(const geometry::Triangulated& whole) : whole_(whole) {}

  std::size_t n_pieces() const override { return whole_.n_patches(); }
  std::shared_ptr<const geometry::Surface> piece(int number) const override { return whole_.piece(number); }
  std::string part_of(int number) const override { return whole_.part_of(number); }
  int piece_at(Vec3 point) const override { return whole_.piece_at(point); }
  void for_each_sample(const std::function<void(int, Vec3)>& use) const override {
    whole_.for_each_triangle([&](int piece, Vec3 middle) { use(piece, whole_.project(middle)); });
  }
  std::size_t n_lines() const override { return whole_.crease_net().lines().size(); }
  const std::vector<Vec3>& line(std::size_t number) const override {
    return whole_.crease_net().lines()[number].polyline;
  }
  Vec3 nearest_on_line(std::size_t number, Vec3 point) const override {
    return whole_.crease_net().nearest_on_line(number, point);
  }
  std::vector<int> pieces_of_line(std::size_t number) const override {
    const auto& piece = whole_.crease_net().lines()[number].piece;
    return {piece.begin(), piece.end()};
  }

 private:
  const geometry::Triangulated& whole_;
};

}  // namespace

std::shared_ptr<const DividedSurface> divided(const geometry::Surface& surface) {
  if (const auto* body = dynamic_cast<const CadBody*>(&surface)) return {std::shared_ptr<const DividedSurface>(), body};
  if (const auto* triangulated = dynamic_cast<const geometry::Triangulated*>(&surface))
    return std::make_shared<DividedTriangulation>(*triangulated);
  return nullptr;
}

}  // namespace pamr::meshing
