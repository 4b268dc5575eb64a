#include "engine/core/archive.h"

#include <fmt/format.h>
#include <zstd.h>

#include <cstring>
#include <utility>

#include "engine/core/byte_stream.h"
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"

namespace hl {
namespace {

constexpr size_t kHashDigits = 32;
constexpr uint64_t kMostPartBytes = uint64_t{8} << 30;  // a part that says more is taken for damage before memory is asked for

std::string firstLine(ArchiveKind kind) { return fmt::format("halflight {}\n", kind.name); }

std::string compressed(std::string_view bytes, int level) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), level);
  if (ZSTD_isError(size)) throw Error(ErrorKind::Run, fmt::format("compression failed: {}", ZSTD_getErrorName(size)));
  out.resize(size);
  return out;
}

struct Head {
  uint32_t version = 0;
  uint64_t tableBytes = 0;
};

/// First line, version, length of the table; then the table's hash and the table.
bool readHead(std::string_view content, ArchiveKind kind, Head& head) {
  const std::string line = firstLine(kind);
  if (!content.starts_with(line) || content.size() < line.size() + sizeof head.version + sizeof head.tableBytes) return false;
  std::memcpy(&head.version, content.data() + line.size(), sizeof head.version);
  std::memcpy(&head.tableBytes, content.data() + line.size() + sizeof head.version, sizeof head.tableBytes);
  return true;
}

}  // namespace

void ArchiveWriter::add(const std::string& part, std::string_view bytes) {
  if (parts_.contains(part)) throw Error(ErrorKind::Run, fmt::format("the part {} is there already", part));
  parts_[part] = {compressed(bytes, level_), hashOf(bytes), bytes.size()};
}

void ArchiveWriter::write(const std::filesystem::path& file) const {
  ByteWriter table;
  table.value<uint64_t>(parts_.size());
  uint64_t offset = 0;
  for (const auto& [name, part] : parts_) {
    table.text(name), table.text(part.hash);
    table.value(offset), table.value<uint64_t>(part.stored.size()), table.value(part.bytes);
    offset += part.stored.size();
  }
  std::string bytes = firstLine(kind_);
  ByteWriter head;
  head.value(kind_.version), head.value<uint64_t>(table.bytes().size());
  bytes += head.bytes();
  bytes += hashOf(table.bytes());
  bytes += table.bytes();
  for (const auto& [name, part] : parts_) bytes += part.stored;
  writeFileAtomically(file, bytes);
}

Archive::Archive(const std::filesystem::path& file, ArchiveKind kind) : file_(file) {
  using Reason = ArchiveError::Reason;
  try {
    content_ = readFile(file);
  } catch (const Error& e) {
    throw ArchiveError(Reason::Unreadable, e.what());
  }
  const auto damaged = [&] { return ArchiveError(Reason::Damaged, fmt::format("{}: cut off or damaged; make it again", file.string())); };
  Head head;
  if (!readHead(content_, kind, head)) {
    if (content_.starts_with(firstLine(kind))) throw damaged();
    throw ArchiveError(Reason::Foreign, fmt::format("{}: not a {} of Halflight's", file.string(), kind.name));
  }
  if (head.version != kind.version)
    throw ArchiveError(Reason::OtherVersion, fmt::format("{}: a {} of version {}; this program reads version {}: make it again with this one",
                                                         file.string(), kind.name, head.version, kind.version));
  std::string_view rest = std::string_view(content_).substr(firstLine(kind).size() + sizeof head.version + sizeof head.tableBytes);
  if (rest.size() < kHashDigits || rest.size() - kHashDigits < head.tableBytes) throw damaged();
  const std::string_view hash = rest.substr(0, kHashDigits), table = rest.substr(kHashDigits, head.tableBytes);
  if (hashOf(table) != hash) throw damaged();
  const uint64_t base = content_.size() - rest.size() + kHashDigits + head.tableBytes;
  uint64_t end = base;
  try {
    ByteReader r(table);
    for (size_t n = r.count(1); n > 0; --n) {
      const std::string name = r.text();
      Part part;
      part.hash = r.text();
      part.offset = base + r.value<uint64_t>(), part.storedBytes = r.value<uint64_t>(), part.bytes = r.value<uint64_t>();
      if (part.offset != end || part.storedBytes > content_.size() - end || part.bytes > kMostPartBytes) throw damaged();
      end += part.storedBytes;
      parts_[name] = std::move(part);
    }
    if (!r.atEnd()) throw damaged();
  } catch (const std::out_of_range&) {
    throw damaged();
  }
  if (end != content_.size()) throw damaged();
}

std::vector<std::string> Archive::parts() const {
  std::vector<std::string> names;
  for (const auto& [name, part] : parts_) names.push_back(name);
  return names;
}

std::string Archive::read(const std::string& name) const {
  const auto found = parts_.find(name);
  if (found == parts_.end()) throw ArchiveError(ArchiveError::Reason::Damaged, fmt::format("{}: it has no part {}", file_.string(), name));
  const Part& part = found->second;
  const auto damaged = [&] {
    return ArchiveError(ArchiveError::Reason::Damaged,
                        fmt::format("{}: damaged: its part {} does not match its checksum; make it again", file_.string(), name));
  };
  const char* stored = content_.data() + part.offset;
  if (ZSTD_getFrameContentSize(stored, part.storedBytes) != part.bytes) throw damaged();
  std::string bytes(part.bytes, '\0');
  if (ZSTD_decompress(bytes.data(), bytes.size(), stored, part.storedBytes) != part.bytes || hashOf(bytes) != part.hash) throw damaged();
  return bytes;
}

}  // namespace hl
