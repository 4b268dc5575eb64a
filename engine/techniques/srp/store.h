#pragma once
// Finished clusters on disk, by content: what was stopped goes on there.
#include <filesystem>
#include <string>
#include <vector>

#include "engine/techniques/srp/cluster_transport.h"

namespace hl {

class TransportStore {
 public:
  /// The file in cacheFolder() that belongs to `key`. Nothing is read or written yet.
  explicit TransportStore(const std::string& key);

  /// The clusters from the first on that are whole, at most `clusters`; a file that was cut off or damaged counts up to there, and what follows is taken off it. A
  /// file of another version counts as empty.
  std::vector<ClusterTransport> read(size_t clusters);
  /// Adds the next one. @throws Error(Run) with the system's reason
  void append(const ClusterTransport&);
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::string key_;
};

}  // namespace hl
