#include "engine/core/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "engine/core/error.h"

namespace hl {

namespace fs = std::filesystem;

namespace {

/// A descriptor that is closed on every way out.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  explicit operator bool() const { return fd_ >= 0; }
  int get() const { return fd_; }

 private:
  int fd_;
};

std::string systemReason() { return std::generic_category().message(errno); }

Error cannotWrite(const fs::path& file) {
  return Error(ErrorKind::Run, fmt::format("{}: cannot be written: {}", file.string(), systemReason()));
}

fs::path fromEnvironment(const char* name) {
  const char* value = std::getenv(name);
  return value ? fs::path(value) : fs::path();
}

}  // namespace

fs::path programFolder() {
  std::error_code ignored;
  const fs::path executable = fs::read_symlink("/proc/self/exe", ignored);
  return executable.empty() ? fs::current_path() : executable.parent_path();
}

std::string readFile(const fs::path& file) {
  const Descriptor in(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  std::string bytes;
  if (!in) throw badInput(fmt::format("{}: cannot be read: {}", file.string(), systemReason()));
  std::error_code noSize;
  const auto expected = fs::file_size(file, noSize);
  if (!noSize) bytes.reserve(expected);
  char piece[1 << 16];
  while (true) {
    const ssize_t got = ::read(in.get(), piece, sizeof piece);
    if (got == 0) return bytes;
    if (got > 0) bytes.append(piece, static_cast<size_t>(got));
    if (got < 0 && errno != EINTR) throw badInput(fmt::format("{}: cannot be read: {}", file.string(), systemReason()));
  }
}

fs::path temporaryBeside(const fs::path& file) {
  static std::atomic<unsigned> serial{0};
  return file.parent_path() /
         fmt::format(".{}.{}-{}{}", file.stem().string(), ::getpid(), serial++, file.extension().string());
}

void moveIntoPlace(const fs::path& temporary, const fs::path& file) {
  const auto failed = [&] {
    const Error error = cannotWrite(file);
    ::unlink(temporary.c_str());
    return error;
  };
  {
    // The contents must be on disk before the name points at them.
    const Descriptor written(::open(temporary.c_str(), O_RDONLY | O_CLOEXEC));
    if (!written || ::fsync(written.get()) != 0) throw failed();
  }
  if (::rename(temporary.c_str(), file.c_str()) != 0) throw failed();
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const Descriptor entry(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // The file is whole either way: some file systems cannot sync a folder.
  if (entry) ::fsync(entry.get());
}

void writeFileAtomically(const fs::path& file, std::string_view bytes) {
  const fs::path temporary = temporaryBeside(file);
  {
    const Descriptor out(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (!out) throw cannotWrite(file);
    while (!bytes.empty()) {
      const ssize_t put = ::write(out.get(), bytes.data(), bytes.size());
      if (put >= 0) {
        bytes.remove_prefix(static_cast<size_t>(put));
      } else if (errno != EINTR) {
        const Error error = cannotWrite(file);
        ::unlink(temporary.c_str());
        throw error;
      }
    }
  }
  moveIntoPlace(temporary, file);
}

fs::path homeFolder() {
  if (const fs::path given = fromEnvironment("HALFLIGHT_HOME"); !given.empty()) return given;
  const fs::path source(HALFLIGHT_SOURCE_DIR);
  std::error_code ignored;
  return fs::is_directory(source / "shaders", ignored) ? source : programFolder();
}

fs::path shaderFolder() {
  if (const fs::path given = fromEnvironment("HALFLIGHT_SHADERS"); !given.empty()) return given;
  const fs::path built(HALFLIGHT_SHADER_DIR);
  std::error_code ignored;
  return fs::is_directory(built, ignored) ? built : programFolder() / "shaders";
}

fs::path cacheFolder() {
  fs::path folder = fromEnvironment("HALFLIGHT_CACHE");
  if (folder.empty()) {
    fs::path base = fromEnvironment("XDG_CACHE_HOME");
    // The XDG specification says that a relative path there is to be ignored.
    if (base.empty() || base.is_relative()) {
      const fs::path user = fromEnvironment("HOME");
      base = user.empty() ? fs::temp_directory_path() : user / ".cache";
    }
    folder = base / "halflight";
  }
  std::error_code reason;
  fs::create_directories(folder, reason);
  if (reason)
    throw Error(ErrorKind::Run, fmt::format("{}: the cache folder cannot be made: {}; HALFLIGHT_CACHE names another",
                                            folder.string(), reason.message()));
  return folder;
}

std::vector<fs::path> scenePath(const fs::path& beside) {
  std::vector<fs::path> folders;
  if (!beside.empty()) folders.push_back(beside);
  const std::string list = fromEnvironment("HALFLIGHT_SCENES").string();
  for (size_t begin = 0; begin <= list.size();) {
    const size_t end = std::min(list.find(':', begin), list.size());
    if (end > begin) folders.emplace_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  folders.push_back(homeFolder() / "scenes");
  return folders;
}

}  // namespace hl
