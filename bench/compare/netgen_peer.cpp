// SPDX-License-Identifier: GPL-3.0-or-later
// netgen on the workloads of docs/reports/performance.md: uniform refinement (W1) and bisection of marked cells, which
// cuts a marked cell three times. `UpdateTopology`, by which its users get the faces of the cells, is part of
// bisection; after uniform refinement it is timed apart. Both work on the mesh in place. Command line and output:
// workload.py.
#include <map>
#include <memory>
#include <meshing.hpp>

#include "workload.hpp"

namespace {

class Netgen {
 public:
  explicit Netgen(const std::string& mesh_name) : mesh_(std::make_unique<netgen::Mesh>()) {
    const auto plain = peer::mesh_named(mesh_name);
    netgen::printmessage_importance = 0;
    mesh_->SetDimension(3);
    mesh_->AddFaceDescriptor(netgen::FaceDescriptor(1, 1, 0, 1));
    mesh_->GetFaceDescriptor(1).SetBCProperty(1);
    for (const auto& p : plain.node) mesh_->AddPoint(netgen::Point3d(p[0], p[1], p[2]));
    for (const auto& face : peer::boundary_of(plain)) {
      netgen::Element2d element(1 + face[0], 1 + face[1], 1 + face[2]);
      element.SetIndex(1);
      mesh_->AddSurfaceElement(element);
    }
    for (const auto& n : plain.cell) {
      netgen::Element cell(netgen::TET);
      // netgen's cells are oriented the other way
      const std::array<int, 4> order{n[0], n[2], n[1], n[3]};
      for (int i = 0; i < 4; ++i) cell[i] = netgen::PointIndex(1 + order[static_cast<std::size_t>(i)]);
      cell.SetIndex(1);
      mesh_->AddVolumeElement(cell);
    }
    mesh_->SetNextMajorTimeStamp();
  }

  std::string name() const { return "netgen " NETGEN_VERSION_NAME; }
  std::size_t n_cells() const { return static_cast<std::size_t>(mesh_->GetNE()); }

  template <class Visit>
  void corners(Visit&& visit) const {
    for (netgen::ElementIndex cell = 0; cell < mesh_->GetNE(); ++cell) {
      peer::Corners p;
      for (int i = 0; i < 4; ++i)
        for (int axis = 0; axis < 3; ++axis)
          p[static_cast<std::size_t>(i)][static_cast<std::size_t>(axis)] =
              mesh_->Point(mesh_->VolumeElement(cell)[i])(axis);
      visit(p);
    }
  }

  void mark(const std::vector<std::int8_t>& flags) {
    is_uniform_ = flags.empty();
    for (std::size_t cell = 0; cell < flags.size(); ++cell)
      mesh_->VolumeElement(netgen::ElementIndex(static_cast<int>(cell))).SetRefinementFlag(flags[cell] > 0);
  }

  void refine() {
    const netgen::Refinement refinement;
    if (is_uniform_) return refinement.Refine(*mesh_);
    netgen::BisectionOptions options;
    options.usemarkedelements = 1;
    refinement.Bisect(*mesh_, options);
  }

  bool relate() {
    mesh_->UpdateTopology();
    return true;
  }
  bool mark_more() { return false; }
  static int coarsening_calls() { return 1; }

 private:
  std::unique_ptr<netgen::Mesh> mesh_;
  bool is_uniform_ = false;
};

}  // namespace

int main(int argc, char** argv) { return peer::main_of<Netgen>(argc, argv); }
