#pragma once
// One file of named parts, each compressed (Zstandard) and checked: bundles, and the cache of imports.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/error.h"

namespace hl {

/// What a file of ours is. A file of another kind or version is refused before anything in it is read.
struct ArchiveKind {
  std::string_view name;   ///< "bundle": the first line is "halflight bundle"
  uint32_t version = 1;
};

class ArchiveWriter {
 public:
  /// `level` of Zstandard: 1 for caches, 12 for what travels.
  ArchiveWriter(ArchiveKind kind, int level) : kind_(kind), level_(level) {}
  /// @throws Error(Run) where the part's name is taken.
  void add(const std::string& part, std::string_view bytes);
  /// Atomically. @throws Error(Run) where the file cannot be written.
  void write(const std::filesystem::path&) const;

 private:
  struct Part {
    std::string stored, hash;
    uint64_t bytes = 0;
  };
  ArchiveKind kind_;
  int level_;
  std::map<std::string, Part> parts_;
};

/// Why a file could not be opened, or a part not be read.
class ArchiveError : public Error {
 public:
  enum class Reason { Unreadable, Foreign, OtherVersion, Damaged };
  ArchiveError(Reason reason, const std::string& message) : Error(ErrorKind::BadInput, message), reason_(reason) {}
  Reason reason() const { return reason_; }

 private:
  Reason reason_;
};

class Archive {
 public:
  /// @throws ArchiveError: the file, and whether it cannot be read, is foreign, of another version, or damaged (a cut-off one too).
  Archive(const std::filesystem::path&, ArchiveKind);

  bool has(const std::string& part) const { return parts_.contains(part); }
  std::vector<std::string> parts() const;
  uint64_t storedBytes(const std::string& part) const { return parts_.at(part).storedBytes; }
  /// Decompressed and checked. @throws ArchiveError where it is missing or damaged.
  std::string read(const std::string& part) const;
  const std::filesystem::path& file() const { return file_; }

 private:
  struct Part {
    uint64_t offset = 0, storedBytes = 0, bytes = 0;
    std::string hash;
  };
  std::filesystem::path file_;
  std::string content_;
  std::map<std::string, Part> parts_;
};

}  // namespace hl
