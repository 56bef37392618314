// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// All that a solver needs of PAMR, in one header: `#include <pamr/pamr.hpp>`, target `pamr::pamr`.
///
/// A mesh comes from arrays (`mesh::BlockMesh`), a file (`io::read_mesh`, `io::read_native`) or a shape
/// (`assemble::kuhn_cube`), and is put together by `assemble::assemble`. Cells are chosen by flags of your own or by
/// `mark`, `adapt::refine` splits them, `adapt::adapt` also takes splits back, `balance::rebalance` spreads them by the
/// work they cause, `locate` finds the cells of points, `adapt::data_of_parents` what belonged to the parents, and
/// `io::write_native` writes the mesh, `adapt::write_cell_rows` what else belongs to its cells. The example in
/// share/pamr/examples does all of this.

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/coarsening_report.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/adapt/given_mesh.hpp"
#include "pamr/adapt/parent_data.hpp"
#include "pamr/adapt/read_for_refinement.hpp"
#include "pamr/adapt/saved_rows.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/balance/migrate.hpp"
#include "pamr/balance/rebalance.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/version.hpp"
#include "pamr/check/quality_report.hpp"
#include "pamr/curved/curve_cells.hpp"
#include "pamr/geometry/described_surface.hpp"
#include "pamr/geometry/surface_toml.hpp"
#include "pamr/io/export/write_foam.hpp"
#include "pamr/io/export/write_vtu.hpp"
#include "pamr/io/formats.hpp"
#include "pamr/io/gmsh/read_gmsh.hpp"
#include "pamr/io/gmsh/write_gmsh.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/io/vtk/read_vtu.hpp"
#include "pamr/locate/locate_points.hpp"
#include "pamr/mark/apply_criteria.hpp"
#include "pamr/mark/budget.hpp"
#include "pamr/mark/recovered_error.hpp"
#include "pamr/mesh/block_mesh.hpp"
#include "pamr/mesh/face_geometry.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/mesh/ghost_values.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/order/order_along_curve.hpp"
#include "pamr/par/runtime.hpp"
#include "pamr/validate/validate.hpp"
