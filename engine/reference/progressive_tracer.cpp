#include "engine/reference/progressive_tracer.h"

#include <fmt/format.h>

#include <chrono>

#include "engine/core/error.h"
#include "engine/reference/path_tracer.h"

namespace hl {
namespace {

constexpr size_t kGrain = 256;        // pixels a task
constexpr size_t kCancelInterval = 32;  // ... between two looks at whether to stop

}  // namespace

struct ProgressiveTracer::Impl {
  std::shared_ptr<const EmbreeScene> embree;
  std::vector<Receiver> receivers;
  int width, height;
  TaskPool& pool;
  PathTracer tracer;
  uint64_t seed;
  uint32_t passes = 0;
  double ms = 0;
  std::vector<vec3> sum, next;  ///< by receiver: of the whole passes, and of the one that runs

  Impl(std::shared_ptr<const EmbreeScene> scene, std::vector<Receiver> at, int w, int h, const ReferenceSettings& s, TaskPool& tasks)
      : embree(std::move(scene)), receivers(std::move(at)), width(w), height(h), pool(tasks), tracer(*embree, s), seed(s.seed),
        sum(receivers.size(), vec3(0.0f)), next(receivers.size()) {
    if (w <= 0 || h <= 0 || receivers.size() != static_cast<size_t>(w) * static_cast<size_t>(h))
      throw badInput(fmt::format("path tracer: {} receivers are not {} x {}", receivers.size(), w, h));
  }

  void trace(size_t i) {
    next[i] = sum[i];
    if (!tracer.receives(receivers[i])) return;
    PathCounters counters;
    PathSampler sampler(seed, 0, static_cast<uint32_t>(i));
    sampler.begin(passes);
    BounceSample sample;
    sample.fill(vec3(0.0f));
    tracer.indirect(tracer.shadingPoint(receivers[i]), sampler, sample, counters);
    for (const vec3& bounce : sample) next[i] += bounce;
  }
};

ProgressiveTracer::ProgressiveTracer(std::shared_ptr<const EmbreeScene> scene, std::vector<Receiver> receivers, int width, int height,
                                     const ReferenceSettings& settings, TaskPool& pool)
    : impl_(std::make_unique<Impl>(std::move(scene), std::move(receivers), width, height, settings, pool)) {}

ProgressiveTracer::~ProgressiveTracer() = default;

void ProgressiveTracer::advance(Progress& progress) {
  Impl& im = *impl_;
  const auto began = std::chrono::steady_clock::now();
  im.pool.parallelFor(im.receivers.size(), kGrain, [&](size_t first, size_t last, unsigned) {
    for (size_t i = first; i < last; ++i) {
      if (i % kCancelInterval == 0) progress.check();
      im.trace(i);
    }
  });
  im.sum.swap(im.next);
  ++im.passes;
  im.ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
}

uint32_t ProgressiveTracer::passes() const { return impl_->passes; }
double ProgressiveTracer::ms() const { return impl_->ms; }

Image ProgressiveTracer::image() const {
  const Impl& im = *impl_;
  Image out(im.width, im.height, 3);
  if (im.passes == 0) return out;
  for (size_t i = 0; i < im.sum.size(); ++i)
    for (int c = 0; c < 3; ++c) out.data[i * 3 + static_cast<size_t>(c)] = im.sum[i][c] / static_cast<float>(im.passes);
  return out;
}

}  // namespace hl
