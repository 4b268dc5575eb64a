#pragma once
// Finished clusters on disk, by content: what was stopped goes on there.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/techniques/srp/cluster_transport.h"

namespace hl {

/// Of all files together.
inline constexpr uint64_t kMostStoredBytes = uint64_t{4} << 30;

class TransportStore {
 public:
  /// The file in cacheFolder() that belongs to `key`. Nothing is read or written yet.
  /// Files that were not used for longest are removed where all of them together are above kMostStoredBytes.
  explicit TransportStore(const std::string& key);

  ~TransportStore();
  TransportStore(const TransportStore&) = delete;
  TransportStore& operator=(const TransportStore&) = delete;

  /// The clusters from the first on that are whole, at most `clusters`; a file that was cut off or damaged counts up to there, and what follows is taken off it. A
  /// file of another version counts as empty. One that another process is writing is read and left alone, by append() too.
  std::vector<ClusterTransport> read(size_t clusters);
  /// How many read() would find, by what stands before each cluster alone: of damage inside one it knows nothing.
  size_t count(size_t clusters) const;
  /// Adds the one with this number. @throws Error(Run) with the system's reason
  void append(size_t number, const ClusterTransport&);
  const std::filesystem::path& file() const { return file_; }

 private:
  bool lock();

  std::filesystem::path file_;
  std::string key_;
  int descriptor_ = -1;     ///< of the file, locked against other writers
  bool refused_ = false;    ///< another has it
};

}  // namespace hl
