#include "engine/passes/direct_light.h"

#include <algorithm>
#include <string>

#include "engine/core/error.h"
#include "shaders/passes/direct_batch.h"
#include "shaders/shared/surface_point.h"

namespace hl {
namespace {

/// Rays in flight at most: 48 bytes each. Larger batches go in pieces.
constexpr uint64_t kMaxRays = 1u << 20;
constexpr const char* kNoLights = "scene has no lights";

/// Rays of a batch, and what each brings where nothing stands in its way. Grows, never shrinks.
struct RayBuffers {
  Buffer rays, unshadowed, occluded;

  void reserve(Device& device, uint64_t count) {
    if (rays && rays.size() >= count * sizeof(shared::Ray)) return;
    rays = device.buffer("direct: rays", count * sizeof(shared::Ray));
    unshadowed = device.buffer("direct: unshadowed", count * sizeof(vec3));
    occluded = device.buffer("direct: occluded", count * sizeof(uint32_t));
  }
};

uint64_t bytesOf(const Buffer& b) { return b ? b.size() : 0; }

}  // namespace

struct DirectLight::Impl {
  Device& device;
  const GpuScene& scene;
  Tracer& tracer;
  RayBuffers buffers;

  // What pixels have gathered since the last reset.
  Buffer points, punctual, sampled;
  GpuImage result;
  uint32_t samplesDone = 0, seed = 0;
  bool punctualDone = false, cleared = false;

  bool skyShines() const { return scene.sky.x > 0 || scene.sky.y > 0 || scene.sky.z > 0; }
  bool environmentShines() const { return scene.environment.width > 0; }
  bool hasSampled() const { return scene.emitterCount > 0 || skyShines() || environmentShines(); }
  bool hasLights() const { return scene.lightCount > 0 || hasSampled(); }

  uint64_t rayLimit() const {
    return std::min<uint64_t>(kMaxRays, device.maxStorageBufferBytes() / sizeof(shared::Ray));
  }

  shared::DirectBatch batch(uint32_t seedValue, uint32_t firstSample, uint32_t samples, bool withPunctual,
                            bool withSampled) const {
    shared::DirectBatch b{};
    b.seed = seedValue;
    b.firstSample = firstSample;
    b.samples = samples;
    b.lights = withPunctual ? scene.lightCount : 0;
    b.emitters = withSampled ? scene.emitterCount : 0;
    b.skyRays = withSampled && skyShines() ? 1 : 0;
    b.sky = scene.sky;
    b.environmentRays = withSampled && environmentShines() ? 1 : 0;
    b.environment = scene.environment;
    return b;
  }

  uint32_t pointsAtOnce(const shared::DirectBatch& b) const {
    const uint64_t slots = std::max<uint64_t>(1, shared::directSlots(b));
    return static_cast<uint32_t>(std::max<uint64_t>(1, rayLimit() / slots));
  }

  void recordBatch(FrameGraph& graph, const std::string& prefix, const Buffer& from, const Buffer& to,
                   const shared::DirectBatch& b) {
    const uint32_t slots = shared::directSlots(b);
    const uint64_t rays = uint64_t{b.count} * slots;
    if (rays > rayLimit() && b.count > 1)
      throw Error(ErrorKind::Run, prefix + ": a batch of " + std::to_string(rays) + " rays is too large");
    buffers.reserve(device, rays);
    graph.compute(prefix + ": sample lights", "passes/direct_sample.comp")
        .bind("points", from, Access::Read)
        .bind("lights", scene.lights, Access::Read)
        .bind("emitters", scene.emitters, Access::Read)
        .bind("environment_texels", scene.environmentTexels, Access::Read)
        .bind("environment_table", scene.environmentTable, Access::Read)
        .bind("rays", buffers.rays, Access::Write)
        .bind("unshadowed", buffers.unshadowed, Access::Write)
        .push(b)
        .dispatchThreads(b.count, slots);
    tracer.record(graph, prefix + ": shadow rays", buffers.rays, buffers.occluded, static_cast<uint32_t>(rays),
                  Query::Any);
    graph.compute(prefix + ": accumulate", "passes/direct_accumulate.comp")
        .bind("unshadowed", buffers.unshadowed, Access::Read)
        .bind("occluded", buffers.occluded, Access::Read)
        .bind("irradiance", to, Access::ReadWrite)
        .push(b)
        .dispatchThreads(b.count);
  }

  void skipBatch(FrameGraph& graph, const std::string& prefix, const std::string& reason) const {
    for (const char* pass : {": sample lights", ": shadow rays", ": accumulate"}) graph.skip(prefix + pass, reason);
  }

  void restart() { samplesDone = 0, punctualDone = false, cleared = false; }

  void resize(int width, int height) {
    if (result && result.width() == width && result.height() == height) return;
    const uint64_t bytes = static_cast<uint64_t>(width) * static_cast<uint64_t>(height) * sizeof(vec4);
    if (bytes > device.maxStorageBufferBytes())
      throw Error(ErrorKind::TooLarge, "direct: " + std::to_string(width) + " x " + std::to_string(height) +
                                         " pixels take " + std::to_string(bytes) +
                                         " bytes, a buffer of this device holds " +
                                         std::to_string(device.maxStorageBufferBytes()));
    result = device.image("direct: irradiance", {width, height, Format::RGBA32F});
    punctual = device.buffer("direct: punctual sum", bytes);
    sampled = device.buffer("direct: sampled sum", bytes);
    restart();
  }

  /// All pixels, piece by piece: points from the G-buffer, then one batch.
  void recordPieces(FrameGraph& graph, const std::string& prefix, const GBuffer& g, float offset, shared::DirectBatch b,
                    const Buffer& sum) {
    const auto pixels = static_cast<uint32_t>(g.width) * static_cast<uint32_t>(g.height);
    const uint32_t piece = std::min(pixels, pointsAtOnce(b));
    if (!points || points.size() < uint64_t{piece} * sizeof(shared::SurfacePoint))
      points = device.buffer("direct: points", uint64_t{piece} * sizeof(shared::SurfacePoint));
    for (uint32_t first = 0; first < pixels; first += piece) {
      struct Constants {
        uint32_t firstPixel, count;
        float offset;
      } constants{first, std::min(piece, pixels - first), offset};
      graph.compute(prefix + ": surface points", "passes/direct_points.comp")
          .bind("position", g.position, Access::Read)
          .bind("normal", g.normal, Access::Read)
          .bind("geometricNormal", g.geometricNormal, Access::Read)
          .bind("ids", g.ids, Access::Read)
          .bind("points", points, Access::Write)
          .push(constants)
          .dispatchThreads(constants.count);
      b.targetBase = first;
      b.count = constants.count;
      recordBatch(graph, prefix, points, sum, b);
    }
  }
};

DirectLight::DirectLight(Device& device, ShaderLibrary&, const GpuScene& scene, Tracer& tracer)
    : impl_(std::make_unique<Impl>(Impl{device, scene, tracer, {}, {}, {}, {}, {}})) {}

DirectLight::~DirectLight() = default;

void DirectLight::record(FrameGraph& graph, const std::string& prefix, const Buffer& points, const Buffer& irradiance,
                         uint32_t first, uint32_t count, uint32_t seed, uint32_t sample) {
  Impl& im = *impl_;
  if (!im.hasLights() || count == 0) return im.skipBatch(graph, prefix, im.hasLights() ? "no points" : kNoLights);
  const uint64_t end = uint64_t{first} + count;
  if (points.size() < end * sizeof(shared::SurfacePoint) || irradiance.size() < end * sizeof(vec4))
    throw badInput(prefix + ": points [" + std::to_string(first) + ", " + std::to_string(end) +
                   ") lie outside buffer " +
                   (points.size() < end * sizeof(shared::SurfacePoint) ? points.name() : irradiance.name()));
  shared::DirectBatch b = im.batch(seed, sample, 1, true, true);
  const uint32_t piece = im.pointsAtOnce(b);
  for (uint32_t at = 0; at < count; at += piece) {
    b.pointBase = b.targetBase = first + at;
    b.count = std::min(piece, count - at);
    im.recordBatch(graph, prefix, points, irradiance, b);
  }
}

GpuImage DirectLight::recordPixels(FrameGraph& graph, const GBuffer& g, const DirectParams& params, uint32_t seed) {
  Impl& im = *impl_;
  im.resize(g.width, g.height);
  if (im.seed != seed) im.restart(), im.seed = seed;
  if (!im.cleared) {
    graph.clear("direct: clear punctual sum", im.punctual);
    graph.clear("direct: clear sampled sum", im.sampled);
    graph.clear("direct: clear irradiance", im.result);
    im.cleared = true;
  }
  const float offset = params.ray_offset * im.scene.diagonal;
  const bool punctualNow = im.scene.lightCount > 0 && !im.punctualDone;
  const auto wanted = static_cast<uint32_t>(params.samples);
  const bool sampledNow = im.hasSampled() && im.samplesDone < wanted;

  // Punctual lights have one direction each: one ray tells all there is to know.
  if (punctualNow) {
    im.recordPieces(graph, "direct punctual", g, offset, im.batch(seed, 0, 1, true, false), im.punctual);
    im.punctualDone = true;
  } else {
    im.skipBatch(graph, "direct punctual", im.scene.lightCount == 0 ? "scene has no punctual lights" : "settled");
  }
  if (sampledNow) {
    const uint32_t samples = std::min(static_cast<uint32_t>(params.samples_per_frame), wanted - im.samplesDone);
    im.recordPieces(graph, "direct", g, offset, im.batch(seed, im.samplesDone, samples, false, true), im.sampled);
    im.samplesDone += samples;
  } else {
    im.skipBatch(graph, "direct",
                 im.hasSampled()  ? "settled"
                 : im.hasLights() ? "scene has no emitters, no sky and no environment map"
                                  : kNoLights);
  }
  if (punctualNow || sampledNow) {
    graph.compute("direct: mean", "passes/direct_mean.comp")
        .bind("punctual", im.punctual, Access::Read)
        .bind("sampled", im.sampled, Access::Read)
        .bind("result", im.result, Access::Write)
        .dispatchThreads(static_cast<uint32_t>(g.width), static_cast<uint32_t>(g.height));
  } else {
    graph.skip("direct: mean", im.hasLights() ? "settled" : kNoLights);
  }
  return im.result;
}

void DirectLight::reset() { impl_->restart(); }

bool DirectLight::settled(const DirectParams& params) const {
  const Impl& im = *impl_;
  return (im.scene.lightCount == 0 || im.punctualDone) &&
         (!im.hasSampled() || im.samplesDone >= static_cast<uint32_t>(params.samples));
}

bool DirectLight::exactAfterOneSample() const { return !impl_->hasSampled(); }

std::vector<std::pair<std::string, uint64_t>> DirectLight::memory() const {
  const Impl& im = *impl_;
  const uint64_t rays = bytesOf(im.buffers.rays) + bytesOf(im.buffers.unshadowed) + bytesOf(im.buffers.occluded);
  const uint64_t image =
      im.result ? static_cast<uint64_t>(im.result.width()) * static_cast<uint64_t>(im.result.height()) * sizeof(vec4)
                : 0;
  return {{"direct: rays", rays},
          {"direct: points", bytesOf(im.points)},
          {"direct: sums", bytesOf(im.punctual) + bytesOf(im.sampled)},
          {"direct: irradiance", image}};
}

}  // namespace hl
