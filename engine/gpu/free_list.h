#pragma once
// Where things lie in one block of memory: offsets only, no Vulkan, so that it can be tested by itself.
#include <cstdint>
#include <map>
#include <optional>

namespace hl {

/// First fit over the free ranges of a block; neighbours that come free grow together.
class FreeList {
 public:
  explicit FreeList(uint64_t size) : size_(size), free_{{0, size}} {}
  /// Offset of `bytes` (> 0) aligned to `alignment` (a power of two), or nothing where no range is large enough.
  std::optional<uint64_t> allocate(uint64_t bytes, uint64_t alignment);
  /// `offset` and `bytes` as allocated.
  void release(uint64_t offset, uint64_t bytes);
  uint64_t freeBytes() const;
  bool empty() const { return freeBytes() == size_; }
  size_t ranges() const { return free_.size(); }

 private:
  uint64_t size_;
  std::map<uint64_t, uint64_t> free_;  ///< offset to length, never touching
};

}  // namespace hl
