#include "engine/core/cache_room.h"

#include <algorithm>
#include <vector>

namespace hl {
void makeRoom(const std::filesystem::path& keep, uint64_t mostBytes) {
  namespace fs = std::filesystem;
  struct Entry {
    fs::path path;
    uint64_t bytes;
    fs::file_time_type time;
  };
  std::vector<Entry> entries;
  uint64_t total = 0;
  std::error_code ec;
  for (const auto& e : fs::directory_iterator(keep.parent_path(), ec)) {
    if (!e.is_regular_file(ec)) continue;
    const uint64_t bytes = e.file_size(ec);
    if (ec) continue;
    total += bytes;
    if (e.path() != keep && e.path().extension() == keep.extension())
      entries.push_back({e.path(), bytes, e.last_write_time(ec)});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.time < b.time; });
  for (const Entry& e : entries) {
    if (total <= mostBytes) return;
    if (fs::remove(e.path, ec)) total -= e.bytes;
  }
}

}  // namespace hl
