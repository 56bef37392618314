// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/write_native.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "pamr/base/error.hpp"
#include "pamr/io/complete_outputs.hpp"
#include "pamr/io/native/checksum.hpp"
#include "pamr/io/native/hdf5.hpp"
#include "pamr/io/native/layout.hpp"
#include "pamr/io/native/write_plan.hpp"
#include "pamr/io/partial_file.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::io {

namespace {

using hdf5::Handle;
using mesh::StorageType;

/// Stores the words as values of type T; false when one does not fit. Reals are rounded, and their words with them.
template <class T>
bool store(std::span<std::uint64_t> words, std::vector<std::byte>& raw) {
  raw.resize(std::max(raw.size(), words.size() * sizeof(T)));
  bool fits = true;
  for (std::size_t i = 0; i < words.size(); ++i) {
    T value;
    if constexpr (std::is_floating_point_v<T>) {
      value = static_cast<T>(std::bit_cast<double>(words[i]));
      words[i] = std::bit_cast<std::uint64_t>(static_cast<double>(value));
    } else {
      value = static_cast<T>(words[i]);
      fits = fits && static_cast<std::int64_t>(value) == static_cast<std::int64_t>(words[i]);
    }
    std::memcpy(raw.data() + i * sizeof(T), &value, sizeof(T));
  }
  return fits;
}

/// The words as HDF5 takes them from memory: as they are or, of other types, in `raw`. Null when one does not fit.
const void* store(StorageType type, std::span<std::uint64_t> words, std::vector<std::byte>& raw) {
  const auto stored = [&](bool fits) { return fits ? raw.data() : nullptr; };
  switch (type) {
    case StorageType::float64:
    case StorageType::int64:
      return words.data();
    case StorageType::uint64:
      return std::any_of(words.begin(), words.end(), [](auto word) { return word >> 63U != 0; }) ? nullptr
                                                                                                 : words.data();
    case StorageType::float32:
      return stored(store<float>(words, raw));
    case StorageType::int32:
      return stored(store<std::int32_t>(words, raw));
    case StorageType::int16:
      return stored(store<std::int16_t>(words, raw));
    case StorageType::int8:
      return stored(store<std::int8_t>(words, raw));
    case StorageType::uint32:
      return stored(store<std::uint32_t>(words, raw));
    case StorageType::uint16:
      return stored(store<std::uint16_t>(words, raw));
    case StorageType::uint8:
      return stored(store<std::uint8_t>(words, raw));
  }
  return nullptr;
}

/// The mesh to write, and its file.
struct Job {
  const par::Comm& comm;
  const std::filesystem::path& file;
  const mesh::DistMesh& mesh;
  const WriteOptions& options;
  const WritePlan& plan;

  std::string at(const std::string& path, const std::string& trouble) const {
    return "file '" + file.string() + "', " + path + ": " + trouble;
  }
};

/// The file while it is open, with the datasets of the plan in their order.
struct OpenFile {
  Handle h5, transfer;
  std::vector<Handle> arrays, texts;
};

Handle text_type(std::size_t bytes, H5T_cset_t set) {
  auto type = hdf5::take(H5Tcopy(H5T_C_S1), H5Tclose, "cannot make a text type");
  hdf5::require(H5Tset_size(type.id(), bytes) >= 0 && H5Tset_strpad(type.id(), H5T_STR_NULLPAD) >= 0 &&
                    H5Tset_cset(type.id(), set) >= 0,
                "cannot make a text type");
  return type;
}

void write_text_attribute(hid_t object, const char* name, const std::string& text, H5T_cset_t set) {
  const auto type = text_type(std::max<std::size_t>(1, text.size()), set);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const auto attribute = hdf5::take(H5Acreate2(object, name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                                    std::string("cannot create attribute ") + name);
  hdf5::require(H5Awrite(attribute.id(), type.id(), text.c_str()) >= 0, std::string("cannot write attribute ") + name);
}

void write_number_attribute(hid_t object, const std::string& name, std::span<const std::int64_t> values, hid_t type) {
  const hsize_t n = values.size();
  const Handle space(n == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &n, nullptr), H5Sclose);
  const auto attribute = hdf5::take(H5Acreate2(object, name.c_str(), type, space.id(), H5P_DEFAULT, H5P_DEFAULT),
                                    H5Aclose, "cannot create attribute " + name);
  hdf5::require(H5Awrite(attribute.id(), type, values.data()) >= 0, "cannot write attribute " + name);
}

void create_groups(const Job& job, hid_t h5) {
  const auto properties = hdf5::take(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "cannot make a property list");
  H5Pset_obj_track_times(properties.id(), false);
  const auto make = [&](const std::string& group, hid_t link) {
    hdf5::take(H5Gcreate2(h5, group.c_str(), link, properties.id(), H5P_DEFAULT), H5Gclose,
               job.at(group, "cannot create it"));
  };
  for (const auto* group : {"/VTKHDF", path::point_data, path::cell_data, "/PAMR", path::patches, path::checksums})
    make(group, H5P_DEFAULT);
  const auto link = hdf5::take(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "cannot make a property list");
  H5Pset_char_encoding(link.id(), H5T_CSET_UTF8);
  for (const auto& group : job.plan.groups) make(group, link.id());
}

Handle create_array(const Job& job, const ArrayPlan& plan, hid_t h5, hid_t properties) {
  const std::array<hsize_t, 2> extent{static_cast<hsize_t>(plan.shape.rows), static_cast<hsize_t>(plan.shape.width)};
  const Handle space(H5Screate_simple(plan.shape.is_flat ? 1 : 2, extent.data(), nullptr), H5Sclose);
  const auto link = hdf5::take(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "cannot make a property list");
  H5Pset_char_encoding(link.id(), H5T_CSET_UTF8);
  auto dataset = hdf5::take(
      H5Dcreate2(h5, plan.path.c_str(), hdf5::file_type(plan.type), space.id(), link.id(), properties, H5P_DEFAULT),
      H5Dclose, job.at(plan.path, "cannot create it"));
  if (!plan.unit.empty()) write_text_attribute(dataset.id(), "unit", plan.unit, H5T_CSET_UTF8);
  return dataset;
}

Handle create_text(const Job& job, const TextPlan& plan, hid_t h5, hid_t properties) {
  std::size_t bytes = 1;
  for (const auto& text : plan.texts) bytes = std::max(bytes, text.size());
  const hsize_t n = plan.texts.size();
  const Handle space(plan.is_list ? H5Screate_simple(1, &n, nullptr) : H5Screate(H5S_SCALAR), H5Sclose);
  const auto type = text_type(bytes, H5T_CSET_UTF8);
  return hdf5::take(H5Dcreate2(h5, plan.path.c_str(), type.id(), space.id(), H5P_DEFAULT, properties, H5P_DEFAULT),
                    H5Dclose, job.at(plan.path, "cannot create it"));
}

/// All attributes; the checksums get their values when the data are written.
void write_attributes(const Job& job, hid_t h5, std::int64_t fingerprint) {
  const auto group = [&](const char* path) {
    return hdf5::take(H5Gopen2(h5, path, H5P_DEFAULT), H5Gclose, job.at(path, "cannot open it"));
  };
  const auto vtk = group("/VTKHDF"), pamr = group("/PAMR"), checksums = group(path::checksums);
  const auto number = [](const Handle& object, const std::string& name, std::int64_t value, hid_t type) {
    write_number_attribute(object.id(), name, std::array{value}, type);
  };
  write_number_attribute(vtk.id(), "Version", std::array<std::int64_t, 2>{1, 0}, H5T_STD_I64LE);
  write_text_attribute(vtk.id(), "Type", "UnstructuredGrid", H5T_CSET_ASCII);
  number(pamr, "format", job.plan.file_format, H5T_STD_I64LE);
  number(pamr, "fingerprint", fingerprint, H5T_STD_U64LE);
  if (job.mesh.info.first_id != 0) number(pamr, "first_id", job.mesh.info.first_id, H5T_STD_I64LE);
  write_text_attribute(pamr.id(), "length_unit", job.mesh.info.length_unit, H5T_CSET_UTF8);
  for (const auto& plan : job.plan.arrays)
    if (plan.has_checksum) number(checksums, checksum_path(plan.path), 0, H5T_STD_U64LE);
  for (const auto& plan : job.plan.texts)
    number(checksums, checksum_path(plan.path), std::bit_cast<std::int64_t>(checksum_of(plan.texts)), H5T_STD_U64LE);
}

/// Makes sure of the space before HDF5 opens the file, so that a full disk is noticed here, in a system call: HDF5 1.10
/// cannot close a file that it cannot complete. Collective.
void make_room(const Job& job, PartialFile& partial) {
  // Room for the structure of the file in addition to its data: generous, since it is given back.
  auto bytes = job.plan.data_bytes + 65536 + 4096 * (job.plan.arrays.size() + job.plan.texts.size());
  for (const auto& plan : job.plan.arrays) bytes += 4 * (plan.path.size() + plan.unit.size());
  bool has_room = true;
  par::agree(job.comm, [&] {
    require_writable(job.mesh, job.options.format);
    if (job.comm.is_first()) has_room = partial.make(bytes);
  });
  partial.share(job.comm);
  if (job.comm.all(has_room)) return;
  par::agree(job.comm, [&] {
    const auto share = par::block_range(static_cast<GlobalId>(bytes), job.comm.rank(), job.comm.size());
    partial.occupy(static_cast<std::uint64_t>(share.begin), static_cast<std::uint64_t>(share.end));
  });
}

/// Makes the file and everything in it but the values, and sets the space aside that HDF5 has laid out. Every rank
/// makes the same calls with the same arguments. Collective. `open` has what was opened even where this throws: HDF5
/// may not close it before it is diverted.
void create(const Job& job, const PartialFile& partial, std::int64_t fingerprint, OpenFile& open) {
  par::agree(job.comm, [&] {
    const par::Comm::Waiting waiting(job.comm, par::Comm::Waiting::In::library);
    const auto access = hdf5::parallel_access(job.comm, partial.path(), hdf5::Access::write);
    const auto creation = hdf5::take(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "cannot make a property list");
    H5Pset_obj_track_times(creation.id(), false);
    open.h5 = hdf5::take(H5Fcreate(partial.path().c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose,
                         "file '" + job.file.string() + "': cannot create it");
    open.transfer = hdf5::independent_transfer();
    const auto properties = hdf5::take(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "cannot make a property list");
    hdf5::require(H5Pset_obj_track_times(properties.id(), false) >= 0 &&
                      H5Pset_layout(properties.id(), H5D_CONTIGUOUS) >= 0 &&
                      H5Pset_alloc_time(properties.id(), H5D_ALLOC_TIME_EARLY) >= 0 &&
                      H5Pset_fill_time(properties.id(), H5D_FILL_TIME_NEVER) >= 0,
                  "cannot choose how datasets are stored");
    create_groups(job, open.h5.id());
    for (const auto& plan : job.plan.arrays)
      open.arrays.push_back(create_array(job, plan, open.h5.id(), properties.id()));
    for (const auto& plan : job.plan.texts) open.texts.push_back(create_text(job, plan, open.h5.id(), properties.id()));
    write_attributes(job, open.h5.id(), fingerprint);
  });
  // HDF5 does not know the size once its cache was too small for the structure (thousands of fields) and a part of it
  // was written; on the disk the file has it when the rest is written, too.
  hsize_t bytes = 0;
  const bool is_known = job.comm.all(H5Fget_filesize(open.h5.id(), &bytes) >= 0);
  par::agree(job.comm, [&] {
    if (is_known) return;
    const par::Comm::Waiting waiting(job.comm, par::Comm::Waiting::In::library);
    H5Eclear2(H5E_DEFAULT);
    hdf5::require(H5Fflush(open.h5.id(), H5F_SCOPE_LOCAL) >= 0, "file '" + job.file.string() + "': cannot write it");
  });
  par::agree(job.comm, [&] {
    if (!job.comm.is_first()) return;
    std::error_code failed;
    if (!is_known) bytes = std::filesystem::file_size(partial.path(), failed);
    if (failed) throw Error("file '" + job.file.string() + "': cannot tell its size: " + failed.message());
    partial.reserve(bytes);
  });
}

/// A dataset that is filled.
struct Target {
  const ArrayPlan& plan;
  hid_t dataset, transfer;
  Checksum& checksum;

  bool is_local() const { return plan.formula || stays(plan.rows); }
  /// Rows of which the words take so much memory.
  GlobalId rows_in(std::size_t bytes) const {
    return std::max<GlobalId>(1, static_cast<GlobalId>(bytes / (8 * plan.rows.width)));
  }
};

/// Rows on their way: their words, and what they are in the file.
struct Piece {
  Window window;
  std::vector<std::byte> raw;
};

/// Writes the rows of the window and adds them to the checksum. Local.
void write_window(const Job& job, const Target& target, Piece& piece) {
  const auto& plan = target.plan;
  auto& window = piece.window;
  if (window.missing > 0)
    throw Error(job.at(plan.path,
                       fmt::format("expected every row on some rank, found {} rows from number {} on that no rank has",
                                   window.missing, window.range.begin)));
  if (window.words.empty()) return;
  const auto* values = store(plan.type, window.words, piece.raw);
  if (values == nullptr)
    throw Error(job.at(plan.path, "expected values that fit " + hdf5::to_text(plan.type) + ", found others"));
  // A held row may stand for several rows of a flat dataset (the four entries of a cell in Connectivity).
  const auto file_rows = plan.rows.all.n == 0 ? 1 : plan.shape.rows / plan.rows.all.n;
  const auto first = (window.range.begin - plan.rows.all.first) * file_rows;
  if (plan.has_checksum) target.checksum.add(first, static_cast<std::size_t>(plan.shape.width), window.words);
  const bool done = job.comm.in_library([&] {
    return hdf5::write_rows({target.dataset, plan.shape, first, window.range.count() * file_rows},
                            hdf5::memory_type(plan.type), values, target.transfer);
  });
  hdf5::require(done, job.at(plan.path, "cannot write it"));
}

/// Writes rows that stay, in short pieces, which never leave the processor's cache. Local.
void write_local(const Job& job, const Target& target, Piece& piece) {
  const auto& plan = target.plan;
  auto& window = piece.window;
  const auto n_rows = target.rows_in(std::min<std::size_t>(job.options.slab_bytes, hdf5::cached_piece_bytes));
  const auto own = rows_written(plan.rows, job.comm.rank(), job.comm.size());
  for (auto begin = own.begin; begin < own.end; begin += n_rows) {
    const par::BlockRange range{begin, std::min(begin + n_rows, own.end)};
    if (plan.formula) {
      window.range = range;
      window.missing = 0;
      window.words.resize(static_cast<std::size_t>(range.count()));
      plan.formula(range.begin, window.words);
    } else {
      take_own(plan.rows, range, window);
    }
    write_window(job, target, piece);
  }
}

/// Bytes of rows that travel at once, the same on every rank. A rank holds them some five times: on their way from it,
/// on their way to it and in order. So they are a sixteenth of its share of the file, unless that is very little.
std::size_t travelling_bytes(const Job& job) {
  constexpr std::uint64_t least = std::uint64_t{64} << 10U;
  const std::uint64_t most = job.options.slab_bytes;
  const auto share = job.plan.data_bytes / static_cast<std::uint64_t>(job.comm.size());
  return std::min({most, std::uint64_t{hdf5::max_transfer_bytes}, std::max(least, share / 16)});
}

/// Writes rows that travel, slab by slab. Collective.
void write_travelling(const Job& job, const Target& target, Piece& piece) {
  const auto& rows = target.plan.rows;
  const auto slab = target.rows_in(travelling_bytes(job));
  GlobalId max_rows = 0;
  for (Rank rank = 0; rank < job.comm.size(); ++rank)
    max_rows = std::max(max_rows, rows_written(rows, rank, job.comm.size()).count());
  const auto n_steps = (max_rows + slab - 1) / slab;
  for (GlobalId step = 0; step < n_steps; ++step) {
    collect(job.comm, rows, step, slab, piece.window);
    par::agree(job.comm, [&] { write_window(job, target, piece); });
  }
}

void write_text(const Job& job, const TextPlan& plan, hid_t dataset, hid_t transfer) {
  const Handle type(H5Dget_type(dataset), H5Tclose);
  const auto bytes = H5Tget_size(type.id());
  std::vector<char> padded(std::max<std::size_t>(1, plan.texts.size() * bytes), '\0');
  for (std::size_t i = 0; i < plan.texts.size(); ++i)
    std::copy(plan.texts[i].begin(), plan.texts[i].end(), padded.data() + i * bytes);
  const Handle space(H5Dget_space(dataset), H5Sclose);
  if (!job.comm.is_first()) H5Sselect_none(space.id());
  hdf5::require(
      plan.texts.empty() || H5Dwrite(dataset, type.id(), space.id(), space.id(), transfer, padded.data()) >= 0,
      job.at(plan.path, "cannot write it"));
}

/// Writes the values, and then the checksums of them. Collective.
void fill(const Job& job, const PartialFile& partial, const OpenFile& open) {
  const auto& arrays = job.plan.arrays;
  std::vector<Checksum> checksums;
  for (const auto& plan : arrays) checksums.emplace_back(plan.has_checksum ? plan.shape.rows : 0);
  std::vector<Target> targets;
  for (std::size_t i = 0; i < arrays.size(); ++i)
    targets.push_back({arrays[i], open.arrays[i].id(), open.transfer.id(), checksums[i]});
  Piece piece;  // its memory is taken once
  std::uint64_t unflushed = 0;
  const auto flush_after = [&](const ArrayPlan& plan) {
    constexpr std::uint64_t enough = std::uint64_t{4} << 20U;
    unflushed += bytes_of(plan);
    if (unflushed < enough) return;
    partial.begin_flush();
    unflushed = 0;
  };
  for (const auto& target : targets) {
    if (target.is_local()) continue;
    write_travelling(job, target, piece);
    flush_after(target.plan);
  }
  par::agree(job.comm, [&] {
    for (const auto& target : targets) {
      if (!target.is_local()) continue;
      write_local(job, target, piece);
      flush_after(target.plan);
    }
  });
  const auto values = Checksum::results(job.comm, checksums);
  par::agree(job.comm, [&] {
    const par::Comm::Waiting waiting(job.comm, par::Comm::Waiting::In::library);
    const auto group = hdf5::take(H5Gopen2(open.h5.id(), path::checksums, H5P_DEFAULT), H5Gclose,
                                  job.at(path::checksums, "cannot open it"));
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      if (!arrays[i].has_checksum) continue;
      const auto attribute = hdf5::take(H5Aopen(group.id(), checksum_path(arrays[i].path).c_str(), H5P_DEFAULT),
                                        H5Aclose, job.at(path::checksums, "cannot open it"));
      hdf5::require(H5Awrite(attribute.id(), H5T_NATIVE_UINT64, &values[i]) >= 0,
                    job.at(path::checksums, "cannot write it"));
    }
    for (std::size_t i = 0; i < open.texts.size(); ++i)
      write_text(job, job.plan.texts[i], open.texts[i].id(), open.transfer.id());
  });
}

/// Closes everything; false when HDF5 could not write the rest. HDF5 1.10 keeps the identifier of a file that it could
/// not complete, and falls over it when the program ends: what it cannot write is diverted. Collective.
bool close(const par::Comm& comm, const PartialFile& partial, OpenFile& open) {
  const par::Comm::Waiting waiting(comm, par::Comm::Waiting::In::library);
  const bool complete = !open.h5.is_open() || H5Fflush(open.h5.id(), H5F_SCOPE_LOCAL) >= 0;
  if (!complete) partial.divert();
  open.arrays.clear();
  open.texts.clear();
  open.transfer.reset();
  return open.h5.reset() && complete;
}

}  // namespace

void write_native(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                  const WriteOptions& options) {
  const hdf5::Silence silence;
  validate::require_shapes(comm, mesh, "file '" + file.string() + "'");
  const WritePlan plan(comm, mesh, options.format, options.provenance);
  const Job job{comm, file, mesh, options, plan};
  const auto fingerprint = options.fingerprint ? *options.fingerprint : mesh::fingerprint(comm, mesh);
  if (options.remark && mesh::has_level0(mesh) && !writes_level0(mesh, options.format))
    options.remark(
        fmt::format("file '{}': format {} has no place for the map of level 0 at coarse curved walls: "
                    "refinements of this file place new nodes without it, which costs shape",
                    file.string(), int{options.format}));
  PartialFile partial(file);
  OpenFile open;
  try {
    make_room(job, partial);
    create(job, partial, std::bit_cast<std::int64_t>(fingerprint), open);
    fill(job, partial, open);
    const bool closed = close(comm, partial, open);
    par::agree(comm, [&] { hdf5::require(closed, "file '" + file.string() + "': cannot complete it"); });
    par::agree(comm, [&] {
      if (comm.is_first()) partial.commit();
    });
    add_complete_output(file);
  } catch (const Error&) {
    // Thrown by `agree`, thus on every rank.
    partial.divert();
    close(comm, partial, open);
    comm.barrier();
    if (comm.is_first()) partial.discard();
    throw;
  }
}

}  // namespace pamr::io
