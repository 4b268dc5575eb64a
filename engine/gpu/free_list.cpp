#include "engine/gpu/free_list.h"

#include <cassert>
#include <iterator>

namespace hl {

std::optional<uint64_t> FreeList::allocate(uint64_t bytes, uint64_t alignment) {
  assert(bytes > 0 && alignment > 0 && (alignment & (alignment - 1)) == 0);
  for (auto it = free_.begin(); it != free_.end(); ++it) {
    const auto [begin, length] = *it;
    const uint64_t aligned = (begin + alignment - 1) & ~(alignment - 1);
    const uint64_t skipped = aligned - begin;
    if (skipped > length || length - skipped < bytes) continue;
    const uint64_t left = length - skipped - bytes;
    free_.erase(it);
    if (skipped > 0) free_.emplace(begin, skipped);
    if (left > 0) free_.emplace(aligned + bytes, left);
    return aligned;
  }
  return std::nullopt;
}

void FreeList::release(uint64_t offset, uint64_t bytes) {
  assert(offset + bytes <= size_);
  auto next = free_.lower_bound(offset);
  assert(next == free_.end() || offset + bytes <= next->first);
  if (next != free_.end() && offset + bytes == next->first) {
    bytes += next->second;
    next = free_.erase(next);
  }
  if (next != free_.begin()) {
    const auto previous = std::prev(next);
    assert(previous->first + previous->second <= offset);
    if (previous->first + previous->second == offset) {
      previous->second += bytes;
      return;
    }
  }
  free_.emplace(offset, bytes);
}

uint64_t FreeList::freeBytes() const {
  uint64_t sum = 0;
  for (const auto& [offset, length] : free_) sum += length;
  return sum;
}

}  // namespace hl
