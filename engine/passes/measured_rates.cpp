#include "engine/passes/measured_rates.h"

#include <algorithm>
#include <vector>

#include "engine/core/error.h"

namespace hl {
namespace {

constexpr int kRuns = 9;           // after warming up
constexpr double kWarmUpMs = 300;  // of work on a GPU
constexpr int kMostWarmUps = 3000; // where a device's clock says 0, too
constexpr uint64_t kLeastCopy = 64ull << 20;

/// Bytes copied at once: more than caches hold, no more than a buffer may have.
uint64_t copyBytes(const Device& device) { return std::min<uint64_t>(device.isCpu() ? 64ull << 20 : 1ull << 30, device.maxStorageBufferBytes() / 16 * 16); }

double passMs(const BatchTimings& timings) {
  double ms = 0;
  for (const PassTiming& p : timings.passes) ms += p.ms;
  return ms;
}

/// Runs `once` (which returns its milliseconds) until it is warm. Then the median of kRuns.
template <class Once>
double medianMs(const Device& device, Progress& progress, const Once& once) {
  double warm = 0;
  for (int run = 0; run == 0 || (!device.isCpu() && warm < kWarmUpMs && run < kMostWarmUps); ++run) {
    progress.check();
    warm += once();
  }
  std::vector<double> ms;
  for (int run = 0; run < kRuns; ++run) {
    progress.check();
    ms.push_back(once());
  }
  std::sort(ms.begin(), ms.end());
  return ms[ms.size() / 2];
}

}  // namespace

double copyRate(Device& device, ShaderLibrary& shaders, Progress& progress) {
  FrameGraph graph(device, shaders);
  uint64_t bytes = copyBytes(device);
  Buffer from, to;
  try {
    from = device.buffer("copy rate: from", bytes), to = device.buffer("copy rate: to", bytes);
  } catch (const Error&) {
    // Little memory is left beside a scene: less of it then.
    if (bytes <= kLeastCopy) throw;
    from = {}, to = {};
    bytes = kLeastCopy;
    from = device.buffer("copy rate: from", bytes), to = device.buffer("copy rate: to", bytes);
  }
  graph.clear("copy rate: clear", from);
  graph.execute();
  const auto words = static_cast<uint32_t>(bytes / 16);
  const double ms = medianMs(device, progress, [&] {
    graph.compute("copy rate: copy", "passes/copy.comp").bind("from", from, Access::Read).bind("to", to, Access::Write).push(words).dispatchThreads(words);
    return passMs(graph.execute());
  });
  return ms > 0 ? static_cast<double>(bytes) / (ms * 1e6) : 0;
}

double traceRate(const Device& device, FrameGraph& graph, Tracer& tracer, const Buffer& rays, const Buffer& out, uint32_t count, Query query, Progress& progress) {
  return count / (1e3 * medianMs(device, progress, [&] {
    tracer.record(graph, "trace rate: rays", rays, out, count, query);
    return passMs(graph.execute());
  }));
}

}  // namespace hl
