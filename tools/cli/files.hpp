// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace pamr::cli {

/// The name of each file of a series, which ends in the file's number and an extension: 100 gives "flow-0000100.hdf".
using SeriesName = std::function<std::string(std::uint64_t)>;

/// True if both names lead to one file, which need not exist: by `.` and `..`, symbolic links or hard links. Local.
bool is_same_file(const std::string& a, const std::string& b);

/// True if this is the name, without its folder, of a file of the series. Local.
bool is_file_of(const SeriesName& series, const std::string& file_name);

/// Files of the series that are there and whose number is `first` or more, in the order of their numbers. Local.
std::vector<std::string> existing_files(const SeriesName& series, std::uint64_t first);

/// The files of one run: what it reads and what it writes. Each file is compared with all that were added before, in
/// whatever order, before anything is written. All functions are local, change no file, and throw `Error` if an output
/// is the same file (`is_same_file`) as an input or another output, or if one lies in a folder that another one
/// replaces.
class Files {
 public:
  /// It need not exist.
  void add_input(const std::string& path);
  /// `may_replace`: an input that this output may be; empty for none.
  void add_output(const std::string& path, const std::string& may_replace = {});
  /// A folder that is replaced, with everything in it.
  void add_folder(const std::string& path);
  /// Outputs whose numbers are not known yet.
  void add_series(const SeriesName& series, const std::string& may_replace = {});

  const std::vector<std::string>& inputs() const { return inputs_; }

 private:
  enum class Kind { input, output, folder, series };
  struct Place {
    Kind kind;
    std::string path;             ///< as given; of a series its file 0
    std::filesystem::path entry;  ///< absolute, without links but for the last part: what a rename replaces
    std::filesystem::path real;   ///< absolute, without links: what is read
    SeriesName series = {};
    std::string may_replace = {};
  };
  friend bool is_same_file(const std::string&, const std::string&);

  static Place place_of(Kind kind, const std::string& path);
  static bool are_same(const Place& a, const Place& b);
  static std::string member_of(const Place& series, const Place& other);
  static void require_apart(const Place& output, const Place& other);
  static void require_outside(const Place& output, const Place& other, const std::string& what);
  void add(Place place);

  std::vector<Place> places_;
  std::vector<std::string> inputs_;
};

}  // namespace pamr::cli
