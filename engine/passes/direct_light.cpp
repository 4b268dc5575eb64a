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

/// The same of lobes' rays.
struct LobeBuffers {
  Buffer rays, weights, hits;

  void reserve(Device& device, uint64_t count) {
    if (rays && rays.size() >= count * sizeof(shared::Ray)) return;
    rays = device.buffer("direct specular: rays", count * sizeof(shared::Ray));
    weights = device.buffer("direct specular: weights", count * sizeof(vec3));
    hits = device.buffer("direct specular: hits", count * sizeof(shared::Hit));
  }
};

/// Sums over samples by pixel, and their mean so far.
struct PixelSums {
  Buffer punctual, sampled;
  GpuImage result;
  uint32_t samplesDone = 0, seed = 0;
  bool punctualDone = false, cleared = false;

  void restart() { samplesDone = 0, punctualDone = false, cleared = false; }
};

uint64_t bytesOf(const Buffer& b) { return b ? b.size() : 0; }

}  // namespace

struct DirectLight::Impl {
  Device& device;
  const GpuScene& scene;
  Tracer& tracer;
  RayBuffers buffers;

  LobeBuffers lobes;

  // What pixels have gathered since the last reset, as irradiance and by their lobes.
  Buffer points;
  PixelSums irradiance, specular;

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

  /// Points with so many rays each.
  uint32_t pointsAtOnce(uint32_t slots) const { return static_cast<uint32_t>(std::max<uint64_t>(1, rayLimit() / std::max(1u, slots))); }

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

  void recordLobeBatch(FrameGraph& graph, const std::string& prefix, const GBuffer& g, const Buffer& sums, const shared::DirectBatch& b) {
    const uint32_t lightSlots = shared::lobeLightSlots(b), raySlots = shared::lobeRaySlots(b);
    const uint32_t lightRays = b.count * lightSlots, lobeRays = b.count * raySlots;
    buffers.reserve(device, std::max(1u, lightRays));
    lobes.reserve(device, std::max(1u, lobeRays));
    graph.compute(prefix + ": sample lights and lobes", "passes/direct_specular.comp")
        .bind("points", points, Access::Read)
        .bind("lights", scene.lights, Access::Read)
        .bind("emitters", scene.emitters, Access::Read)
        .bind("specular", g.specular, Access::Read)
        .bind("rays", buffers.rays, Access::Write)
        .bind("unshadowed", buffers.unshadowed, Access::Write)
        .bind("lobe_rays", lobes.rays, Access::Write)
        .bind("lobe_weights", lobes.weights, Access::Write)
        .push(b)
        .dispatchThreads(b.count, lightSlots + raySlots);
    if (lightRays > 0) tracer.record(graph, prefix + ": shadow rays", buffers.rays, buffers.occluded, lightRays, Query::Any);
    if (lobeRays > 0) tracer.record(graph, prefix + ": lobe rays", lobes.rays, lobes.hits, lobeRays, Query::Closest);
    graph.compute(prefix + ": gather", "passes/direct_specular_gather.comp")
        .bind("points", points, Access::Read)
        .bind("emitters", scene.emitters, Access::Read)
        .bind("environment_texels", scene.environmentTexels, Access::Read)
        .bind("specular", g.specular, Access::Read)
        .bind("unshadowed", buffers.unshadowed, Access::Read)
        .bind("occluded", buffers.occluded, Access::Read)
        .bind("lobe_rays", lobes.rays, Access::Read)
        .bind("lobe_weights", lobes.weights, Access::Read)
        .bind("lobe_hits", lobes.hits, Access::Read)
        .bind("sums", sums, Access::ReadWrite)
        .push(b)
        .dispatchThreads(b.count);
  }

  void restart() { irradiance.restart(), specular.restart(); }

  bool punctualLeft(const PixelSums& s) const { return scene.lightCount > 0 && !s.punctualDone; }
  bool samplesLeft(const PixelSums& s, const DirectParams& params) const { return hasSampled() && s.samplesDone < static_cast<uint32_t>(params.samples); }

  void clear(FrameGraph& graph, const std::string& name, PixelSums& s, uint32_t seed) const {
    if (s.seed != seed) s.restart(), s.seed = seed;
    if (s.cleared) return;
    graph.clear(name + ": clear punctual sum", s.punctual);
    graph.clear(name + ": clear sampled sum", s.sampled);
    graph.clear(name + ": clear result", s.result);
    s.cleared = true;
  }

  static void recordMean(FrameGraph& graph, const std::string& name, const PixelSums& s) {
    graph.compute(name, "passes/direct_mean.comp")
        .bind("punctual", s.punctual, Access::Read)
        .bind("sampled", s.sampled, Access::Read)
        .bind("result", s.result, Access::Write)
        .dispatchThreads(static_cast<uint32_t>(s.result.width()), static_cast<uint32_t>(s.result.height()));
  }

  void resize(PixelSums& s, const std::string& name, const char* what, int width, int height) const {
    if (s.result && s.result.width() == width && s.result.height() == height) return;
    const uint64_t bytes = static_cast<uint64_t>(width) * static_cast<uint64_t>(height) * sizeof(vec4);
    if (bytes > device.maxStorageBufferBytes())
      throw Error(ErrorKind::TooLarge, "direct: " + std::to_string(width) + " x " + std::to_string(height) +
                                         " pixels take " + std::to_string(bytes) +
                                         " bytes, a buffer of this device holds " +
                                         std::to_string(device.maxStorageBufferBytes()));
    s.result = device.image(name + ": " + what, {width, height, Format::RGBA32F});
    s.punctual = device.buffer(name + ": punctual sum", bytes);
    s.sampled = device.buffer(name + ": sampled sum", bytes);
    s.restart();
  }

  /// All pixels, piece by piece: points from the G-buffer, then one batch. With `eye` what lobes reflect towards it, without what falls on the pixels.
  void recordPieces(FrameGraph& graph, const std::string& prefix, const GBuffer& g, const DirectParams& params, const vec3* eye, shared::DirectBatch b,
                    const Buffer& sum) {
    if (eye) b.eye = *eye;
    const float offset = params.ray_offset * scene.diagonal;
    const auto pixels = static_cast<uint32_t>(g.width) * static_cast<uint32_t>(g.height);
    const uint32_t piece = std::min(pixels, pointsAtOnce(eye ? shared::lobeLightSlots(b) + shared::lobeRaySlots(b) : shared::directSlots(b)));
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
      if (eye)
        recordLobeBatch(graph, prefix, g, sum, b);
      else
        recordBatch(graph, prefix, points, sum, b);
    }
  }

  /// Punctual lights have one direction each: one ray tells all there is to know.
  void recordPunctual(FrameGraph& graph, const std::string& prefix, const GBuffer& g, const DirectParams& params, const vec3* eye, PixelSums& s) {
    recordPieces(graph, prefix, g, params, eye, batch(s.seed, 0, 1, true, false), s.punctual);
    s.punctualDone = true;
  }

  /// The next samples of all other light, as many as a frame may take.
  void recordSamples(FrameGraph& graph, const std::string& prefix, const GBuffer& g, const DirectParams& params, const vec3* eye, PixelSums& s) {
    const uint32_t samples = std::min(static_cast<uint32_t>(params.samples_per_frame), static_cast<uint32_t>(params.samples) - s.samplesDone);
    recordPieces(graph, prefix, g, params, eye, batch(s.seed, s.samplesDone, samples, false, true), s.sampled);
    s.samplesDone += samples;
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
  const uint32_t piece = im.pointsAtOnce(shared::directSlots(b));
  for (uint32_t at = 0; at < count; at += piece) {
    b.pointBase = b.targetBase = first + at;
    b.count = std::min(piece, count - at);
    im.recordBatch(graph, prefix, points, irradiance, b);
  }
}

GpuImage DirectLight::recordPixels(FrameGraph& graph, const GBuffer& g, const DirectParams& params, uint32_t seed) {
  Impl& im = *impl_;
  PixelSums& sums = im.irradiance;
  im.resize(sums, "direct", "irradiance", g.width, g.height);
  im.clear(graph, "direct", sums, seed);
  const bool punctualNow = im.punctualLeft(sums), sampledNow = im.samplesLeft(sums, params);
  if (punctualNow)
    im.recordPunctual(graph, "direct punctual", g, params, nullptr, sums);
  else
    im.skipBatch(graph, "direct punctual", im.scene.lightCount == 0 ? "scene has no punctual lights" : "settled");
  if (sampledNow)
    im.recordSamples(graph, "direct", g, params, nullptr, sums);
  else
    im.skipBatch(graph, "direct",
                 im.hasSampled()  ? "settled"
                 : im.hasLights() ? "scene has no emitters, no sky and no environment map"
                                  : kNoLights);
  if (punctualNow || sampledNow)
    im.recordMean(graph, "direct: mean", sums);
  else
    graph.skip("direct: mean", im.hasLights() ? "settled" : kNoLights);
  return sums.result;
}

GpuImage DirectLight::recordSpecular(FrameGraph& graph, const GBuffer& g, vec3 eye, const DirectParams& params, uint32_t seed) {
  Impl& im = *impl_;
  if (!g.specular || !im.hasLights()) {
    graph.skip("direct specular", g.specular ? kNoLights : "scene has no glossy surfaces");
    return {};
  }
  PixelSums& sums = im.specular;
  im.resize(sums, "direct specular", "radiance", g.width, g.height);
  im.clear(graph, "direct specular", sums, seed);
  const bool punctualNow = im.punctualLeft(sums), sampledNow = im.samplesLeft(sums, params);
  if (!punctualNow && !sampledNow) {
    graph.skip("direct specular", "settled");
    return sums.result;
  }
  if (punctualNow) im.recordPunctual(graph, "direct specular punctual", g, params, &eye, sums);
  if (sampledNow) im.recordSamples(graph, "direct specular", g, params, &eye, sums);
  im.recordMean(graph, "direct specular: mean", sums);
  return sums.result;
}

void DirectLight::reset() { impl_->restart(); }

bool DirectLight::settled(const DirectParams& params) const {
  const Impl& im = *impl_;
  const auto done = [&](const PixelSums& s) { return !im.punctualLeft(s) && !im.samplesLeft(s, params); };
  return done(im.irradiance) && (!im.scene.features.glossySurfaces || done(im.specular));
}

bool DirectLight::exactAfterOneSample() const { return !impl_->hasSampled(); }

std::vector<std::pair<std::string, uint64_t>> DirectLight::memory() const {
  const Impl& im = *impl_;
  const uint64_t rays = bytesOf(im.buffers.rays) + bytesOf(im.buffers.unshadowed) + bytesOf(im.buffers.occluded);
  const uint64_t lobes = bytesOf(im.lobes.rays) + bytesOf(im.lobes.weights) + bytesOf(im.lobes.hits);
  const auto image = [](const GpuImage& i) { return i ? static_cast<uint64_t>(i.width()) * static_cast<uint64_t>(i.height()) * sizeof(vec4) : 0; };
  const auto sums = [](const PixelSums& s) { return bytesOf(s.punctual) + bytesOf(s.sampled); };
  std::vector<std::pair<std::string, uint64_t>> out = {{"direct: rays", rays},
                                                       {"direct: points", bytesOf(im.points)},
                                                       {"direct: sums", sums(im.irradiance)},
                                                       {"direct: irradiance", image(im.irradiance.result)}};
  if (im.specular.result) out.insert(out.end(), {{"direct specular: rays", lobes}, {"direct specular: sums", sums(im.specular)}, {"direct specular: radiance", image(im.specular.result)}});
  return out;
}

}  // namespace hl
