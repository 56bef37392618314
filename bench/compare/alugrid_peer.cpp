// SPDX-License-Identifier: GPL-3.0-or-later
// ALUGrid (dune-alugrid): conforming bisection of marked cells, with coarsening. A marked cell is bisected three times,
// by three calls, which halve all of its edges, as one call of a code that splits cells into eight does. Command line
// and output: workload.py.
#include <dune/alugrid/grid.hh>

#include "dune_peer.hpp"

namespace {

using Grid = Dune::ALUGrid<3, 3, Dune::simplex, Dune::conforming>;

class AluGrid : public peer::DunePeer<Grid> {
 public:
  using DunePeer::DunePeer;
  std::string name() const { return "ALUGrid " ALUGRID_VERSION_NAME; }

  void mark(const std::vector<std::int8_t>& flags) {
    calls_ = 0;
    is_marked_.clear();
    std::size_t number = 0;
    for (const auto& cell : elements(grid_->leafGridView())) {
      if (flags.empty() || flags[number++] > 0) set_marked(cell);
    }
    DunePeer::mark(flags);
  }

  static int coarsening_calls() { return 3; }

  /// Marks what the last call has made of the marked cells, until they have been bisected three times.
  bool mark_more() {
    if (++calls_ == 3) return false;
    for (const auto& cell : elements(grid_->leafGridView())) {
      auto ancestor = cell;
      for (int i = 0; i < calls_ && ancestor.hasFather(); ++i) {
        ancestor = ancestor.father();
        if (is_marked(ancestor) && cell.level() - ancestor.level() == calls_) grid_->mark(1, cell);
      }
    }
    return true;
  }

 private:
  template <class Cell>
  std::size_t number_of(const Cell& cell) const {
    return static_cast<std::size_t>(grid_->localIdSet().id(cell));
  }
  template <class Cell>
  void set_marked(const Cell& cell) {
    const auto number = number_of(cell);
    if (number >= is_marked_.size()) is_marked_.resize(2 * number + 1);
    is_marked_[number] = true;
  }
  template <class Cell>
  bool is_marked(const Cell& cell) const {
    const auto number = number_of(cell);
    return number < is_marked_.size() && is_marked_[number];
  }

  int calls_ = 0;
  std::vector<bool> is_marked_;  ///< by the number of the cell
};

}  // namespace

int main(int argc, char** argv) {
  Dune::MPIHelper::instance(argc, argv);
  return peer::main_of<AluGrid>(argc, argv);
}
