// SPDX-License-Identifier: MIT
// Files written atomically: at any time, and after a failure, the file under this name is the whole
// old one or the whole new one, however many processes write it.
#pragma once

#include <silt/core/error.hpp>
#include <silt/io/file.hpp>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#if defined(__unix__) || defined(__APPLE__)
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>
#define SILT_HAS_POSIX_FILES 1
#else
#include <chrono>
#endif

namespace silt::file {

#if defined(SILT_HAS_POSIX_FILES)
/// The system's calls. All set errno when they fail; tests pass others, which do.
struct SystemCalls {
  /// Handle of an open file.
  using File = int;
  /// Handle that stands for no file.
  static constexpr File none = -1;

  /// `none` if there is such a file already.
  static File create(const char* path) {
    return ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  }
  /// For sync(), which a rename needs.
  static File open_folder(const char* path) {
    return ::open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  }
  /// The number of bytes written, which may be less than the size; negative if it fails.
  static std::ptrdiff_t write(File file, const char* bytes, std::size_t size) {
    return ::write(file, bytes, size);
  }
  /// Returns when the data are on the disc; like the others, 0 unless it fails.
  static int sync(File file) { return ::fsync(file); }
  /// Returns 0 unless it fails.
  static int close(File file) { return ::close(file); }
  /// Returns 0 unless it fails; replaces a file `to`.
  static int rename(const char* from, const char* to) { return std::rename(from, to); }
  /// Returns 0 unless it fails.
  static int remove(const char* path) { return ::unlink(path); }
  /// Number of this process.
  static std::uint64_t process() { return static_cast<std::uint64_t>(::getpid()); }
  /// Whether no process of this computer has the number any more.
  static bool has_ended(std::uint64_t process) {
    return ::kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH;
  }
  /// Name of this computer.
  static std::string computer() {
    std::array<char, 256> name{};
    ::gethostname(name.data(), name.size() - 1);
    return name.data();
  }
};
#else
/// The same with what the C++ library has.
struct SystemCalls {
  using File = std::FILE*;
  static constexpr File none = nullptr;

  static File create(const char* path) { return std::fopen(path, "wbx"); }
  static std::ptrdiff_t write(File file, const char* bytes, std::size_t size) {
    const std::size_t written = std::fwrite(bytes, 1, size, file);
    return written > 0 ? static_cast<std::ptrdiff_t>(written) : -1;
  }
  static int sync(File file) { return std::fflush(file); }
  static int close(File file) { return std::fclose(file); }
  static int rename(const char* from, const char* to) {
    std::error_code reason;
    std::filesystem::rename(from, to, reason);
    errno = reason.value();
    return reason ? -1 : 0;
  }
  static int remove(const char* path) { return std::remove(path); }
  static std::uint64_t process() {
    return static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
  }
  static bool has_ended(std::uint64_t) { return false; }
  static std::string computer() { return {}; }
};
#endif

namespace detail {

/// The file to which a symbolic link leads, which need not exist; other paths are returned as they
/// are. Throws if links lead to each other, or if the path is a folder, device or pipe.
[[gnu::cold]] inline std::filesystem::path target_of(const std::string& caller, std::filesystem::path path) {
  const std::filesystem::path given = path;
  for (int links = 0; links < 40; ++links) {  // as Linux does
    std::error_code reason;
    const auto status = std::filesystem::symlink_status(path, reason);
    if (status.type() != std::filesystem::file_type::symlink) {
      // A rename would replace even a device.
      if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) return path;
      fail({caller, ": cannot replace ", path.string(), ": it is not a file; choose another name"});
    }
    const auto target = std::filesystem::read_symlink(path, reason);
    if (reason) fail_with(caller + ": cannot read the link", path, reason, "check the path");
    path = path.parent_path() / target;  // the target, if that is absolute
  }
  fail_with(caller + ": cannot open", given,
            std::make_error_code(std::errc::too_many_symbolic_link_levels),
            "remove the links that lead to each other");
}

/// Whether fsync of a folder failed because the file system cannot, and need not, do this; such
/// file systems give different reasons.
inline bool cannot_sync_folders(int reason) {
  return reason == EINVAL || reason == ENOTSUP || reason == EOPNOTSUPP || reason == ENOSYS ||
         reason == EBADF;
}

/// The beginning of the names of the files with which processes of this computer replace a file; a
/// process, a number and .part follow.
template <class Calls>
[[gnu::cold]] std::filesystem::path part_prefix(std::filesystem::path path) {
  // In pieces: g++ 12 warns of the sum of these strings without reason.
  path += '.';
  path += Calls::computer();
  path += '.';
  return path;
}

/// Removes what processes of this computer that were killed while they replaced this file have
/// left. Those of other computers may still run.
template <class Calls>
[[gnu::cold]] void remove_parts_of_ended_processes(const std::filesystem::path& path) {
  const std::string prefix = part_prefix<Calls>(path).filename().string();
  std::error_code ignored;
  std::filesystem::directory_iterator files(
      path.has_parent_path() ? path.parent_path() : std::filesystem::path("."), ignored);
  for (; !ignored && files != end(files); files.increment(ignored)) {
    const std::string name = files->path().filename().string();
    if (!name.starts_with(prefix) || !name.ends_with(".part")) continue;
    const char* const begin = name.data() + prefix.size();
    std::uint64_t process = 0;
    const auto [end, reason] = std::from_chars(begin, name.data() + name.size(), process);
    if (reason != std::errc{} || *end != '-' || process == 0) continue;
    if (Calls::has_ended(process)) Calls::remove(files->path().string().c_str());
  }
}

/// A new file, removed unless it was renamed.
template <class Calls>
class PartOfReplacement {
 public:
  [[gnu::cold]] PartOfReplacement(std::string caller, std::filesystem::path path)
      : caller_(std::move(caller)), path_(std::move(path)) {
    static std::atomic<std::uint64_t> calls{0};
    do {
      part_ = part_prefix<Calls>(path_);
      part_ += std::to_string(Calls::process());
      part_ += '-';
      part_ += std::to_string(++calls);
      part_ += ".part";
      errno = 0;
      file_ = Calls::create(part_.string().c_str());
      // Left by a process that was killed and had the same number.
    } while (file_ == Calls::none && errno == EEXIST);
    if (file_ == Calls::none) fail_to("create", part_);
  }
  PartOfReplacement(const PartOfReplacement&) = delete;
  PartOfReplacement& operator=(const PartOfReplacement&) = delete;
  [[gnu::cold]] ~PartOfReplacement() {
    if (file_ != Calls::none) Calls::close(file_);
    if (!is_renamed_) Calls::remove(part_.string().c_str());
  }

  [[gnu::cold]] void write(std::string_view bytes) {
    while (!bytes.empty()) {
      errno = 0;
      const std::ptrdiff_t written = Calls::write(file_, bytes.data(), bytes.size());
      if (written > 0) {
        bytes.remove_prefix(static_cast<std::size_t>(written));
      } else if (errno != EINTR) {
        fail_to("write", part_);
      }
    }
  }
  void sync() { require(Calls::sync(file_), "write"); }
  void close() {
    const auto file = std::exchange(file_, Calls::none);
    require(Calls::close(file), "write");  // a full disc may be reported only here
  }
  [[gnu::cold]] void rename() {
    require(Calls::rename(part_.string().c_str(), path_.string().c_str()), "replace");
    is_renamed_ = true;
  }

  [[noreturn, gnu::cold]] void fail_to(const std::string& action, const std::filesystem::path& path) const {
    fail_with(caller_ + ": cannot " + action, path, last_error(),
              "check that the folder exists, is writable and has space left");
  }

 private:
  void require(int answer, const std::string& action) const {
    if (answer != 0) fail_to(action, path_);
  }

  std::string caller_;
  std::filesystem::path path_;
  std::filesystem::path part_;
  typename Calls::File file_ = Calls::none;
  bool is_renamed_ = false;
};

}  // namespace detail

/// What a new file must outlast.
enum class Outlasts {
  the_process,   ///< also one that is killed
  power_failure  ///< waits until the file is on the disc
};

/// Replaces the contents of a file, or of the file to which a symbolic link leads: writes another
/// file next to it, whose name ends in .part, and renames that; removes those left by processes
/// that were killed. Throws silt::Error, with a message that begins with `caller`, if that fails;
/// an existing file is then unchanged, and no other file remains.
template <class Calls = SystemCalls>
[[gnu::cold]] void replace(const std::string& caller, const std::filesystem::path& path, std::string_view bytes,
             Outlasts outlasts = Outlasts::the_process) {
  const std::filesystem::path target = detail::target_of(caller, path);
  detail::remove_parts_of_ended_processes<Calls>(target);
  detail::PartOfReplacement<Calls> part(caller, target);
  part.write(bytes);
  if (outlasts == Outlasts::the_process) {
    part.close();
    part.rename();
    return;
  }
  part.sync();
  part.close();
  if constexpr (requires { Calls::open_folder(""); }) {
    // Opened before, so that this cannot fail when the file is already replaced.
    const auto folder =
        target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
    struct Folder {
      typename Calls::File file;
      ~Folder() {
        if (file != Calls::none) Calls::close(file);
      }
    } const opened{Calls::open_folder(folder.string().c_str())};
    // A folder may be writable without being readable.
    if (opened.file == Calls::none && errno != EACCES) part.fail_to("open", folder);
    part.rename();
    if (opened.file == Calls::none) return;
    if (Calls::sync(opened.file) != 0 && !detail::cannot_sync_folders(errno)) {
      fail_with(caller + ": replaced, but cannot make permanent,", target, last_error(),
                "a power failure may bring back the old file; write it again");
    }
  } else {
    part.rename();
  }
}

}  // namespace silt::file
