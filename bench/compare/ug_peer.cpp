// SPDX-License-Identifier: GPL-3.0-or-later
// UG (dune-uggrid) on the workloads of docs/reports/performance.md: red refinement of marked cells with green closure,
// the closure undone before the next refinement, as ours. It keeps all levels, and goes back by marking all cells for
// coarsening, one level a call. Command line and output: workload.hpp.
#include <dune/common/parallel/mpihelper.hh>
#include <dune/grid/common/gridfactory.hh>
#include <dune/grid/uggrid.hh>
#include <memory>

#include "workload.hpp"

namespace {

class Ug {
 public:
  explicit Ug(const peer::PlainMesh& plain) {
    Dune::GridFactory<Grid> factory;
    for (const auto& p : plain.node) factory.insertVertex({p[0], p[1], p[2]});
    for (const auto& n : plain.cell) {
      const std::vector<unsigned> corners(n.begin(), n.end());
      factory.insertElement(Dune::GeometryTypes::tetrahedron, corners);
    }
    grid_ = factory.createGrid();
    grid_->setRefinementType(Grid::LOCAL);
    grid_->setClosureType(Grid::GREEN);
  }

  std::string name() const { return "UG " UG_VERSION_NAME; }
  std::size_t n_cells() const { return static_cast<std::size_t>(grid_->leafGridView().size(0)); }

  template <class Visit>
  void corners(Visit&& visit) const {
    for (const auto& cell : elements(grid_->leafGridView())) {
      peer::Corners p;
      const auto geometry = cell.geometry();
      for (int i = 0; i < 4; ++i) {
        const auto x = geometry.corner(i);
        p[static_cast<std::size_t>(i)] = {x[0], x[1], x[2]};
      }
      visit(p);
    }
  }

  void mark(const std::vector<bool>& flags) {
    std::size_t number = 0;
    for (const auto& cell : elements(grid_->leafGridView())) {
      if (flags.empty() || flags[number]) grid_->mark(1, cell);
      ++number;
    }
  }

  void refine() { adapt(); }
  bool relate() { return false; }

  bool coarsen() {
    if (grid_->maxLevel() == 0) return false;
    const int before = grid_->maxLevel();
    for (const auto& cell : elements(grid_->leafGridView()))
      if (cell.level() > 0) grid_->mark(-1, cell);
    adapt();
    if (grid_->maxLevel() == before) throw std::runtime_error("UG does not go back");
    return true;
  }

 private:
  using Grid = Dune::UGGrid<3>;

  void adapt() {
    grid_->preAdapt();
    grid_->adapt();
    grid_->postAdapt();
  }

  std::unique_ptr<Grid> grid_;
};

}  // namespace

int main(int argc, char** argv) {
  Dune::MPIHelper::instance(argc, argv);
  return peer::main_of<Ug>(argc, argv);
}
