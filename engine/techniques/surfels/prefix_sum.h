#pragma once
// Exclusive prefix sums of unsigned integers on the device, the same on every device and in every run.
#include <string>
#include <utility>
#include <vector>

#include "engine/gpu/frame_graph.h"

namespace hl {

class PrefixSum {
 public:
  /// Up to `most` values at once. @throws Error(TooLarge) beyond kMost
  PrefixSum(Device&, uint32_t most);
  static constexpr uint32_t kChunk = 1024;        ///< values a work group
  static constexpr uint32_t kMost = 1u << 24;

  /// sums[i] = values[0] + ... + values[i - 1] for i in [0, count]: `sums` holds count + 1. Passes "<name>: chunks", "<name>: offsets".
  void record(FrameGraph&, const std::string& name, const Buffer& values, const Buffer& sums, uint32_t count) const;
  uint64_t bytes() const { return totals_.size(); }

 private:
  Buffer totals_;
  uint32_t most_ = 0;
};

}  // namespace hl
