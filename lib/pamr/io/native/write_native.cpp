// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/write_native.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "pamr/base/error.hpp"
#include "pamr/io/native/checksum.hpp"
#include "pamr/io/native/hdf5.hpp"
#include "pamr/io/native/layout.hpp"
#include "pamr/io/native/write_plan.hpp"
#include "pamr/io/partial_file.hpp"
#include "pamr/mesh/fingerprint.hpp"

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

class Writer {
 public:
  Writer(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
         const WriteOptions& options)
      : comm_(&comm),
        file_(file),
        partial_(file),
        mesh_(&mesh),
        options_(options),
        plan_(comm, mesh, options.format, options.provenance) {
    options_.slab_bytes = std::min<std::size_t>(options_.slab_bytes, hdf5::max_transfer_bytes);
  }

  void run();

 private:
  std::string at(const std::string& path, const std::string& trouble) const {
    return "file '" + file_.string() + "', " + path + ": " + trouble;
  }

  void make_room();
  void create();
  void create_groups();
  Handle create_array(const ArrayPlan& plan) const;
  Handle create_text(const TextPlan& plan) const;
  Handle text_type(std::size_t bytes, H5T_cset_t set) const;
  void write_text_attribute(hid_t object, const char* name, const std::string& text, H5T_cset_t set) const;
  void write_number_attribute(hid_t object, const std::string& name, std::span<const std::int64_t> values,
                              hid_t type) const;
  void write_attributes() const;
  void reserve() const;
  void fill();
  bool is_local(const ArrayPlan& plan) const { return plan.formula || stays(plan.rows); }
  GlobalId rows_in(std::size_t bytes, const ArrayPlan& plan) const;
  void write_local(const ArrayPlan& plan, hid_t dataset, Checksum& checksum);
  void write_travelling(const ArrayPlan& plan, hid_t dataset, Checksum& checksum);
  void evaluate(const ArrayPlan& plan, par::BlockRange range);
  void write_window(const ArrayPlan& plan, hid_t dataset, Checksum& checksum);
  void write_text(const TextPlan& plan, hid_t dataset) const;
  bool close();

  const par::Comm* comm_;
  std::filesystem::path file_;
  PartialFile partial_;
  const mesh::DistMesh* mesh_;
  WriteOptions options_;
  WritePlan plan_;
  std::int64_t fingerprint_ = 0;
  Handle h5_, dataset_properties_, transfer_;
  std::vector<Handle> arrays_, texts_;
  Window window_;               ///< the rows that are being written, and
  std::vector<std::byte> raw_;  ///< what they are in the file
};

void Writer::run() {
  fingerprint_ =
      std::bit_cast<std::int64_t>(options_.fingerprint ? *options_.fingerprint : mesh::fingerprint(*comm_, *mesh_));
  try {
    make_room();
    create();
    reserve();
    fill();
    const bool closed = close();
    par::agree(*comm_, [&] { hdf5::require(closed, "file '" + file_.string() + "': cannot complete it"); });
    par::agree(*comm_, [&] {
      if (comm_->is_first()) partial_.commit();
    });
  } catch (const Error&) {
    // Thrown by `agree`, thus on every rank.
    partial_.divert();
    close();
    comm_->barrier();
    if (comm_->is_first()) partial_.discard();
    throw;
  }
}

/// Makes the file and everything in it but the values. Every rank makes the same calls with the same arguments.
void Writer::create() {
  par::agree(*comm_, [&] {
    const par::Comm::Waiting waiting(*comm_, par::Comm::Waiting::In::library);
    const auto access = hdf5::parallel_access(*comm_, partial_.path());
    const auto creation = hdf5::take(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "cannot make a property list");
    H5Pset_obj_track_times(creation.id(), false);
    h5_ = hdf5::take(H5Fcreate(partial_.path().c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose,
                     "file '" + file_.string() + "': cannot create it");
    transfer_ = hdf5::independent_transfer();
    dataset_properties_ = hdf5::take(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "cannot make a property list");
    hdf5::require(H5Pset_obj_track_times(dataset_properties_.id(), false) >= 0 &&
                      H5Pset_layout(dataset_properties_.id(), H5D_CONTIGUOUS) >= 0 &&
                      H5Pset_alloc_time(dataset_properties_.id(), H5D_ALLOC_TIME_EARLY) >= 0 &&
                      H5Pset_fill_time(dataset_properties_.id(), H5D_FILL_TIME_NEVER) >= 0,
                  "cannot choose how datasets are stored");
    create_groups();
    for (const auto& plan : plan_.arrays) arrays_.push_back(create_array(plan));
    for (const auto& plan : plan_.texts) texts_.push_back(create_text(plan));
    write_attributes();
  });
}

void Writer::create_groups() {
  const auto properties = hdf5::take(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "cannot make a property list");
  H5Pset_obj_track_times(properties.id(), false);
  const auto make = [&](const std::string& group, hid_t link) {
    hdf5::take(H5Gcreate2(h5_.id(), group.c_str(), link, properties.id(), H5P_DEFAULT), H5Gclose,
               at(group, "cannot create it"));
  };
  for (const auto* group : {"/VTKHDF", path::point_data, path::cell_data, "/PAMR", path::patches, path::checksums})
    make(group, H5P_DEFAULT);
  const auto link = hdf5::take(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "cannot make a property list");
  H5Pset_char_encoding(link.id(), H5T_CSET_UTF8);
  for (const auto& group : plan_.groups) make(group, link.id());
}

Handle Writer::create_array(const ArrayPlan& plan) const {
  const std::array<hsize_t, 2> extent{static_cast<hsize_t>(plan.shape.rows), static_cast<hsize_t>(plan.shape.width)};
  const Handle space(H5Screate_simple(plan.shape.is_flat ? 1 : 2, extent.data(), nullptr), H5Sclose);
  const auto link = hdf5::take(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "cannot make a property list");
  H5Pset_char_encoding(link.id(), H5T_CSET_UTF8);
  auto dataset = hdf5::take(H5Dcreate2(h5_.id(), plan.path.c_str(), hdf5::file_type(plan.type), space.id(), link.id(),
                                       dataset_properties_.id(), H5P_DEFAULT),
                            H5Dclose, at(plan.path, "cannot create it"));
  if (!plan.unit.empty()) write_text_attribute(dataset.id(), "unit", plan.unit, H5T_CSET_UTF8);
  return dataset;
}

Handle Writer::create_text(const TextPlan& plan) const {
  std::size_t bytes = 1;
  for (const auto& text : plan.texts) bytes = std::max(bytes, text.size());
  const hsize_t n = plan.texts.size();
  const Handle space(plan.is_list ? H5Screate_simple(1, &n, nullptr) : H5Screate(H5S_SCALAR), H5Sclose);
  const auto type = text_type(bytes, H5T_CSET_UTF8);
  return hdf5::take(H5Dcreate2(h5_.id(), plan.path.c_str(), type.id(), space.id(), H5P_DEFAULT,
                               dataset_properties_.id(), H5P_DEFAULT),
                    H5Dclose, at(plan.path, "cannot create it"));
}

Handle Writer::text_type(std::size_t bytes, H5T_cset_t set) const {
  auto type = hdf5::take(H5Tcopy(H5T_C_S1), H5Tclose, "cannot make a text type");
  hdf5::require(H5Tset_size(type.id(), bytes) >= 0 && H5Tset_strpad(type.id(), H5T_STR_NULLPAD) >= 0 &&
                    H5Tset_cset(type.id(), set) >= 0,
                "cannot make a text type");
  return type;
}

void Writer::write_text_attribute(hid_t object, const char* name, const std::string& text, H5T_cset_t set) const {
  const auto type = text_type(std::max<std::size_t>(1, text.size()), set);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const auto attribute = hdf5::take(H5Acreate2(object, name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                                    std::string("cannot create attribute ") + name);
  hdf5::require(H5Awrite(attribute.id(), type.id(), text.c_str()) >= 0, std::string("cannot write attribute ") + name);
}

void Writer::write_number_attribute(hid_t object, const std::string& name, std::span<const std::int64_t> values,
                                    hid_t type) const {
  const hsize_t n = values.size();
  const Handle space(n == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &n, nullptr), H5Sclose);
  const auto attribute = hdf5::take(H5Acreate2(object, name.c_str(), type, space.id(), H5P_DEFAULT, H5P_DEFAULT),
                                    H5Aclose, "cannot create attribute " + name);
  hdf5::require(H5Awrite(attribute.id(), type, values.data()) >= 0, "cannot write attribute " + name);
}

/// All attributes; the checksums get their values when the data are written.
void Writer::write_attributes() const {
  const auto group = [&](const char* path) {
    return hdf5::take(H5Gopen2(h5_.id(), path, H5P_DEFAULT), H5Gclose, at(path, "cannot open it"));
  };
  const auto vtk = group("/VTKHDF"), pamr = group("/PAMR"), checksums = group(path::checksums);
  write_number_attribute(vtk.id(), "Version", std::array<std::int64_t, 2>{1, 0}, H5T_STD_I64LE);
  write_text_attribute(vtk.id(), "Type", "UnstructuredGrid", H5T_CSET_ASCII);
  write_number_attribute(pamr.id(), "format", std::array<std::int64_t, 1>{options_.format}, H5T_STD_I64LE);
  write_number_attribute(pamr.id(), "fingerprint", std::array<std::int64_t, 1>{fingerprint_}, H5T_STD_U64LE);
  if (mesh_->info.first_id != 0)
    write_number_attribute(pamr.id(), "first_id", std::array<std::int64_t, 1>{mesh_->info.first_id}, H5T_STD_I64LE);
  write_text_attribute(pamr.id(), "length_unit", mesh_->info.length_unit, H5T_CSET_UTF8);
  for (const auto& plan : plan_.arrays)
    if (plan.has_checksum)
      write_number_attribute(checksums.id(), checksum_path(plan.path), std::array<std::int64_t, 1>{0}, H5T_STD_U64LE);
  for (const auto& plan : plan_.texts)
    write_number_attribute(checksums.id(), checksum_path(plan.path),
                           std::array<std::int64_t, 1>{std::bit_cast<std::int64_t>(checksum_of(plan.texts))},
                           H5T_STD_U64LE);
}

/// Makes sure of the space before HDF5 opens the file, so that a full disk is noticed here, in a system call: HDF5 1.10
/// cannot close a file that it cannot complete.
void Writer::make_room() {
  // Room for the structure of the file in addition to its data: generous, since it is given back.
  const auto bytes = plan_.data_bytes + 65536 + 4096 * (plan_.arrays.size() + plan_.texts.size());
  bool has_room = true;
  par::agree(*comm_, [&] {
    require_writable(*mesh_, options_.format);
    if (comm_->is_first()) has_room = partial_.make(bytes);
  });
  partial_.share(*comm_);
  if (comm_->all(has_room)) return;
  par::agree(*comm_, [&] {
    const auto share = par::block_range(static_cast<GlobalId>(bytes), comm_->rank(), comm_->size());
    partial_.occupy(static_cast<std::uint64_t>(share.begin), static_cast<std::uint64_t>(share.end));
  });
}

/// Sets the space of the file aside that HDF5 has laid out.
void Writer::reserve() const {
  par::agree(*comm_, [&] {
    hsize_t bytes = 0;
    hdf5::require(H5Fget_filesize(h5_.id(), &bytes) >= 0, "file '" + file_.string() + "': cannot tell its size");
    if (comm_->is_first()) partial_.reserve(bytes);
  });
}

void Writer::fill() {
  std::vector<Checksum> checksums;
  for (const auto& plan : plan_.arrays) checksums.emplace_back(plan.has_checksum ? plan.shape.rows : 0);
  for (std::size_t i = 0; i < arrays_.size(); ++i)
    if (!is_local(plan_.arrays[i])) write_travelling(plan_.arrays[i], arrays_[i].id(), checksums[i]);
  par::agree(*comm_, [&] {
    for (std::size_t i = 0; i < arrays_.size(); ++i)
      if (is_local(plan_.arrays[i])) write_local(plan_.arrays[i], arrays_[i].id(), checksums[i]);
  });
  const auto values = Checksum::results(*comm_, checksums);
  par::agree(*comm_, [&] {
    const par::Comm::Waiting waiting(*comm_, par::Comm::Waiting::In::library);
    const auto group =
        hdf5::take(H5Gopen2(h5_.id(), path::checksums, H5P_DEFAULT), H5Gclose, at(path::checksums, "cannot open it"));
    for (std::size_t i = 0; i < arrays_.size(); ++i) {
      if (!plan_.arrays[i].has_checksum) continue;
      const auto attribute = hdf5::take(H5Aopen(group.id(), checksum_path(plan_.arrays[i].path).c_str(), H5P_DEFAULT),
                                        H5Aclose, at(path::checksums, "cannot open it"));
      hdf5::require(H5Awrite(attribute.id(), H5T_NATIVE_UINT64, &values[i]) >= 0,
                    at(path::checksums, "cannot write it"));
    }
    for (std::size_t i = 0; i < texts_.size(); ++i) write_text(plan_.texts[i], texts_[i].id());
  });
}

/// Rows of which the words take so much memory.
GlobalId Writer::rows_in(std::size_t bytes, const ArrayPlan& plan) const {
  return std::max<GlobalId>(1, static_cast<GlobalId>(bytes / (8 * plan.rows.width)));
}

/// Writes rows that stay, in short pieces, which never leave the processor's cache. Local.
void Writer::write_local(const ArrayPlan& plan, hid_t dataset, Checksum& checksum) {
  const auto piece = rows_in(std::min<std::size_t>(options_.slab_bytes, hdf5::cached_piece_bytes), plan);
  const auto own = rows_written(plan.rows, comm_->rank(), comm_->size());
  for (auto begin = own.begin; begin < own.end; begin += piece) {
    const par::BlockRange range{begin, std::min(begin + piece, own.end)};
    if (plan.formula)
      evaluate(plan, range);
    else
      take_own(plan.rows, range, window_);
    write_window(plan, dataset, checksum);
  }
}

/// Writes rows that travel, slab by slab. Collective.
void Writer::write_travelling(const ArrayPlan& plan, hid_t dataset, Checksum& checksum) {
  const auto slab = rows_in(options_.slab_bytes, plan);
  GlobalId max_rows = 0;
  for (Rank rank = 0; rank < comm_->size(); ++rank)
    max_rows = std::max(max_rows, rows_written(plan.rows, rank, comm_->size()).count());
  const auto n_steps = (max_rows + slab - 1) / slab;
  for (GlobalId step = 0; step < n_steps; ++step) {
    collect(*comm_, plan.rows, step, slab, window_);
    par::agree(*comm_, [&] { write_window(plan, dataset, checksum); });
  }
}

void Writer::evaluate(const ArrayPlan& plan, par::BlockRange range) {
  window_.range = range;
  window_.missing = 0;
  window_.words.resize(static_cast<std::size_t>(range.count()));
  plan.formula(range.begin, window_.words);
}

/// Writes the rows of the window and adds them to the checksum. Local.
void Writer::write_window(const ArrayPlan& plan, hid_t dataset, Checksum& checksum) {
  if (window_.missing > 0)
    throw Error(
        at(plan.path, fmt::format("expected every row on some rank, found {} rows from number {} on that no rank has",
                                  window_.missing, window_.range.begin)));
  if (window_.words.empty()) return;
  const auto* values = store(plan.type, window_.words, raw_);
  if (values == nullptr)
    throw Error(at(plan.path, "expected values that fit " + hdf5::to_text(plan.type) + ", found others"));
  // A held row may stand for several rows of a flat dataset (the four entries of a cell in Connectivity).
  const auto file_rows = plan.rows.all.n == 0 ? 1 : plan.shape.rows / plan.rows.all.n;
  const auto first = (window_.range.begin - plan.rows.all.first) * file_rows;
  if (plan.has_checksum) checksum.add(first, static_cast<std::size_t>(plan.shape.width), window_.words);
  const bool done = comm_->in_library([&] {
    return hdf5::write_rows({dataset, plan.shape, first, window_.range.count() * file_rows},
                            hdf5::memory_type(plan.type), values, transfer_.id());
  });
  hdf5::require(done, at(plan.path, "cannot write it"));
}

void Writer::write_text(const TextPlan& plan, hid_t dataset) const {
  const Handle type(H5Dget_type(dataset), H5Tclose);
  const auto bytes = H5Tget_size(type.id());
  std::vector<char> padded(std::max<std::size_t>(1, plan.texts.size() * bytes), '\0');
  for (std::size_t i = 0; i < plan.texts.size(); ++i)
    std::copy(plan.texts[i].begin(), plan.texts[i].end(), padded.data() + i * bytes);
  const Handle space(H5Dget_space(dataset), H5Sclose);
  if (!comm_->is_first()) H5Sselect_none(space.id());
  hdf5::require(
      plan.texts.empty() || H5Dwrite(dataset, type.id(), space.id(), space.id(), transfer_.id(), padded.data()) >= 0,
      at(plan.path, "cannot write it"));
}

/// Closes everything; false when HDF5 could not write the rest. HDF5 1.10 keeps the identifier of a file that it could
/// not complete, and falls over it when the program ends: what it cannot write is diverted. Collective.
bool Writer::close() {
  const par::Comm::Waiting waiting(*comm_, par::Comm::Waiting::In::library);
  const bool complete = !h5_.is_open() || H5Fflush(h5_.id(), H5F_SCOPE_LOCAL) >= 0;
  if (!complete) partial_.divert();
  arrays_.clear();
  texts_.clear();
  dataset_properties_.reset();
  transfer_.reset();
  return h5_.reset() && complete;
}

}  // namespace

void write_native(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                  const WriteOptions& options) {
  const hdf5::Silence silence;
  Writer(comm, file, mesh, options).run();
}

}  // namespace pamr::io
