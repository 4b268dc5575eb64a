#include "engine/techniques/surfels/prefix_sum.h"

#include "engine/core/error.h"

namespace hl {

PrefixSum::PrefixSum(Device& device, uint32_t most) : most_(most) {
  if (most > kMost) throw Error(ErrorKind::TooLarge, "prefix sum: " + std::to_string(most) + " values, at most " + std::to_string(kMost) + " are summed at once");
  totals_ = device.buffer("surfels: chunk totals", ((most + kChunk - 1) / kChunk) * sizeof(uint32_t));
}

void PrefixSum::record(FrameGraph& graph, const std::string& name, const Buffer& values, const Buffer& sums, uint32_t count) const {
  if (count > most_ || values.size() < count * sizeof(uint32_t) || sums.size() < (count + 1) * sizeof(uint32_t))
    throw badInput(name + ": " + std::to_string(count) + " values do not fit the buffers");
  const uint32_t chunks = (count + kChunk - 1) / kChunk;
  graph.compute(name + ": chunks", "surfels/prefix_chunks.comp")
      .bind("values", values, Access::Read)
      .bind("sums", sums, Access::Write)
      .bind("totals", totals_, Access::Write)
      .push(count)
      .dispatch(chunks);
  // Every group adds up the chunks before its own: dearer than sums of the totals would be, and a pass fewer.
  graph.compute(name + ": offsets", "surfels/prefix_offsets.comp")
      .bind("totals", totals_, Access::Read)
      .bind("sums", sums, Access::ReadWrite)
      .push(count)
      .dispatch(chunks);
}

}  // namespace hl
