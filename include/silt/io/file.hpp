// SPDX-License-Identifier: MIT
// Errors of files, folders, reading whole files, and conversion between numbers and text.
#pragma once

#include <silt/core/error.hpp>

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#if !defined(__cpp_lib_to_chars)
#include <silt/io/number_by_strtod.hpp>
#endif

namespace silt::file {

/// Closes a file that a Stream held.
struct Close {
  void operator()(std::FILE* stream) const noexcept { std::fclose(stream); }
};
/// An open file, closed at the end of its life.
using Stream = std::unique_ptr<std::FILE, Close>;

/// Throws silt::Error for a failed system call on a file: `what` names the function and the action
/// that failed, `advice` is what the user can do.
[[noreturn, gnu::cold]] inline void fail_with(const std::string& what, const std::filesystem::path& path,
                                   const std::error_code& reason, const std::string& advice) {
  fail({what, " ", (path.empty() ? "\"\"" : path.string()), ": ", reason.message(), "; ", advice});
}

/// The reason why a function of the C library failed.
inline std::error_code last_error() { return {errno, std::generic_category()}; }

/// Whether a file exists. Throws silt::Error, with a message that begins with `caller`, if that
/// cannot be determined, such as for lack of permission.
inline bool exists(const std::string& caller, const std::filesystem::path& path) {
  std::error_code reason;
  const bool answer = std::filesystem::exists(path, reason);
  if (reason) fail_with(caller + ": cannot access", path, reason, "check the path");
  return answer;
}

/// Creates a folder and its parents. Throws silt::Error, with a message that begins with `caller`,
/// if that fails.
inline void create_folder(const std::string& caller, const std::filesystem::path& folder) {
  std::error_code reason;
  std::filesystem::create_directories(folder, reason);
  std::error_code ignored;
  if (std::filesystem::is_directory(folder, ignored)) return;
  if (std::filesystem::exists(folder, ignored)) {  // often the program itself
    fail({caller, ": cannot create the folder ", folder.string(),
          ": a file with this name exists; rename it, or choose another folder"});
  }
  fail_with(caller + ": cannot create the folder", folder, reason, "choose a writable folder");
}

/// All bytes of a file or pipe. Throws silt::Error, with a message that begins with `caller`, if it
/// cannot be read, or is a device.
inline std::string read(const std::string& caller, const std::filesystem::path& path) {
  const std::string advice = "check the path";
  std::error_code ignored;
  const auto type = std::filesystem::status(path, ignored).type();
  // It may have no end, as /dev/zero.
  if (type == std::filesystem::file_type::character || type == std::filesystem::file_type::block) {
    fail({caller, ": cannot read ", path.string(), ", which is a device; give a file or pipe"});
  }
  errno = 0;
  const Stream stream(std::fopen(path.string().c_str(), "rb"));
  if (!stream) fail_with(caller + ": cannot open", path, last_error(), advice);
  std::string bytes;
  // Otherwise the string would have up to three times the size of the file.
  const auto size = std::filesystem::file_size(path, ignored);
  if (!ignored) bytes.reserve(static_cast<std::size_t>(size));
  char block[1 << 14];
  while (const std::size_t count = std::fread(block, 1, sizeof block, stream.get())) {
    bytes.append(block, count);
  }
  // On some systems, fopen succeeds for a folder.
  if (std::ferror(stream.get()) != 0) {
    fail_with(caller + ": cannot read", path, last_error(), advice);
  }
  return bytes;
}

/// The shortest digits that read back as the same number.
template <class Number>
[[gnu::cold]] std::string digits(Number value) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

/// Converts a text to a number; a leading + is allowed. None if the whole text is not a number.
[[gnu::cold]] inline std::optional<double> number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
#if defined(__cpp_lib_to_chars)
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc{} || read.ptr != end) return std::nullopt;
  return value;
#else
  return detail::number_by_strtod(text);
#endif
}

}  // namespace silt::file
