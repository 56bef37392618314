// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/tears.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "pamr/base/counted.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/check/match_nodes.hpp"
#include "pamr/locate/count_cells.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/worst_place.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::check {

namespace {

using geometry::Vec3;

constexpr double same_place = 1e-10;  ///< of the diagonal of the box around the mesh
constexpr double inward = 1.0 / 64;   ///< of the way from the middle of a face to the corner opposite

/// Counts places on all ranks. Collective.
Findings find_first(const par::Comm& comm, const std::vector<Vec3>& places) {
  Findings findings{comm.sum(static_cast<std::int64_t>(places.size())), {}};
  if (findings.count == 0) return findings;
  mesh::WorstPlaces first;
  for (const auto place : places) first.add(0, place);
  findings.where = first.over(comm).where;
  return findings;
}

std::vector<mesh::CellFace> faces_of_boundary(const mesh::DistMesh& mesh) {
  std::vector<mesh::CellFace> faces;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot)
      if (mesh.cell_to_cell[at(c)][at(slot)] < 0) faces.push_back({c, slot});
  return faces;
}

std::array<LocalId, 3> nodes_of(const mesh::DistMesh& mesh, mesh::CellFace face) {
  const auto& corner = mesh::tet::face_to_corner[at(face.slot)];
  const auto& node = mesh.cell_to_node[at(face.cell)];
  return {node[at(corner[0])], node[at(corner[1])], node[at(corner[2])]};
}

/// The same bits whatever the order of the corners.
Vec3 middle_of(const mesh::DistMesh& mesh, mesh::CellFace face) {
  const auto node = nodes_of(mesh, face);
  std::array<Vec3, 3> p{mesh.point(node[0]), mesh.point(node[1]), mesh.point(node[2])};
  std::sort(p.begin(), p.end(), geometry::lexicographically_less);
  return (1.0 / 3) * (p[0] + p[1] + p[2]);
}

/// Sets of cells that faces of this rank join: each cell points to another one of its set, the first to itself.
class Sets {
 public:
  explicit Sets(LocalId n) : parent_(at(n)) { std::iota(parent_.begin(), parent_.end(), 0); }
  LocalId first_of(LocalId cell) {
    while (parent_[at(cell)] != cell) cell = parent_[at(cell)] = parent_[at(parent_[at(cell)])];
    return cell;
  }
  void join(LocalId a, LocalId b) {
    a = first_of(a);
    b = first_of(b);
    parent_[at(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<LocalId> parent_;
};

/// The smallest global number of the cells of each cell's piece, for the first cell of each local set. Collective.
std::vector<GlobalId> first_cells_of_pieces(const par::Comm& comm, const mesh::DistMesh& mesh, Sets& sets) {
  std::vector<GlobalId> first = mesh.cell_global;  // cells ascend in global number
  par::Pattern border{mesh.border_rank, mesh.border_offset, {}};
  for (const auto& face : mesh.border_face) border.item.push_back(sets.first_of(face.cell));
  const par::Exchange exchange(comm, border);
  for (bool news = true; comm.any(news);) {
    news = false;
    par::fold_shared(
        exchange, [&](LocalId set) { return first[at(set)]; },
        [&](LocalId set, GlobalId theirs) {
          news = news || theirs < first[at(set)];
          first[at(set)] = std::min(first[at(set)], theirs);
        });
  }
  return first;
}

/// The nodes of boundary faces of this rank, ascending.
std::vector<LocalId> boundary_nodes(const mesh::DistMesh& mesh, const std::vector<mesh::CellFace>& faces) {
  std::vector<std::uint8_t> is_boundary(at(mesh.n_nodes()), 0);
  for (const auto face : faces)
    for (const auto node : nodes_of(mesh, face)) is_boundary[at(node)] = 1;
  std::vector<LocalId> nodes;
  for (LocalId node = 0; node < mesh.n_nodes(); ++node)
    if (is_boundary[at(node)] != 0) nodes.push_back(node);
  return nodes;
}

std::vector<GlobalId> nodes_by_place(const par::Comm& comm, const mesh::DistMesh& mesh,
                                     const std::vector<mesh::CellFace>& faces) {
  const auto nodes = boundary_nodes(mesh, faces);
  std::vector<GlobalId> number;
  std::vector<Vec3> position;
  for (const auto node : nodes) {
    number.push_back(mesh.node_global[at(node)]);
    position.push_back(mesh.point(node));
  }
  const auto size = mesh::box_of_nodes(comm, mesh).size();
  const auto other = match_other_nodes(comm, {number, position}, same_place * geometry::norm(size));
  auto result = mesh.node_global;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (other[i] != unmatched) result[at(nodes[i])] = std::min(number[i], other[i]);
  // nodes in one place may be named in a chain
  for (;;) {
    const auto in_block = par::scatter_rows<GlobalId>(comm, mesh.info.node_ids(), result, 1, mesh.node_global);
    auto next = par::fetch_rows<GlobalId>(comm, mesh.info.node_ids(), in_block, 1, result);
    const bool is_end = next == result;
    result = std::move(next);
    if (comm.all(is_end)) return result;
  }
}

struct NumberedPlace {
  GlobalId number = 0;
  Vec3 point;
};

Findings find_coincident_nodes(const par::Comm& comm, const mesh::DistMesh& mesh,
                               const std::vector<GlobalId>& by_place) {
  par::Mailbox<NumberedPlace> found(comm);
  for (LocalId node = 0; node < mesh.n_nodes(); ++node) {
    const auto number = mesh.node_global[at(node)];
    if (by_place[at(node)] != number)
      found.add(par::block_of(number, mesh.info.node_ids(), comm.size()), {number, mesh.point(node)});
  }
  auto all = found.send().item;  // from each rank that holds the node
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (i == 0 || all[i].number != all[i - 1].number) places.push_back(all[i].point);
  return find_first(comm, places);
}

/// A boundary face sent to where faces of the same place meet.
struct FaceVisitor {
  std::array<GlobalId, 3> node{};
  std::int64_t row = 0;  ///< where the answer belongs
  Rank from = 0;
};

PairedFaces pair_faces(const par::Comm& comm, const mesh::DistMesh& mesh, std::vector<mesh::CellFace> faces,
                       const std::vector<GlobalId>& by_place) {
  PairedFaces result{std::move(faces), {}};
  par::Mailbox<FaceVisitor> meeting(comm);
  for (std::size_t i = 0; i < result.face.size(); ++i) {
    FaceVisitor visitor{{}, static_cast<std::int64_t>(i), comm.rank()};
    const auto node = nodes_of(mesh, result.face[i]);
    for (std::size_t k = 0; k < 3; ++k) visitor.node[k] = by_place[at(node[k])];
    std::sort(visitor.node.begin(), visitor.node.end());
    std::uint64_t hash = 0;
    for (const auto number : visitor.node) hash = combine(hash, static_cast<std::uint64_t>(number));
    meeting.add(static_cast<Rank>(hash % static_cast<std::uint64_t>(comm.size())), visitor);
  }
  auto visitors = meeting.send().item;
  std::sort(visitors.begin(), visitors.end(),
            [](const FaceVisitor& a, const FaceVisitor& b) { return a.node < b.node; });
  par::Mailbox<std::int64_t> answers(comm);
  for (std::size_t i = 0; i < visitors.size(); ++i) {
    const auto& node = visitors[i].node;
    if ((i > 0 && visitors[i - 1].node == node) || (i + 1 < visitors.size() && visitors[i + 1].node == node))
      answers.add(visitors[i].from, visitors[i].row);
  }
  result.is_paired.assign(result.face.size(), 0);
  for (const auto row : answers.send().item) result.is_paired[at(row)] = 1;
  return result;
}

Findings find_coincident_faces(const par::Comm& comm, const mesh::DistMesh& mesh,
                               const std::vector<mesh::CellFace>& faces, const std::vector<GlobalId>& by_place) {
  const auto [face, is_paired] = pair_faces(comm, mesh, faces, by_place);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < face.size(); ++i)
    if (is_paired[i] != 0) places.push_back(middle_of(mesh, face[i]));
  return find_first(comm, places);
}

Findings find_overlaps(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<mesh::CellFace>& faces) {
  std::vector<Vec3> middles, inside;
  for (const auto face : faces) {
    const auto middle = middle_of(mesh, face);
    const auto opposite = mesh.point(mesh.cell_to_node[at(face.cell)][at(face.slot)]);
    const auto point = middle + inward * (opposite - middle);
    if (locate::side_of_cell(mesh, face.cell, point) <= 0) continue;  // a cell too flat to hold it
    middles.push_back(middle);
    inside.push_back(point);
  }
  const auto n_cells = locate::count_cells(comm, mesh, locate::CellTree(mesh), inside);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < middles.size(); ++i)
    if (n_cells[i] > 1) places.push_back(middles[i]);
  return find_first(comm, places);
}

std::string place(Vec3 p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

}  // namespace

std::int64_t count_pieces(const par::Comm& comm, const mesh::DistMesh& mesh) {
  Sets sets(mesh.n_cells());
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (const auto next : mesh.cell_to_cell[at(c)])
      if (mesh.is_own(next) && next > c) sets.join(c, next);
  const auto first = first_cells_of_pieces(comm, mesh, sets);
  std::int64_t n = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (sets.first_of(c) == c && first[at(c)] == mesh.cell_global[at(c)]) ++n;
  return comm.sum(n);
}

std::vector<GlobalId> nodes_by_place(const par::Comm& comm, const mesh::DistMesh& mesh) {
  return nodes_by_place(comm, mesh, faces_of_boundary(mesh));
}

PairedFaces pair_faces(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<GlobalId>& by_place) {
  return pair_faces(comm, mesh, faces_of_boundary(mesh), by_place);
}

Tears find_tears(const par::Comm& comm, const mesh::DistMesh& mesh) {
  const auto faces = faces_of_boundary(mesh);
  const auto by_place = nodes_by_place(comm, mesh, faces);
  Tears tears;
  tears.n_pieces = count_pieces(comm, mesh);
  tears.coincident_nodes = find_coincident_nodes(comm, mesh, by_place);
  if (tears.coincident_nodes.count > 0) tears.coincident_faces = find_coincident_faces(comm, mesh, faces, by_place);
  tears.overlaps = find_overlaps(comm, mesh, faces);
  return tears;
}

std::vector<std::string> remarks_of(const Tears& tears) {
  std::vector<std::string> remarks;
  if (tears.overlaps.count > 0)
    remarks.push_back(
        fmt::format("the mesh overlaps itself: behind {} there are other cells, too, the "
                    "first near {}",
                    counted(tears.overlaps.count, "boundary face", "boundary faces"), place(tears.overlaps.where)));
  if (tears.coincident_faces.count > 0)
    remarks.push_back(
        fmt::format("{} on others, the first near {}: the cells on both sides share "
                    "no nodes there, and nothing passes from one to the other",
                    counted(tears.coincident_faces.count, "boundary face lies", "boundary faces lie"),
                    place(tears.coincident_faces.where)));
  else if (tears.coincident_nodes.count > 0)
    remarks.push_back(fmt::format("{} where others do, the first at {}",
                                  counted(tears.coincident_nodes.count, "boundary node lies", "boundary nodes lie"),
                                  place(tears.coincident_nodes.where)));
  if (tears.n_pieces > 1) remarks.push_back(fmt::format("the mesh is in {} pieces that no face joins", tears.n_pieces));
  return remarks;
}

}  // namespace pamr::check
