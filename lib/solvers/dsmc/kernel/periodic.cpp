// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/periodic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

constexpr double tolerance = 1e-6;  ///< of the size of a face

/// A periodic face as it is sent to rank 0, which finds the pairs.
struct Face {
  GlobalId cell = 0;
  int slot = 0, patch = 0;
  Rank rank = 0;
  std::int32_t boundary = 0;  ///< number on its rank
  std::array<Vec3, 3> corner{};
  Vec3 normal;

  Vec3 middle() const { return (1.0 / 3) * (corner[0] + corner[1] + corner[2]); }
  double area() const { return 0.5 * norm(cross(corner[1] - corner[0], corner[2] - corner[0])); }
};

/// The answer of rank 0 for a face.
struct Joint {
  std::int64_t order = 0;  ///< of the pair among all pairs
  std::int32_t boundary = 0, partner = 0;
  Rank partner_rank = 0;
};

std::string text_of(Vec3 p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

/// Finds faces by their middles.
class Places {
 public:
  Places(const std::vector<Face>& faces) : faces_(&faces) {
    for (const auto& face : faces) side_ = std::min(side_, 0.1 * std::sqrt(face.area()));
    for (std::size_t i = 0; i < faces.size(); ++i) box_[key_of(faces[i].middle())].push_back(i);
  }
  /// The face whose middle is within `reach` of the point; the number of faces when there is none.
  std::size_t find(Vec3 point, double reach) const {
    for (const double x : {point.x - reach, point.x + reach})
      for (const double y : {point.y - reach, point.y + reach})
        for (const double z : {point.z - reach, point.z + reach}) {
          const auto found = box_.find(key_of({x, y, z}));
          if (found == box_.end()) continue;
          for (const auto i : found->second)
            if (norm((*faces_)[i].middle() - point) <= reach) return i;
        }
    return faces_->size();
  }

 private:
  std::uint64_t key_of(Vec3 p) const {
    const auto whole = [&](double x) { return static_cast<std::uint64_t>(std::llround(std::floor(x / side_))); };
    return combine(combine(whole(p.x), whole(p.y)), whole(p.z));
  }
  const std::vector<Face>* faces_;
  double side_ = 1e300;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> box_;
};

Vec3 middle_of(const std::vector<Face>& faces) {
  Vec3 sum;
  double area = 0;
  for (const auto& face : faces) {
    sum = sum + face.area() * face.middle();
    area += face.area();
  }
  return (1 / area) * sum;
}

/// From a corner of a face to the nearest of the other's, which lies about `shift` away.
Vec3 from_corner(const Face& face, const Face& other, std::size_t k, Vec3 shift) {
  Vec3 best = other.corner[0] - face.corner[k];
  for (const auto& corner : other.corner)
    if (norm(corner - face.corner[k] - shift) < norm(best - shift)) best = corner - face.corner[k];
  return best;
}

bool is_the_same(const Face& face, const Face& other, Vec3 shift) {
  const double reach = tolerance * std::sqrt(face.area());
  for (std::size_t k = 0; k < 3; ++k)
    if (norm(from_corner(face, other, k, shift) - shift) > reach) return false;
  return dot(face.normal, other.normal) < -0.9;
}

/// The faces of two patches, joined pair by pair in the order of the first one's, and the shift between them.
struct Matched {
  std::vector<std::array<const Face*, 2>> pair;
  Vec3 shift;
};
Matched match(const mesh::DistMesh& mesh, const std::vector<Face>& a, const std::vector<Face>& b) {
  const auto &name_a = mesh.info.patches[at(a.front().patch)].name,
             &name_b = mesh.info.patches[at(b.front().patch)].name;
  Matched matched;
  matched.shift = middle_of(b) - middle_of(a);
  const Places places(b);
  std::vector<bool> is_taken(b.size(), false);
  const auto refuse = [&](const Face& face) {
    throw Error(fmt::format(
        "expected the faces of periodic patch \"{}\", shifted by {} m, to be those of its partner \"{}\", found none "
        "there for the face of cell {} of \"{}\" with its middle at {} m",
        name_a, text_of(matched.shift), name_b, face.cell, face.patch == a.front().patch ? name_a : name_b,
        text_of(face.middle())));
  };
  for (const auto& face : a) {
    const auto found = places.find(face.middle() + matched.shift, tolerance * std::sqrt(face.area()));
    if (found == b.size() || is_taken[found] || !is_the_same(face, b[found], matched.shift)) refuse(face);
    is_taken[found] = true;
    matched.pair.push_back({&face, &b[found]});
  }
  for (std::size_t i = 0; i < b.size(); ++i)
    if (!is_taken[i]) refuse(b[i]);
  const auto [first, other] = matched.pair.front();
  matched.shift = from_corner(*first, *other, 0, matched.shift);
  return matched;
}

/// On rank 0: the answers to each rank, and the shift of every patch.
struct Pairing {
  std::vector<std::vector<Joint>> joint;
  std::vector<Vec3> shift;
};
Pairing pair_faces(const mesh::DistMesh& mesh, std::span<const BoundaryCondition> patch, Rank n_ranks,
                   std::vector<Face> faces) {
  std::sort(faces.begin(), faces.end(),
            [](const Face& x, const Face& y) { return std::tie(x.cell, x.slot) < std::tie(y.cell, y.slot); });
  std::vector<std::vector<Face>> of(patch.size());
  for (const auto& face : faces) of[at(face.patch)].push_back(face);
  Pairing pairing{std::vector<std::vector<Joint>>(static_cast<std::size_t>(n_ranks)), std::vector<Vec3>(patch.size())};
  std::int64_t order = 0;
  for (std::size_t p = 0; p < patch.size(); ++p) {
    const auto q = at(patch[p].partner);
    if (patch[p].kind != BoundaryCondition::Kind::periodic || q < p || (of[p].empty() && of[q].empty())) continue;
    if (of[p].empty() || of[q].empty())
      throw Error(fmt::format("expected faces on both periodic patches \"{}\" and \"{}\", found none on one",
                              mesh.info.patches[p].name, mesh.info.patches[q].name));
    const auto matched = match(mesh, of[p], of[q]);
    pairing.shift[p] = matched.shift;
    pairing.shift[q] = -matched.shift;
    for (const auto& [x, y] : matched.pair) {
      pairing.joint[at(x->rank)].push_back({order, x->boundary, y->boundary, y->rank});
      pairing.joint[at(y->rank)].push_back({order, y->boundary, x->boundary, x->rank});
      ++order;
    }
  }
  return pairing;
}

/// Appends the faces whose partners are on other ranks to the borders with those ranks.
void add_to_borders(const std::vector<Joint>& joints, GasDomain& domain) {
  std::map<Rank, std::vector<mesh::CellFace>> border;
  std::map<Rank, std::vector<std::int32_t>> joined;  // their boundary faces
  const auto n = domain.n_cells();
  std::vector<LocalId> moved(domain.border_face.size());  // where a face of the old borders comes to lie
  for (std::size_t i = 0; i < domain.border_rank.size(); ++i) {
    auto& faces = border[domain.border_rank[i]];
    for (auto k = domain.border_offset[i]; k < domain.border_offset[i + 1]; ++k) faces.push_back(domain.border_face[k]);
  }
  for (const auto& joint : joints) {
    const auto& face = domain.boundary[at(joint.boundary)];
    border[joint.partner_rank].push_back({face.cell, face.slot});
    joined[joint.partner_rank].push_back(joint.boundary);
  }
  const auto old_rank = domain.border_rank;
  const auto old_offset = domain.border_offset;
  domain.border_rank.clear();
  domain.border_offset = {0};
  domain.border_face.clear();
  for (const auto& [rank, faces] : border) {
    const auto first = domain.border_face.size(), n_new = joined[rank].size(), n_old = faces.size() - n_new;
    for (std::size_t i = 0; i < old_rank.size(); ++i)
      if (old_rank[i] == rank)
        for (std::size_t k = 0; k < n_old; ++k) moved[old_offset[i] + k] = static_cast<LocalId>(first + k);
    for (std::size_t k = 0; k < n_new; ++k)
      domain.boundary[at(joined[rank][k])].across = n + static_cast<LocalId>(first + n_old + k);
    domain.border_rank.push_back(rank);
    domain.border_face.insert(domain.border_face.end(), faces.begin(), faces.end());
    domain.border_offset.push_back(domain.border_face.size());
  }
  for (auto& links : domain.link)
    for (auto& link : links)
      if (link >= n) link = n + moved[at(link - n)];
}

}  // namespace

void join_periodic(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const BoundaryCondition> patch,
                   GasDomain& domain) {
  using Kind = BoundaryCondition::Kind;
  if (std::none_of(patch.begin(), patch.end(), [](const auto& p) { return p.kind == Kind::periodic; })) return;
  for (std::size_t p = 0; p < patch.size(); ++p) {
    if (patch[p].kind != Kind::periodic) continue;
    const auto q = at(patch[p].partner);
    PAMR_EXPECTS(q < patch.size() && q != p && patch[q].partner == static_cast<int>(p));
  }
  std::vector<par::Outgoing<Face>> to_root(1);
  for (std::size_t b = 0; b < domain.boundary.size(); ++b) {
    const auto& face = domain.boundary[b];
    if (patch[at(face.patch)].kind != Kind::periodic) continue;
    to_root[0].item.push_back({mesh.cell_global[at(face.cell)], face.slot, face.patch, comm.rank(),
                               static_cast<std::int32_t>(b), face.corner, face.normal});
  }
  const auto faces = comm.sparse_exchange(to_root);
  Pairing pairing;
  par::agree(comm, [&] {
    if (comm.rank() == 0) pairing = pair_faces(mesh, patch, comm.size(), faces.item);
  });
  domain.shift = comm.broadcast(pairing.shift);
  std::vector<par::Outgoing<Joint>> answers;
  for (std::size_t r = 0; r < pairing.joint.size(); ++r) answers.push_back({static_cast<Rank>(r), pairing.joint[r]});
  auto joints = comm.sparse_exchange(answers).item;
  std::vector<Joint> abroad;
  for (const auto& joint : joints) {
    if (joint.partner_rank == comm.rank())
      domain.boundary[at(joint.boundary)].across = domain.boundary[at(joint.partner)].cell;
    else
      abroad.push_back(joint);
  }
  add_to_borders(abroad, domain);
}

}  // namespace pamr::dsmc
