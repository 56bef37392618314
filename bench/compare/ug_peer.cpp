// SPDX-License-Identifier: GPL-3.0-or-later
// UG (dune-uggrid): red refinement of marked cells with green closure, the closure undone before the next refinement,
// as ours. It keeps all levels. Command line and output: workload.py.
#include <dune/grid/uggrid.hh>

#include "dune_peer.hpp"

namespace {

class Ug : public peer::DunePeer<Dune::UGGrid<3>> {
 public:
  explicit Ug(const std::string& mesh_name) : DunePeer(mesh_name) {
    grid_->setRefinementType(Dune::UGGrid<3>::LOCAL);
    grid_->setClosureType(Dune::UGGrid<3>::GREEN);
  }
  std::string name() const { return "UG " UG_VERSION_NAME; }
};

}  // namespace

int main(int argc, char** argv) {
  Dune::MPIHelper::instance(argc, argv);
  return peer::main_of<Ug>(argc, argv);
}
