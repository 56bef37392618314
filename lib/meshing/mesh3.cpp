// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/mesh3.hpp"

#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_domain_with_polyline_features_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Random.h>
#include <CGAL/assertions_behaviour.h>
#include <CGAL/exceptions.h>
#include <CGAL/exude_mesh_3.h>
#include <CGAL/make_mesh_3.h>
#include <CGAL/perturb_mesh_3.h>
#include <CGAL/version.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "meshing/faces_between_regions.hpp"
#include "meshing/searched_domain.hpp"
#include "pamr/base/error.hpp"

namespace pamr::meshing {
namespace {

// The largest radius of a circumscribed ball as a multiple of the wanted edge length: 0.577 and 0.612 are those of the
// regular triangle and tetrahedron. A bound on edges is one on balls: CGAL lets edges on curves be 1.66 times as long,
// so 0.72 gives 1.2 of the wanted length, as 0.6 does for faces. The error bound is a part of the domain's radius.
constexpr double edge_factor = 0.72, face_factor = 0.6, cell_factor = 0.85;
constexpr double min_face_angle = 28.0, cell_radius_edge_ratio = 2.0;
constexpr double sliver_bound = 14.0;  // smallest dihedral angle worth no more work, degrees
// Nodes of a plane between two regions that are off it by rounding only make next to no flat cells there.
constexpr double relative_error = 1e-6, relative_error_between = 1e-9;

using MeshDomain = CGAL::Mesh_domain_with_polyline_features_3<SearchedDomain>;
using Triangulation = CGAL::Mesh_triangulation_3<MeshDomain>::type;
using Complex =
    CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, MeshDomain::Corner_index, MeshDomain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
using Edge = std::pair<std::int32_t, std::int32_t>;

/// Counts what CGAL asks, and ends what finds no end. A limit of time would make the mesh depend on the machine.
/// - Refinement: nodes beyond what the sizes can explain, or many questions without a new node.
/// - Perturbation, which moves nodes for ever in some meshes: a number of questions.
class Work {
 public:
  struct TooMuch {};  ///< thrown while there is a limit of questions

  Work(const Mesh3Watch& watch, double predicted_cells, double boundary_nodes)
      : watch_(watch),
        expected_(std::llround(std::max(predicted_cells / cells_per_node, boundary_nodes))),
        max_nodes_(std::max(2 * expected_, std::min(watch.spare_nodes + spare_factor * expected_, too_many_nodes))) {}

  void watch(const Triangulation& nodes) { nodes_ = &nodes; }
  void limit_questions(std::int64_t n) {
    nodes_ = nullptr;
    most_ = n_questions_ + n;
  }
  void lift_limit() { most_ = std::numeric_limits<std::int64_t>::max(); }

  void ask(geometry::Vec3 where) {
    if (++n_questions_ > most_) throw TooMuch();
    if (n_questions_ % questions_between_looks == 0 && !is_slow_) look_at_the_clock();
    if (nodes_ == nullptr) return;
    const auto n = static_cast<std::int64_t>(nodes_->number_of_vertices());
    if (n > n_nodes_) {
      n_nodes_ = n;
      last_growth_ = n_questions_;
      if (n > max_nodes_) refuse(where, too_many);
      if (n >= next_report_) report();
    } else if (n_questions_ - last_growth_ > idle_questions + idle_questions_per_node * n) {
      refuse(where, no_new);
    }
  }

 private:
  static constexpr const char* too_many =
      "Look there for a gap, a thin wall or a sharp angle between faces that is much smaller than the edges; take it "
      "away, or give a smaller size";
  static constexpr const char* no_new =
      "No new one comes there: give another size, and move what is far from the origin to it";
  static constexpr double cells_per_node = 4.5;
  static constexpr std::int64_t questions_between_looks = 1'000;
  static constexpr std::int64_t spare_factor = 100, too_many_nodes = 1'000'000;
  static constexpr std::int64_t idle_questions = 1'000'000, idle_questions_per_node = 5'000;

  /// The mesh does not depend on it.
  void look_at_the_clock() {
    const double seconds = busy_seconds() - began_;
    if (seconds < watch_.slow_after) return;
    is_slow_ = true;
    watch_.slow(fmt::format(
        "{:.0f} s of a processor so far, for {} nodes of about {}: CGAL asked {} times on which side of the boundary a "
        "point lies or how long edges are to be there, {:.2g} ms for 1,000 questions. Thin walls and sharp angles ask "
        "often; many faces or triangles make answers slow. Larger sizes end sooner",
        seconds, n_nodes_, expected_, n_questions_, 1e6 * seconds / static_cast<double>(n_questions_)));
  }

  static double busy_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

  void report() {
    watch_.progress(n_nodes_, expected_);
    next_report_ = n_nodes_ + n_nodes_ / 4;
  }

  [[noreturn]] void refuse(geometry::Vec3 where, const char* advice) const {
    throw MesherFailure(
        fmt::format("CGAL's mesher found no end: {} nodes where the sizes ask for about {}, the last near ({:.6g}, "
                    "{:.6g}, {:.6g}). {}",
                    n_nodes_, expected_, where.x, where.y, where.z, advice));
  }

  const Mesh3Watch& watch_;
  std::int64_t expected_, max_nodes_;
  const Triangulation* nodes_ = nullptr;
  std::int64_t n_questions_ = 0, most_ = std::numeric_limits<std::int64_t>::max();
  std::int64_t n_nodes_ = 0, last_growth_ = 0, next_report_ = 1000;
  double began_ = busy_seconds();
  bool is_slow_ = false;
};

struct SizeField {
  using FT = Kernel::FT;
  const Domain* domain;
  Work* work;
  double factor;
  template <class Index>
  FT operator()(const Kernel::Point_3& p, int, const Index&) const {
    work->ask(from_cgal(p));
    return factor * domain->size(from_cgal(p));
  }
};

MeshDomain make_domain(const Domain& domain, CGAL::Random& random, Work& work) {
  namespace p = CGAL::parameters;
  const auto& c = domain.center;
  const Kernel::Sphere_3 ball(Kernel::Point_3(c.x, c.y, c.z), domain.radius * domain.radius);
  const auto count = [&work](geometry::Vec3 point) { work.ask(point); };
  const std::function<int(const Kernel::Point_3&)> label =
      [count, known = KnownLabels(domain)](const Kernel::Point_3& point) mutable {
        count(from_cgal(point));
        return known(from_cgal(point));
      };
  const std::function<bool(int)> is_outside = [first = first_piece(domain)](int index) {
    return index < first_region || index >= first;
  };
  MeshDomain result(p::function = label, p::bounding_object = ball,
                    p::relative_error_bound = domain.regions.empty() ? relative_error : relative_error_between,
                    p::p_rng = &random, p::null_subdomain_index = is_outside);
  result.search(domain, count);
  std::vector<std::vector<Kernel::Point_3>> polylines;
  for (const auto& curve : domain.curves) {
    auto& polyline = polylines.emplace_back();
    for (const auto& q : curve.polyline) polyline.emplace_back(q.x, q.y, q.z);
  }
  result.add_features(polylines.begin(), polylines.end());
  for (const auto& q : domain.tips) result.add_corner(Kernel::Point_3(q.x, q.y, q.z));
  return result;
}

// `start` calls CGAL's C3t3_initializer, which is no documented interface: the documented ones either protect curves or
// take points of the caller, never both, and a closed surface beside curves needs both. It was read in CGAL 5.5 and 6.0
// and has the same arguments in both; a later version must be looked at before this line is changed.
static_assert(CGAL_VERSION_NR >= 1050500000 && CGAL_VERSION_NR < 1060100000,
              "mesh3.cpp calls CGAL::Mesh_3::internal::C3t3_initializer; expected CGAL 5.5, 5.6 or 6.0, where it was "
              "tried or read: set PAMR_MESHING=OFF, or look at that class and extend this condition");

/// CGAL's labels on both sides of a piece, ascending.
std::pair<int, int> labels_beside(const Domain& domain, std::size_t piece) {
  const auto& [first, second] = domain.pieces[piece].region;
  return {first_region + first, second >= 0 ? first_region + second : first_piece(domain) + static_cast<int>(piece)};
}

/// What Delaunay refinement starts from: balls along the curves, and points on the pieces without curves. CGAL shoots
/// rays for these in a domain without any curve and looks for none in the others.
void start(const Domain& domain, const MeshDomain& mesh_domain, const Criteria& criteria, Complex& complex) {
  const auto add_points = [&] {
    for (std::size_t i = 0; i < domain.pieces.size(); ++i)
      for (const auto& q : domain.pieces[i].start) {
        const auto vertex =
            complex.triangulation().insert(Triangulation::Weighted_point(Kernel::Point_3(q.x, q.y, q.z)));
        if (vertex == Complex::Vertex_handle()) continue;  // hidden by a ball
        complex.set_dimension(vertex, 2);
        complex.set_index(vertex, mesh_domain.index_from_surface_patch_index(labels_beside(domain, i)));
      }
  };
  // Where balls span no space CGAL scatters points of its own, which may lie so near to others that refinement never
  // ends before rounding does.
  if (domain.points_first) add_points();
  if (!domain.curves.empty() || !domain.tips.empty())
    CGAL::Mesh_3::internal::C3t3_initializer<Complex, MeshDomain, Criteria, true>()(complex, mesh_domain, criteria,
                                                                                    true);
  if (!domain.points_first) add_points();
}

/// Throws `Work::TooMuch` when perturbation finds no end; `with_perturbation` false: without it.
Complex make_complex(const Domain& domain, const MeshDomain& mesh_domain, bool with_perturbation, Work& work) {
  constexpr std::int64_t max_questions = 15'000;  // for each node: known meshes take up to 9000
  namespace p = CGAL::parameters;
  const Criteria criteria(p::edge_size = SizeField{&domain, &work, edge_factor}, p::facet_angle = min_face_angle,
                          p::facet_size = SizeField{&domain, &work, face_factor},
                          p::facet_topology = CGAL::FACET_VERTICES_ON_SAME_SURFACE_PATCH,
                          p::cell_radius_edge_ratio = cell_radius_edge_ratio,
                          p::cell_size = SizeField{&domain, &work, cell_factor});
  Complex complex;
  work.watch(complex.triangulation());
  start(domain, mesh_domain, criteria, complex);
  CGAL::refine_mesh_3(complex, mesh_domain, criteria, p::no_reset_c3t3(), p::no_perturb(), p::no_exude());
  if (with_perturbation) {
    const auto n_nodes = static_cast<std::int64_t>(complex.triangulation().number_of_vertices());
    work.limit_questions(max_questions * n_nodes);
    CGAL::perturb_mesh_3(complex, mesh_domain, p::sliver_bound = sliver_bound);
    work.lift_limit();
  }
  CGAL::exude_mesh_3(complex, p::sliver_bound = sliver_bound);
  return complex;
}

/// Estimated from the sizes.
struct Prediction {
  double cells = 0, boundary_nodes = 0;
};

/// From a grid of samples; a regular cell of edge h has the volume 0.118 h^3, a node of the boundary stands for
/// 0.866 h^2, and the area of a boundary in all directions is two thirds of what it shows along the three axes.
Prediction predict(const Domain& domain) {
  constexpr int n = 64;
  const double step = 2 * domain.radius / n;
  const auto offset = [&](int i) { return (i + 0.5) * step - domain.radius; };
  double cells = 0, nodes = 0;
  std::vector<int> region(static_cast<std::size_t>(n) * n * n, -1);
  Domain::Ball ball;
  for (int i = 0; i < n * n * n; ++i) {
    const auto point = domain.center + geometry::Vec3{offset(i % n), offset(i / n % n), offset(i / (n * n))};
    if (!ball.holds(point)) ball = ball_about(domain, point);
    const bool is_inside = ball.region >= 0;
    region[static_cast<std::size_t>(i)] = ball.region;
    const auto is_other = [&](int before, bool is_there) {
      return is_there && region[static_cast<std::size_t>(i - before)] != region[static_cast<std::size_t>(i)];
    };
    const int n_crossed = is_other(1, i % n > 0) + is_other(n, i / n % n > 0) + is_other(n * n, i >= n * n);
    if (!is_inside && n_crossed == 0) continue;
    const double in_edges = step / domain.size(point);
    if (is_inside) cells += std::pow(in_edges, 3);
    nodes += n_crossed * in_edges * in_edges;
  }
  return {cells / 0.118, std::max(domain.boundary_nodes, nodes / 1.5 / 0.866)};
}

[[noreturn]] void too_coarse(const std::string& what) {
  throw Error(
      "expected a mesh whose boundary follows the domain, found " + what +
      ": the sizes are too coarse for the domain, or faces meet there at too sharp an angle: give other sizes, or "
      "blunt the edge");
}

std::string text_of(geometry::Vec3 p) { return fmt::format("({:f}, {:f}, {:f})", p.x, p.y, p.z); }

/// Nodes are numbered in the order in which the cells name them; CGAL's handles are compared by the time when they
/// were made, so no order depends on addresses.
class Extraction {
 public:
  Extraction(const Domain& domain, const Complex& complex) : domain_(domain), complex_(complex) {
    for (auto c = complex.cells_in_complex_begin(); c != complex.cells_in_complex_end(); ++c) add_cell(c);
    mesh_.binding.resize(mesh_.point.size());
  }

  RawMesh result() && {
    bind_to_curves();
    bind_to_tips();
    find_pieces_between_regions(
        domain_, [this](Edge edge) { return feature_edges_.contains(edge); }, mesh_);
    bind_to_pieces();
    require_cells_of_all_parts();
    std::vector<bool> has_face(domain_.pieces.size(), false);
    for (const auto* faces : {&mesh_.face, &mesh_.between})
      for (const auto& face : *faces) has_face[static_cast<std::size_t>(face.piece)] = true;
    for (std::size_t i = 0; i < has_face.size(); ++i)
      if (!has_face[i])
        too_coarse("no face on a piece of \"" +
                   domain_.patches[static_cast<std::size_t>(domain_.pieces[i].patch)].name + "\"");
    return std::move(mesh_);
  }

 private:
  void require_cells_of_all_parts() const {
    std::vector<bool> has_cell(domain_.regions.size(), false);
    for (const int part : mesh_.region) has_cell[static_cast<std::size_t>(part)] = true;
    for (std::size_t i = 0; i < has_cell.size(); ++i)
      if (!has_cell[i]) too_coarse("no cell in a part of the region \"" + domain_.regions[i].name + "\"");
  }

  void add_cell(Complex::Cell_handle handle) {
    auto& cell = mesh_.cell.emplace_back();
    for (int i = 0; i < 4; ++i) {
      const auto vertex = handle->vertex(i);
      const auto [at, is_new] = number_.try_emplace(vertex, static_cast<std::int32_t>(mesh_.point.size()));
      if (is_new) mesh_.point.push_back(from_cgal(vertex->point().point()));
      cell[static_cast<std::size_t>(i)] = at->second;
    }
    const int label = complex_.subdomain_index(handle);
    if (!domain_.regions.empty()) mesh_.region.push_back(label - first_region);
    const auto number = static_cast<std::int32_t>(mesh_.cell.size()) - 1;
    for (int i = 0; i < 4; ++i) {
      if (const auto other = handle->neighbor(i); complex_.is_in_complex(other)) {
        if (label < complex_.subdomain_index(other)) mesh_.between.push_back({number, i, -1});
        continue;
      }
      const auto index = complex_.surface_patch_index(handle, i);
      const int piece = std::max(index.first, index.second) - first_piece(domain_);
      if (piece < 0 ||
          labels_beside(domain_, static_cast<std::size_t>(piece)) != std::pair(label, first_piece(domain_) + piece))
        too_coarse("a boundary face on no piece of the boundary at " + text_of(mesh_.position(cell[0])));
      mesh_.face.push_back({number, i, piece});
    }
  }

  void bind_to_curves() {
    for (auto e = complex_.edges_in_complex_begin(); e != complex_.edges_in_complex_end(); ++e) {
      std::array<std::int32_t, 2> ends{};
      for (std::size_t i = 0; i < 2; ++i) {
        const auto vertex = e->first->vertex(i == 0 ? e->second : e->third);
        const auto at = number_.find(vertex);
        if (at == number_.end())
          too_coarse("a feature edge outside the mesh at " + text_of(from_cgal(vertex->point().point())));
        ends[i] = at->second;
        mesh_.binding[static_cast<std::size_t>(at->second)] =
            complex_.is_in_complex(vertex) ? Binding{Freedom::none, -1}
                                           : Binding{Freedom::curve, complex_.curve_index(*e) - 1};
      }
      feature_edges_[std::minmax(ends[0], ends[1])] = 0;
    }
  }

  void bind_to_tips() {
    for (const auto& tip : domain_.tips) {
      const auto same = [&](const auto& entry) { return from_cgal(entry.first->point().point()) == tip; };
      const auto found = std::find_if(number_.begin(), number_.end(), same);
      if (found == number_.end()) too_coarse("no cell at the tip " + text_of(tip));
      mesh_.binding[static_cast<std::size_t>(found->second)] = {Freedom::none, -1};
    }
  }

  void bind_to_pieces() {
    std::map<Edge, int> piece_of_edge;
    for (const auto* faces : {&mesh_.face, &mesh_.between})
      for (const auto& face : *faces) bind_to_piece(face, piece_of_edge);
    for (const auto& [edge, n_faces] : feature_edges_)
      if (domain_.regions.empty() ? n_faces != 2 : n_faces < 2)
        too_coarse("a feature edge off the boundary at " + text_of(mesh_.position(edge.first)));
  }

  void bind_to_piece(const BoundaryFace& face, std::map<Edge, int>& piece_of_edge) {
    const auto corner = corners_of(mesh_, face);
    for (const auto node : corner) {
      auto& binding = mesh_.binding[static_cast<std::size_t>(node)];
      if (binding.freedom == Freedom::space) binding = {Freedom::piece, face.piece};
      if (binding.freedom == Freedom::piece && binding.number != face.piece)
        too_coarse("a node off the feature curves on two pieces at " + text_of(mesh_.position(node)));
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const Edge edge = std::minmax(corner[i], corner[(i + 1) % 3]);
      const auto [at, is_new] = piece_of_edge.try_emplace(edge, face.piece);
      const auto feature = feature_edges_.find(edge);
      if (feature != feature_edges_.end()) ++feature->second;
      if (!is_new && at->second != face.piece && feature == feature_edges_.end())
        too_coarse("a border between patches off the feature curves at " + text_of(mesh_.position(edge.first)));
    }
  }

  const Domain& domain_;
  const Complex& complex_;
  std::map<Triangulation::Vertex_handle, std::int32_t> number_;
  std::map<Edge, int> feature_edges_;  ///< with the number of boundary faces at each
  RawMesh mesh_;
};

/// Keeps CGAL from printing what it throws as well.
class Silence {
 public:
  Silence() : old_error_(CGAL::set_error_handler(say_nothing)), old_warning_(CGAL::set_warning_handler(say_nothing)) {}
  ~Silence() {
    CGAL::set_error_handler(old_error_);
    CGAL::set_warning_handler(old_warning_);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
  Silence(Silence&&) = delete;
  Silence& operator=(Silence&&) = delete;

 private:
  static void say_nothing(const char*, const char*, const char*, int, const char*) {}
  CGAL::Failure_function old_error_, old_warning_;
};

Complex make_complex(const Domain& domain, unsigned seed, Work work, bool with_perturbation) {
  CGAL::get_default_random() = CGAL::Random(seed);
  CGAL::Random random(seed);
  const auto mesh_domain = make_domain(domain, random, work);
  return make_complex(domain, mesh_domain, with_perturbation, work);
}

Complex make_complex(const Domain& domain, unsigned seed, const Work& work) {
  try {
    return make_complex(domain, seed, work, true);
  } catch (const Work::TooMuch&) {  // slivers are left to exudation and to `improve`
    return make_complex(domain, seed, work, false);
  }
}

}  // namespace

RawMesh run_mesh3(const Domain& domain, unsigned seed, const Mesh3Watch& watch) {
  constexpr double max_cells = 4e6;  // one process makes the mesh, with about a kilobyte a cell
  const auto predicted = predict(domain);
  const double n = predicted.cells;
  if (n > max_cells)
    throw Error(
        fmt::format("expected sizes that give at most 4 million cells at level 0, found {} cells: choose coarser "
                    "sizes and refine with pamr-refine",
                    std::llround(n)));
  const Silence silence;
  try {
    const auto complex = make_complex(domain, seed, Work(watch, n, predicted.boundary_nodes));
    auto mesh = Extraction(domain, complex).result();
    if (mesh.cell.empty()) too_coarse("no cell");
    return mesh;
  } catch (const CGAL::Failure_exception& failure) {
    const auto message = failure.message().empty() ? failure.expression() : failure.message();
    throw MesherFailure(
        fmt::format("CGAL's mesher failed ({}): give another size", message.substr(0, message.find('\n'))));
  }
}

}  // namespace pamr::meshing
