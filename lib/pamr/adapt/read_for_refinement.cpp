// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/read_for_refinement.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pamr/adapt/flags.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/balance/expected_work.hpp"
#include "pamr/balance/weights.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/with_file_name.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/order/order_along_curve.hpp"
#include "pamr/par/equal_work.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::adapt {

namespace {

using mesh::BlockMesh;

/// The field of the work that belongs to the marks; empty if there is none. Integers of that name and another type are
/// the user's.
std::string find_work(const io::NativeFile& file, const std::string& marks) {
  const auto work = balance::work_field(marks);
  return file.has_integers(work, balance::work_type) ? work : std::string();
}

/// The row at which this rank begins to read; none: at its canonical block.
std::optional<GlobalId> first_cell_to_read(const par::Comm& comm, io::NativeFile& file, const std::string& marks) {
  using enum io::NativeFile::Checked;
  if (!file.has_integers(marks)) return {};
  // read_for_refinement leaves this field out of the mesh, so this is the only time that it is verified
  if (const auto work = find_work(file, marks); !work.empty())
    return balance::first_cell_of_run(comm, balance::work_from_values(file.read_integers(work, checksum)));
  if (comm.size() == 1) return {};
  const auto cell_to_node = file.read_cell_to_node();
  const auto lineage = file.read_lineage();
  return balance::first_cell_of_run(comm,
                                    balance::work_from_marks(cell_to_node, file.read_integers(marks, later), lineage));
}

BlockMesh read_block(const par::Comm& comm, const std::filesystem::path& path, const ReadingOptions& options) {
  const auto& marks = options.marks_field;
  io::NativeFile file(comm, path, {.build_surfaces = options.build_surfaces, .remark = options.remark});
  return file.read(first_cell_to_read(comm, file, marks), find_work(file, marks));
}

BlockMesh along_curve(const par::Comm& comm, BlockMesh block) {
  auto ordered = order::order_along_curve(comm, std::move(block));
  ordered.block.cell_origin = std::move(ordered.cell_origin);
  return std::move(ordered.block);
}

/// Where the cells of a mesh go that was put in order: runs of about the same work.
std::vector<Rank> destinations(const par::Comm& comm, const BlockMesh& block, const std::string& marks) {
  std::vector<std::uint8_t> work(block.cell_to_node.size(), 1);
  for (const auto& field : block.cell_fields)
    if (field.name == marks && field.holds_integers() && field.n_components == 1)
      work = balance::work_from_marks(block.cell_to_node, field.integer(), block.lineage);
  return par::runs_of_equal_work(comm, work, comm.size());
}

mesh::DistMesh assemble_valid(const par::Comm& comm, const std::filesystem::path& file, BlockMesh block,
                              std::span<const Rank> destination) {
  auto mesh = with_file_name(file, [&] { return assemble::assemble(comm, std::move(block), destination); });
  validate::require_valid(comm, mesh, file.string());
  return mesh;
}

/// The mesh in order along a curve; nothing if anything is wrong that its own numbers should tell: the mesh, its marks
/// or its weights.
std::optional<mesh::DistMesh> assemble_in_order(const par::Comm& comm, const std::filesystem::path& file,
                                                BlockMesh block, const ReadingOptions& options, StepTimer& timer) {
  block = with_file_name(file, [&] { return along_curve(comm, std::move(block)); });
  timer.lap("preprocessing");
  std::vector<Rank> destination;
  if (comm.size() > 1) destination = destinations(comm, block, options.marks_field);
  timer.lap("balance");
  try {
    auto mesh = assemble_valid(comm, file, std::move(block), destination);
    signed_flags_from_field(comm, mesh, options.marks_field);
    if (options.balancing.weights == Weights::field) balance::weights_from_field(comm, mesh, options.balancing.field);
    return mesh;
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

Ordering ordering_named(const std::string& name) {
  return name == "curve" ? Ordering::curve : name == "keep" ? Ordering::keep : Ordering::automatic;
}

mesh::DistMesh read_for_refinement(const par::Comm& comm, const std::filesystem::path& file,
                                   const ReadingOptions& options, StepTimer& timer) {
  auto block = read_block(comm, file, options);
  timer.lap("read");
  if (options.ordering == Ordering::curve ||
      (options.ordering == Ordering::automatic && !order::is_ordered(comm, block))) {
    auto in_order = assemble_in_order(comm, file, std::move(block), options, timer);
    timer.lap("preprocessing");
    if (in_order) return *std::move(in_order);
    block = read_block(comm, file, options);
    timer.lap("read");
  }
  auto mesh = assemble_valid(comm, file, std::move(block), {});
  timer.lap("preprocessing");
  return mesh;
}

}  // namespace pamr::adapt
