#include "engine/reference/reference.h"

#include <algorithm>
#include <bit>
#include <mutex>

#include <fmt/format.h>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/reference/path_tracer.h"
#include "engine/reference/reference_state.h"
#include "engine/scene/scene_build.h"

namespace hl {
namespace {

// Changes whenever the same settings would give other numbers: caches of before are then not found.
constexpr uint32_t kReferenceVersion = 2;
constexpr uint32_t kLobeVersion = 2;  // the same, of glossy receivers alone
// Paths in a pass where there are few receivers (else one a half and receiver), and in a unit of `advance`.
constexpr uint32_t kPassPaths = 8192;
constexpr uint32_t kUnitPaths = 2048;
// Light samples count as this share of a path in that.
constexpr uint32_t kDirectSamplesAPath = 8;
// Paths between two looks at whether to stop.
constexpr uint32_t kCancelInterval = 32;
// Streams of random numbers a half: indirect, direct.
constexpr uint32_t kStreams = 2;
// Of the lobes' paths of half 0; after those of indirect and direct light, which scenes without gloss have alone.
constexpr uint32_t kSpecularStream = 2 * kStreams;

// And those of what lobes reflect directly, after these.
constexpr uint32_t kDirectSpecularStream = kSpecularStream + 2;

bool anyGlossy(const std::vector<Receiver>& receivers) {
  return std::any_of(receivers.begin(), receivers.end(), [](const Receiver& r) { return r.glossy(); });
}

std::string keyOf(const Scene& scene, const std::vector<Receiver>& receivers, int width, int height,
                  const ReferenceSettings& s, bool lobes) {
  Hasher h;
  h.value(kReferenceVersion).text(sceneContentHash(scene)).value(width).value(height);
  for (const Receiver& r : receivers) {
    h.value(r.position).value(r.geometricNormal).value(r.mappedNormal);
    h.value<uint8_t>(static_cast<uint8_t>((r.backFace ? 1 : 0) | (r.twoSided ? 2 : 0)));
  }
  h.value(s.maxBounces).value(s.seed).value<uint8_t>(s.frontFacesOnly).value(static_cast<int>(s.receiver));
  h.value(s.directSamples);
  // Without lobes the key is what it was before there were any.
  if (lobes) {
    h.text("lobes").value(kLobeVersion);
    for (const Receiver& r : receivers) h.value(r.view).value(r.specular).value(r.roughness);
  }
  return h.hex();
}

void setPixel(Image& image, size_t pixel, vec3 value) {
  float* p = image.data.data() + 3 * pixel;
  p[0] = value.x, p[1] = value.y, p[2] = value.z;
}

Image meanOf(const Image& a, const Image& b) {
  Image m(a.width, a.height, a.channels);
  for (size_t i = 0; i < m.data.size(); ++i) m.data[i] = 0.5f * (a.data[i] + b.data[i]);
  return m;
}

/// Of the buckets up to `bounces`.
ReferenceImage sumOf(const std::array<Image, kBounceBuckets> (&buckets)[2], int bounces, int width, int height) {
  ReferenceImage r;
  Image* halves[2] = {&r.halfA, &r.halfB};
  // Beyond the buckets of their own there is only "all".
  const int count = bounces >= kBounceBuckets ? kBounceBuckets : std::max(0, bounces);
  for (int half = 0; half < 2; ++half) {
    Image& sum = *halves[half] = Image(width, height, 3);
    // The smallest terms first.
    for (int b = count - 1; b >= 0; --b)
      for (size_t i = 0; i < sum.data.size(); ++i) sum.data[i] += buckets[half][static_cast<size_t>(b)].data[i];
  }
  r.mean = meanOf(r.halfA, r.halfB);
  return r;
}

}  // namespace

ReferenceImage ReferenceResult::directImage() const { return {meanOf(direct[0], direct[1]), direct[0], direct[1]}; }

ReferenceImage ReferenceResult::indirectImage(int bounces) const { return sumOf(indirect, bounces, width, height); }

ReferenceImage ReferenceResult::specularImage(int bounces) const { return sumOf(specular, glossy() ? bounces : 0, width, height); }

ReferenceImage ReferenceResult::directSpecularImage() const {
  if (!glossy()) return {};
  return {meanOf(directSpecular[0], directSpecular[1]), directSpecular[0], directSpecular[1]};
}

struct ReferenceTracer::Impl {
  std::shared_ptr<const EmbreeScene> embree;
  std::vector<Receiver> receivers;
  int width, height;
  TaskPool& pool;
  PathTracer tracer;
  uint64_t seed;
  bool lobes = false;  ///< some receiver's is traced
  ReferenceCount goal;
  uint32_t samplesAPass = 1, unitReceivers = 1;
  std::string key;

  ReferenceState state;
  uint32_t band = 0;  ///< receivers of the pass in progress that earlier units did
  mutable std::mutex resultMutex;
  std::shared_ptr<const ReferenceResult> lastResult;

  Impl(std::shared_ptr<const EmbreeScene> scene, std::vector<Receiver> at, int w, int h, const ReferenceSettings& s,
       TaskPool& tasks)
      : embree(std::move(scene)), receivers(std::move(at)), width(w), height(h), pool(tasks), tracer(*embree, s),
        seed(s.seed) {
    if (w <= 0 || h <= 0 || receivers.size() != static_cast<size_t>(w) * static_cast<size_t>(h))
      throw badInput(fmt::format("reference: {} receivers are not {} x {}", receivers.size(), w, h));
    goal.paths = static_cast<uint32_t>(std::max(2, s.samplesPerPixel) + 1) / 2;
    if (tracer.hasExtendedLight()) goal.direct = static_cast<uint32_t>(std::max(2, s.directSamples) + 1) / 2;
    lobes = s.glossyLastBounce && anyGlossy(receivers);
    const auto count = static_cast<uint32_t>(receivers.size());
    // A power of two, so that the usual sample counts are whole passes, and one serves another from the cache.
    samplesAPass = std::bit_floor(std::max(1u, kPassPaths / (2 * count)));
    unitReceivers = std::max(1u, kUnitPaths / ((lobes ? 4 : 2) * samplesAPass));
    key = keyOf(embree->scene(), receivers, w, h, s, lobes);
    state = ReferenceState({count, static_cast<uint32_t>(std::clamp(s.maxBounces, 0, kBounceBuckets)), lobes});
    planPass();
  }

  bool settled() const { return state.now == goal; }

  /// Direct light keeps pace with the paths, so that an early result has some of both; what is then missing follows.
  void planPass() {
    ReferenceCount next = state.now;
    if (next.paths < goal.paths) {
      next.paths += std::min(samplesAPass, goal.paths - next.paths);
      next.direct = std::min(goal.direct, std::max(next.direct, next.paths));
    } else {
      next.direct = std::min(goal.direct, next.direct + samplesAPass * kDirectSamplesAPath);
    }
    state.next = next;
    std::fill(state.ahead.begin(), state.ahead.end(), uint8_t{0});
    band = 0;
  }

  using BucketSums = std::array<glm::dvec3, kBounceBuckets>;

  /// Adds the samples from state.now to state.next of one half: `path` adds one to what it is given.
  template <class Path>
  void addPaths(BucketSums& sums, uint32_t stream, uint32_t receiver, const Progress& progress, Path&& path) const {
    PathSampler sampler(seed, stream, receiver);
    for (uint32_t s = state.now.paths; s < state.next.paths; ++s) {
      if (s % kCancelInterval == 0) progress.check();
      BounceSample sample;
      sample.fill(vec3(0.0f));
      sampler.begin(s);
      path(sampler, sample);
      for (uint32_t b = 0; b < state.buckets; ++b) sums[b] += glm::dvec3(sample[b]);
    }
  }
  template <class Sample>
  void addDirect(glm::dvec3& sum, uint32_t stream, uint32_t receiver, const Progress& progress, Sample&& sample) const {
    PathSampler sampler(seed, stream, receiver);
    for (uint32_t s = state.now.direct; s < state.next.direct; ++s) {
      if (s % kCancelInterval == 0) progress.check();
      sampler.begin(s);
      sum += glm::dvec3(sample(sampler));
    }
  }
  void keep(std::vector<vec3>& kept, uint32_t receiver, const BucketSums& added) const {
    vec3* sums = kept.data() + static_cast<size_t>(receiver) * state.buckets;
    for (uint32_t b = 0; b < state.buckets; ++b) sums[b] = vec3(glm::dvec3(sums[b]) + added[b]);
  }

  /// Takes receiver `i` from state.now to state.next, or throws and leaves it as it was.
  void traceReceiver(uint32_t i, const Progress& progress, PathCounters& total) {
    PathCounters counters;
    if (tracer.receives(receivers[i])) {
      const ShadingPoint point = tracer.shadingPoint(receivers[i]);
      const bool lobe = lobes && receivers[i].glossy();
      std::array<BucketSums, 2> paths{}, specular{};
      std::array<glm::dvec3, 2> extended{state.extended[0][i], state.extended[1][i]};
      std::array<glm::dvec3, 2> highlights{};
      vec3 punctualHighlight(0.0f);
      if (lobe) {
        highlights = {state.extendedSpecular[0][i], state.extendedSpecular[1][i]};
        punctualHighlight = state.now.paths == 0 ? tracer.punctualSpecular(receivers[i], counters) : state.punctualSpecular[i];
      }
      const vec3 punctual = state.now.paths == 0 ? tracer.punctual(point, counters) : state.punctual[i];
      for (uint32_t half = 0; half < 2; ++half) {
        addPaths(paths[half], kStreams * half, i, progress, [&](PathSampler& sampler, BounceSample& sample) { tracer.indirect(point, sampler, sample, counters); });
        if (lobe)
          addPaths(specular[half], kSpecularStream + half, i, progress,
                   [&](PathSampler& sampler, BounceSample& sample) { tracer.specular(receivers[i], sampler, sample, counters); });
        addDirect(extended[half], kStreams * half + 1, i, progress, [&](PathSampler& sampler) { return tracer.extended(point, sampler, counters); });
        if (lobe)
          addDirect(highlights[half], kDirectSpecularStream + half, i, progress,
                    [&](PathSampler& sampler) { return tracer.extendedSpecular(receivers[i], sampler, counters); });
      }
      state.punctual[i] = punctual;
      if (lobe) state.punctualSpecular[i] = punctualHighlight;
      for (uint32_t half = 0; half < 2; ++half) {
        keep(state.indirect[half], i, paths[half]);
        state.extended[half][i] = extended[half];
        if (!lobe) continue;
        keep(state.specular[half], i, specular[half]);
        state.extendedSpecular[half][i] = highlights[half];
      }
    }
    state.ahead[i] = 1;
    total.backFaceHits += counters.backFaceHits, total.nonFinite += counters.nonFinite;
    total.paths += counters.paths, total.rays += counters.rays;
  }

  void advance(Progress& progress) {
    const uint32_t end = std::min(state.receivers, band + unitReceivers);
    const uint32_t count = end - band;
    std::vector<PathCounters> counters(pool.threads());
    const auto countIn = [&] {
      for (const PathCounters& c : counters) {
        state.backFaceHits += c.backFaceHits, state.nonFinite += c.nonFinite;
        state.paths += c.paths, state.rays += c.rays;
      }
    };
    try {
      progress.check();
      pool.parallelFor(count, std::max<size_t>(1, count / (8 * pool.threads())),
                       [&](size_t first, size_t last, unsigned worker) {
                         for (size_t i = band + first; i < band + last; ++i) {
                           if (state.ahead[i]) continue;
                           progress.check();
                           traceReceiver(static_cast<uint32_t>(i), progress, counters[worker]);
                         }
                       });
    } catch (...) {
      countIn();
      throw;
    }
    countIn();
    band = end;
    if (band < state.receivers) return;
    state.now = state.next;
    publish();
    planPass();
  }

  void publish() {
    auto r = std::make_shared<ReferenceResult>();
    r->width = width, r->height = height;
    r->samplesPerPixel = static_cast<int>(2 * state.now.paths);
    r->backFaceHits = state.backFaceHits, r->nonFinite = state.nonFinite;
    r->paths = state.paths, r->rays = state.rays;
    r->key = key;
    for (int half = 0; half < 2; ++half) {
      r->direct[half] = Image(width, height, 3);
      for (Image& image : r->indirect[half]) image = Image(width, height, 3);
      if (!lobes) continue;
      r->directSpecular[half] = Image(width, height, 3);
      for (Image& image : r->specular[half]) image = Image(width, height, 3);
    }
    constexpr size_t kGrain = 4096;
    pool.parallelFor(state.receivers, kGrain, [&](size_t first, size_t last, unsigned) {
      for (size_t half = 0; half < 2; ++half)
        for (size_t i = first; i < last; ++i) {
          const ReferenceCount n = state.ahead[i] ? state.next : state.now;
          const double direct = n.direct ? 1 / static_cast<double>(n.direct) : 0.0;
          const float paths = n.paths ? 1 / static_cast<float>(n.paths) : 0.0f;
          setPixel(r->direct[half], i, state.punctual[i] + vec3(state.extended[half][i] * direct));
          if (lobes) setPixel(r->directSpecular[half], i, state.punctualSpecular[i] + vec3(state.extendedSpecular[half][i] * direct));
          for (uint32_t b = 0; b < state.buckets; ++b) {
            setPixel(r->indirect[half][b], i, state.indirect[half][i * state.buckets + b] * paths);
            if (lobes) setPixel(r->specular[half][b], i, state.specular[half][i * state.buckets + b] * paths);
          }
        }
    });
    std::lock_guard lock(resultMutex);
    lastResult = std::move(r);
  }
};

ReferenceTracer::ReferenceTracer(std::shared_ptr<const EmbreeScene> scene, std::vector<Receiver> receivers, int width,
                                 int height, const ReferenceSettings& settings, TaskPool& pool)
    : impl_(std::make_unique<Impl>(std::move(scene), std::move(receivers), width, height, settings, pool)) {}

ReferenceTracer::~ReferenceTracer() = default;

void ReferenceTracer::resume() {
  Impl& im = *impl_;
  std::optional<ReferenceState> s = loadReference(im.key, {im.state.receivers, im.state.buckets, im.lobes}, im.goal.paths, im.samplesAPass);
  if (!s || s->now.direct > im.goal.direct) return;
  im.state = std::move(*s);
  im.band = 0;
  if (im.state.now.paths > 0) im.publish();
  if (im.state.now == im.state.next) im.planPass();
}

bool ReferenceTracer::settled() const { return impl_->settled(); }

void ReferenceTracer::advance(Progress& progress) {
  if (!impl_->settled()) impl_->advance(progress);
}

double ReferenceTracer::done() const {
  const Impl& im = *impl_;
  if (im.settled()) return 1;
  const auto work = [](const ReferenceCount& c) {
    return static_cast<double>(c.paths) + static_cast<double>(c.direct) / kDirectSamplesAPath;
  };
  const double share = static_cast<double>(im.band) / im.state.receivers;
  const double now = work(im.state.now) + share * (work(im.state.next) - work(im.state.now));
  return std::min(now / work(im.goal), 1.0);
}

std::shared_ptr<const ReferenceResult> ReferenceTracer::result() const {
  std::lock_guard lock(impl_->resultMutex);
  return impl_->lastResult;
}

void ReferenceTracer::store() const {
  if (impl_->state.paths > 0) storeReference(impl_->key, impl_->state);
}

}  // namespace hl
