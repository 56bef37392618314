// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/saved_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <numeric>

#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/io/shared_output.hpp"
#include "pamr/par/sum_modulo.hpp"

namespace pamr::adapt::detail {

namespace {

static_assert(std::endian::native == std::endian::little, "the file has numbers with the least byte first");

/// The head of the file.
struct RowsHeader {
  std::array<char, 8> magic{'P', 'A', 'M', 'R', 'r', 'o', 'w', 's'};
  std::uint64_t version = 1, item_bytes = 0, n_cells = 0, n_items = 0, mesh_hash = 0, rows_hash = 0;
  std::array<char, max_rows_description> description{};  ///< zeros behind it
};
static_assert(sizeof(RowsHeader) == 120);

/// Tells meshes and their numberings apart: of each cell its number and its corners.
std::uint64_t hash_of_cells(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::uint64_t sum = 0;
  for (std::size_t c = 0; c < mesh.cell_to_node.size(); ++c) {
    auto h = combine(0, static_cast<std::uint64_t>(mesh.cell_global[c] - mesh.info.first_id));
    for (const auto p : mesh.points(static_cast<LocalId>(c)))
      h = combine(combine(combine(h, bits_of(p.x)), bits_of(p.y)), bits_of(p.z));
    sum += h;
  }
  return par::sum_modulo(comm, sum);
}

/// Of each row its place, its length and its bytes.
std::uint64_t hash_of_rows(const par::Comm& comm, GlobalId first_row, std::span<const std::size_t> offset,
                           std::span<const std::byte> value, std::size_t item_bytes) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i + 1 < offset.size(); ++i) {
    const auto row = value.subspan(offset[i] * item_bytes, (offset[i + 1] - offset[i]) * item_bytes);
    auto h = combine(combine(0, static_cast<std::uint64_t>(first_row) + i), row.size());
    for (std::size_t at = 0; at < row.size(); at += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, row.data() + at, std::min<std::size_t>(8, row.size() - at));
      h = combine(h, word);
    }
    sum += h;
  }
  return par::sum_modulo(comm, sum);
}

std::vector<GlobalId> block_of(const par::Comm& comm, IdRange cells) {
  const auto block = par::block_range(cells.n, comm.rank(), comm.size());
  std::vector<GlobalId> ids(at(block.end - block.begin));
  std::iota(ids.begin(), ids.end(), cells.first + block.begin);
  return ids;
}

/// Reads parts of a file; what is wrong with it becomes an `Error` with its name.
class RowsFile {
 public:
  explicit RowsFile(const std::filesystem::path& file) : name_(file.string()), in_(file, std::ios::binary) {
    if (!in_.is_open()) throw Error(fmt::format("file '{}': expected a file that can be read, found none", name_));
    in_.seekg(0, std::ios::end);
    size_ = static_cast<std::uint64_t>(std::max<std::streamoff>(0, in_.tellg()));
  }

  std::uint64_t size() const { return size_; }

  void read(std::uint64_t from, std::span<std::byte> to) {
    in_.seekg(static_cast<std::streamoff>(from));
    in_.read(reinterpret_cast<char*>(to.data()), static_cast<std::streamsize>(to.size()));
    if (!in_.good()) fail(fmt::format("{} bytes from byte {} on", to.size(), from), "its end");
  }

  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    throw Error(fmt::format("file '{}': expected {}, found {}", name_, expected, found));
  }

 private:
  std::string name_;
  std::ifstream in_;
  std::uint64_t size_ = 0;
};

RowsHeader read_header(RowsFile& file, std::uint64_t n_cells, std::size_t item_bytes) {
  RowsHeader header;
  if (file.size() < sizeof header) file.fail("data of cells as PAMR writes them", "a shorter file");
  file.read(0, std::as_writable_bytes(std::span(&header, 1)));
  if (header.magic != RowsHeader{}.magic) file.fail("data of cells as PAMR writes them", "another kind of file");
  if (header.version != 1) file.fail("version 1", fmt::format("version {}", header.version));
  if (item_bytes != 0 && header.item_bytes != item_bytes)
    file.fail(fmt::format("items of {} bytes", item_bytes), fmt::format("{}", header.item_bytes));
  if (header.n_cells != n_cells)
    file.fail(fmt::format("data of {} cells, as the mesh has", n_cells), fmt::format("{}", header.n_cells));
  const auto rest = file.size() - sizeof header;
  const bool fits = header.item_bytes > 0 && n_cells < rest / 8 &&
                    header.n_items <= (rest - 8 * (n_cells + 1)) / header.item_bytes &&
                    rest == 8 * (n_cells + 1) + header.n_items * header.item_bytes;
  if (!fits)
    file.fail(fmt::format("a file as long as its head says ({} items of {} bytes)", header.n_items, header.item_bytes),
              fmt::format("{} bytes", file.size()));
  return header;
}

/// The rows of this rank's block, offsets from 0.
CellRows<std::byte> read_block(RowsFile& file, const RowsHeader& header, GlobalId begin, GlobalId end) {
  CellRows<std::byte> rows{std::vector<std::size_t>(at(end - begin) + 1), {}};
  static_assert(sizeof(std::size_t) == 8);
  file.read(sizeof header + 8 * static_cast<std::uint64_t>(begin), std::as_writable_bytes(std::span(rows.offset)));
  if (begin == 0 && rows.offset.front() != 0) file.fail("rows that begin at 0", fmt::format("{}", rows.offset.front()));
  for (std::size_t i = 0; i < rows.offset.size(); ++i)
    if (rows.offset[i] > header.n_items || (i > 0 && rows.offset[i] < rows.offset[i - 1]))
      file.fail(fmt::format("rows one after another, within {} items", header.n_items),
                fmt::format("one that begins at {} (cell {})", rows.offset[i], static_cast<std::size_t>(begin) + i));
  if (static_cast<std::uint64_t>(end) == header.n_cells && rows.offset.back() != header.n_items)
    file.fail(fmt::format("rows that end at item {}", header.n_items), fmt::format("{}", rows.offset.back()));
  const auto first = rows.offset.front();
  rows.value.resize((rows.offset.back() - first) * header.item_bytes);
  if (!rows.value.empty()) file.read(sizeof header + 8 * (header.n_cells + 1) + first * header.item_bytes, rows.value);
  for (auto& offset : rows.offset) offset -= first;
  return rows;
}

}  // namespace

void write_cell_rows(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                     const ByteRows& rows, const std::string& description) {
  par::agree(comm, [&] {
    if (description.size() > max_rows_description)
      throw Error(fmt::format("description of data of cells: expected {} bytes at most, found {}", max_rows_description,
                              description.size()));
  });
  const auto cells = mesh.info.cell_ids();
  const auto ids = block_of(comm, cells);
  const auto block = fetch_cell_rows(comm, cells, mesh.cell_global, rows, ids);
  const auto n_items = static_cast<std::int64_t>(block.offset.back());
  const auto first_item = static_cast<std::uint64_t>(comm.exclusive_sum(n_items));
  RowsHeader header;
  header.item_bytes = rows.item_bytes;
  header.n_cells = static_cast<std::uint64_t>(cells.n);
  header.n_items = static_cast<std::uint64_t>(comm.sum(n_items));
  header.mesh_hash = hash_of_cells(comm, mesh);
  header.rows_hash = hash_of_rows(comm, par::block_range(cells.n, comm.rank(), comm.size()).begin, block.offset,
                                  block.value, rows.item_bytes);
  std::copy(description.begin(), description.end(), header.description.begin());
  std::vector<std::uint64_t> ends;
  if (comm.is_first()) ends.push_back(0);
  for (std::size_t i = 1; i < block.offset.size(); ++i) ends.push_back(first_item + block.offset[i]);

  io::SharedOutput out(comm, file);
  out.append(comm.is_first() ? std::as_bytes(std::span(&header, 1)) : std::span<const std::byte>{});
  out.append(std::as_bytes(std::span(ends)));
  out.append(block.value);
  out.commit();
}

std::pair<CellRows<std::byte>, std::string> read_cell_rows(const par::Comm& comm, const std::filesystem::path& file,
                                                           const mesh::DistMesh& mesh, std::size_t item_bytes) {
  const auto cells = mesh.info.cell_ids();
  const auto range = par::block_range(cells.n, comm.rank(), comm.size());
  RowsHeader header;
  CellRows<std::byte> block;
  par::agree(comm, [&] {
    RowsFile in(file);
    header = read_header(in, static_cast<std::uint64_t>(cells.n), item_bytes);
    block = read_block(in, header, range.begin, range.end);
  });
  const auto refuse = [&](const std::string& expected, const std::string& found) {
    throw Error(fmt::format("file '{}': expected {}, found {}", file.string(), expected, found));
  };
  if (hash_of_rows(comm, range.begin, block.offset, block.value, header.item_bytes) != header.rows_hash)
    refuse("rows that agree with their checksum", "others: the file is damaged");
  if (hash_of_cells(comm, mesh) != header.mesh_hash)
    refuse("the mesh that the data were written with, in its numbering", "another one");
  auto rows = fetch_cell_rows(comm, cells, block_of(comm, cells), {block.offset, block.value, header.item_bytes},
                              mesh.cell_global);
  const auto end = std::find(header.description.begin(), header.description.end(), '\0');
  return {std::move(rows), std::string(header.description.begin(), end)};
}

}  // namespace pamr::adapt::detail
