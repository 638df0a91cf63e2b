// SPDX-License-Identifier: MIT
// Tables of numbers as CSV files: a line of column names, then one line per row. Lines that begin
// with # are comments.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/io/file.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace silt {

/// A table that is written row by row. Every row is on disc when row() returns, so that a run can
/// be watched, and evaluated if it fails. Numbers are written with the fewest digits that read back
/// as the same number. As a part of a checkpoint, the table resumes after the rows that it had when
/// the checkpoint was written; later rows are removed.
class CsvFile {
 public:
  /// The folder must exist. An existing file is kept until the first row is written, so that a
  /// checkpoint can be read before; it is then replaced. The lines of the comment are the first of
  /// the file, each after a #. Throws silt::Error if there are no columns, if read_csv() could not
  /// read the name of one, or if the file cannot be written.
  CsvFile(std::filesystem::path path, const std::vector<std::string>& columns,
          std::string_view comment = {})
      : path_(std::move(path)), columns_(columns.size()) {
    if (columns.empty()) {
      fail({"CsvFile: ", path_.string(), " has no columns; name at least one"});
    }
    for (auto name = columns.begin(); name != columns.end(); ++name) check_name(columns, name);
    while (!comment.empty()) {
      const std::string_view line = comment.substr(0, comment.find('\n'));
      comment.remove_prefix(std::min(comment.size(), line.size() + 1));
      head_ += "# ";
      head_ += line;
      head_ += '\n';
    }
    for (const std::string& name : columns) {
      if (&name != &columns.front()) head_ += ',';
      head_ += name;
    }
    head_ += '\n';
    open("ab");
    stream_.reset();
    std::error_code unknown;
    if (std::filesystem::file_size(path_, unknown) == 0) begin();
  }

  /// Replaces the file now, with a table without rows.
  void begin() {
    open("wb");
    size_ = 0;
    write(head_);
  }

  /// Adds a row. Throws silt::Error if it does not have one value per column, or cannot be written.
  void row(std::initializer_list<double> values) { row(std::span(values.begin(), values.size())); }
  void row(std::span<const double> values) {
    if (values.size() != columns_) {
      fail({"CsvFile: a row of ", values.size(), " values for the ", columns_, " columns of ",
            path_.string(), "; pass one value per column"});
    }
    std::string line;
    for (const double value : values) {
      if (!line.empty()) line += ',';
      line += file::digits(value);
    }
    if (!stream_) size_ > 0 ? resume() : begin();
    write(line + "\n");
  }

  /// For a checkpoint: the size of the file. Reading throws silt::Error if the file is now smaller.
  template <class Archive>
  void transfer(Archive& archive) {
    archive.same("columns", head_);
    archive("size", size_);
    if constexpr (Archive::reads) {
      if (size_ > 0) require_bytes();
      stream_.reset();
    }
  }

 private:
  using Names = std::vector<std::string>;
  void check_name(const Names& names, const Names::const_iterator& name) const {
    const bool is_unique = std::find(names.begin(), name, *name) == name;
    if (is_unique && !name->empty() && name->find_first_of(",\n\r") == std::string::npos) return;
    fail({"CsvFile: the column \"", *name, "\" of ", path_.string(),
          " has no name, the name of another one, or a comma or line break in it; rename it"});
  }

  void open(const char* mode) {
    errno = 0;
    stream_ = file::Stream(std::fopen(path_.string().c_str(), mode));
    if (!stream_) fail_to_write(file::last_error());
  }

  void require_bytes() const {
    std::error_code reason;
    const auto present = std::filesystem::file_size(path_, reason);
    if (reason) fail_to_write(reason);
    if (present < size_) {
      fail({"CsvFile: ", path_.string(), " has ", present, " bytes, but had ", size_,
            " when the checkpoint was written; restore that file, or restart the run from its "
            "beginning"});
    }
  }

  void resume() {
    require_bytes();
    std::error_code reason;
    std::filesystem::resize_file(path_, size_, reason);
    if (reason) fail_to_write(reason);
    open("ab");
  }

  void write(const std::string& line) {
    errno = 0;
    if (std::fwrite(line.data(), 1, line.size(), stream_.get()) != line.size() ||
        std::fflush(stream_.get()) != 0) {
      const std::error_code reason = file::last_error();
      stream_.reset();  // the next row truncates the file to the last complete row
      fail_to_write(reason);
    }
    size_ += line.size();
  }

  [[noreturn]] void fail_to_write(const std::error_code& reason) const {
    file::fail_with("CsvFile: cannot write", path_, reason,
                    "check that the folder exists, is writable and has space left");
  }

  std::filesystem::path path_;
  std::string head_;
  Index columns_;
  std::uint64_t size_ = 0;  // bytes written by this table
  // Shared, because read_checkpoint() reads into a copy.
  std::shared_ptr<std::FILE> stream_;
};

/// A table read from a file, with access by column name.
class CsvTable {
 public:
  /// `columns` has the numbers of each of the names, `lines` for messages the line in the file of
  /// each row. The name is that of the file.
  CsvTable(std::string name, std::vector<std::string> names,
           std::vector<std::vector<double>> columns, std::vector<Index> lines = {})
      : name_(std::move(name)),
        names_(std::move(names)),
        columns_(std::move(columns)),
        lines_(std::move(lines)) {}

  /// Names of the columns, in the order of the file.
  const std::vector<std::string>& names() const noexcept { return names_; }
  /// Number of rows.
  Index rows() const noexcept { return columns_.empty() ? 0 : columns_.front().size(); }

  /// The column of that name. Throws silt::Error, listing the columns, if there is none.
  const std::vector<double>& operator[](std::string_view column) const {
    const auto found = std::find(names_.begin(), names_.end(), column);
    if (found == names_.end()) {
      std::string all;
      for (const std::string& name : names_) all += (all.empty() ? "" : ", ") + name;
      fail({"CsvTable: ", name_, " has no column ", (column.empty() ? "\"\"" : std::string(column)),
            "; it has ", all});
    }
    return columns_[static_cast<Index>(found - names_.begin())];
  }

  /// Throws silt::Error for an invalid number: file, line and column, the number, and the reason
  /// ("must be …").
  [[noreturn]] void reject(Index row, std::string_view column, const std::string& reason) const {
    const std::string line =
        row < lines_.size() ? ", line " + std::to_string(lines_[row]) : std::string();
    fail({name_, line, ", column ", column, ": ", file::digits((*this)[column][row]), " ", reason,
          "; correct it"});
  }

 private:
  std::string name_;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
  std::vector<Index> lines_;  // line in the file of each row
};

/// Reads a table of numbers. Blank lines, lines that begin with #, and blanks around a number are
/// skipped. Throws silt::Error, naming line and column, if a value is not a number, a row is too
/// short or too long, two columns have the same name, or the file cannot be read.
inline CsvTable read_csv(const std::filesystem::path& path) {
  const auto trimmed = [](std::string_view text) {
    constexpr std::string_view blanks = " \t\r";
    const auto from = text.find_first_not_of(blanks);
    if (from == std::string_view::npos) return std::string_view{};
    return text.substr(from, text.find_last_not_of(blanks) - from + 1);
  };
  const auto cells_of = [&](std::string_view line) {
    std::vector<std::string_view> cells;
    for (auto comma = line.find(','); comma != std::string_view::npos; comma = line.find(',')) {
      cells.push_back(trimmed(line.substr(0, comma)));
      line.remove_prefix(comma + 1);
    }
    cells.push_back(trimmed(line));
    return cells;
  };

  const std::string bytes = file::read("read_csv", path);
  std::string_view rest = bytes;
  // Some programs write a byte order mark at the beginning.
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  std::vector<Index> lines;
  for (Index number = 1; !rest.empty(); ++number) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    const std::string where = "read_csv: " + path.string() + ", line " + std::to_string(number);
    const auto cells = cells_of(text);
    if (names.empty()) {
      for (const std::string_view name : cells) {
        if (name.empty() || std::find(names.begin(), names.end(), name) != names.end()) {
          fail({where, ": the column name \"", name,
                "\" is empty or used twice; give every column a unique name"});
        }
        names.emplace_back(name);
      }
      columns.resize(names.size());
      continue;
    }
    if (cells.size() != names.size()) {
      fail({where, ": ", cells.size(), " values for ", names.size(),
            " columns; write one value per column"});
    }
    lines.push_back(number);
    for (Index c = 0; c < cells.size(); ++c) {
      const auto value = file::number(cells[c]);
      if (!value) {
        fail({where, ", column ", names[c], ": \"", cells[c], "\" is not a number; correct it"});
      }
      columns[c].push_back(*value);
    }
  }
  if (names.empty()) {
    fail(
        {"read_csv: ", path.string(), " has no line of column names; check that it is a CSV file"});
  }
  return {path.string(), std::move(names), std::move(columns), std::move(lines)};
}

}  // namespace silt
