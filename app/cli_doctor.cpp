// `doctor`: what the machine has, how fast it traces, and what is missing.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "app/cli_commands.h"
#include "engine/core/json_writer.h"
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/import_module.h"
#include "engine/core/task_pool.h"
#include "engine/scene/scene_file.h"
#include "engine/trace/tracer.h"
#include "shaders/shared/random.h"

namespace hl::cli {
namespace {

/// A batch that fills the device without running for seconds.
uint32_t rayCount(const Device& device) { return device.isCpu() ? 1u << 18 : 1u << 22; }
constexpr int kRuns = 9;              // after warming up
constexpr double kWarmUpMs = 300;     // of work on a GPU
/// Bytes copied at once: more than caches hold, no more than a buffer may have.
uint64_t copyBytes(const Device& device) {
  return std::min<uint64_t>(device.isCpu() ? 64ull << 20 : 1ull << 30, device.maxStorageBufferBytes() / 16 * 16);
}
constexpr float kRayOffset = 1e-5f;   // of the scene's diagonal

struct TracerReport {
  TracerListing listing;
  double closest = 0, any = 0;  ///< 1e6 rays a second
};

struct Report {
  DeviceInfo device;
  bool found = false;
  double copyGbps = 0;
  std::string scene;
  uint64_t triangles = 0;
  uint32_t rays = 0;  ///< a batch
  std::vector<TracerReport> tracers;
  std::vector<std::string> missing;
};

/// Points spread over the surface by area.
class SurfacePoints {
 public:
  explicit SurfacePoints(const Scene& scene) : scene_(scene) {
    double sum = 0;
    for (size_t t = 0; t < scene.triangles(); ++t) cumulative_.push_back(sum += 0.5 * glm::length(cross(t)));
  }

  bool empty() const { return cumulative_.empty() || !(cumulative_.back() > 0); }

  struct Point {
    vec3 position, normal;
  };
  Point sample(shared::Random& random) const {
    const double u = shared::randomFloat(random) * cumulative_.back();
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), u);
    const size_t t = std::min(static_cast<size_t>(found - cumulative_.begin()), cumulative_.size() - 1);
    const float root = std::sqrt(shared::randomFloat(random)), v = shared::randomFloat(random);
    const uvec3 i = scene_.indices[t];
    const vec3 p =
        (1 - root) * scene_.positions[i.x] + root * (1 - v) * scene_.positions[i.y] + root * v * scene_.positions[i.z];
    const vec3 n = cross(t);
    const float length = glm::length(n);
    return {p, length > 0 ? n / length : vec3(0, 1, 0)};
  }

 private:
  vec3 cross(size_t t) const {
    const uvec3 i = scene_.indices[t];
    return glm::cross(scene_.positions[i.y] - scene_.positions[i.x], scene_.positions[i.z] - scene_.positions[i.x]);
  }
  const Scene& scene_;
  std::vector<double> cumulative_;
};

/// Gathering rays: cosine distributed round the normals of random surface points. Incoherent, as a bake's are.
std::vector<shared::Ray> gatherRays(const SurfacePoints& points, uint32_t count, float diagonal) {
  std::vector<shared::Ray> rays(count);
  for (uint32_t i = 0; i < count; ++i) {
    shared::Random random = shared::randomInit(1, i, 0);
    const auto p = points.sample(random);
    // A unit sphere's point added to the normal is cosine distributed about it.
    const float z = 1 - 2 * shared::randomFloat(random), phi = 2 * kPi * shared::randomFloat(random);
    const float r = std::sqrt(std::max(0.0f, 1 - z * z));
    vec3 d = p.normal + vec3(r * std::cos(phi), r * std::sin(phi), z) * 0.999f;
    d = glm::normalize(d);
    rays[i] = {p.position + p.normal * (kRayOffset * diagonal), 0, d, 3e38f};
  }
  return rays;
}

/// Visibility rays: from one random surface point to another.
std::vector<shared::Ray> visibilityRays(const SurfacePoints& points, uint32_t count, float diagonal) {
  std::vector<shared::Ray> rays(count);
  for (uint32_t i = 0; i < count; ++i) {
    shared::Random random = shared::randomInit(2, i, 0);
    const auto from = points.sample(random), to = points.sample(random);
    const float side = glm::dot(from.normal, to.position - from.position) < 0 ? -1.0f : 1.0f;
    const vec3 origin = from.position + from.normal * (side * kRayOffset * diagonal);
    rays[i] = {origin, 0, to.position - origin, 1 - 1e-4f};
  }
  return rays;
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

/// Of the passes' own times: submission and waiting are no part of a tracer's rate.
double passMs(const BatchTimings& timings) {
  double ms = 0;
  for (const PassTiming& p : timings.passes) ms += p.ms;
  return ms;
}

/// Runs `once` (which returns its milliseconds) until it is warm: compiled, and a GPU's clocks up. Then the median of kRuns.
template <class Once>
double medianMs(const Device& device, Progress& progress, const Once& once) {
  double warm = 0;
  do {
    progress.check();
    warm += once();
  } while (!device.isCpu() && warm < kWarmUpMs);
  std::vector<double> ms;
  for (int run = 0; run < kRuns; ++run) {
    progress.check();
    ms.push_back(once());
  }
  return median(std::move(ms));
}

double millionRays(const Device& device, FrameGraph& graph, Tracer& tracer, const Buffer& rays, const Buffer& out, uint32_t count, Query query, Progress& progress) {
  return count / (1e3 * medianMs(device, progress, [&] {
    tracer.record(graph, "doctor: rays", rays, out, count, query);
    return passMs(graph.execute());
  }));
}

/// Buffer to buffer by a compute shader, as the engine's own passes move data; every byte is read once and written once.
double copyRate(Device& device, ShaderLibrary& shaders, Progress& progress) {
  FrameGraph graph(device, shaders);
  const uint64_t bytes = copyBytes(device);
  const Buffer from = device.buffer("doctor: from", bytes), to = device.buffer("doctor: to", bytes);
  graph.clear("doctor: clear", from);
  graph.execute();
  const auto words = static_cast<uint32_t>(bytes / 16);
  const double ms = medianMs(device, progress, [&] {
    graph.compute("doctor: copy", "passes/copy.comp").bind("from", from, Access::Read).bind("to", to, Access::Write).push(words).dispatchThreads(words);
    return passMs(graph.execute());
  });
  return static_cast<double>(bytes) / (ms * 1e6);
}

void traceScene(Report& report, Device& device, ShaderLibrary& shaders, const std::string& name, Progress& progress) {
  const Scene scene = loadScene(name, &progress);
  const uint32_t rays = rayCount(device);
  report.scene = scene.name, report.triangles = scene.triangles(), report.rays = rays;
  TaskPool pool;
  const GpuScene gpuScene = uploadScene(device, scene);
  const auto embree = std::make_shared<EmbreeScene>(scene, &progress);
  const SurfacePoints points(scene);
  if (points.empty()) throw badInput(fmt::format("{}: a scene without surfaces has no rays to time", name));
  const Buffer gather =
      device.buffer("doctor: gather rays", std::span<const shared::Ray>(gatherRays(points, rays, scene.bounds.diagonal())));
  const Buffer visibility = device.buffer(
      "doctor: visibility rays", std::span<const shared::Ray>(visibilityRays(points, rays, scene.bounds.diagonal())));
  const Buffer hits = device.buffer("doctor: hits", rays * sizeof(shared::Hit));
  const Buffer bits = device.buffer("doctor: bits", rays * sizeof(uint32_t));
  for (const TracerListing& listing : listTracers(device)) {
    TracerReport r{listing};
    if (listing.available) {
      const auto tracer = makeTracer(listing.id, device, shaders, scene, gpuScene, embree, pool, &progress);
      FrameGraph graph(device, shaders);
      r.closest = millionRays(device, graph, *tracer, gather, hits, rays, Query::Closest, progress);
      r.any = millionRays(device, graph, *tracer, visibility, bits, rays, Query::Any, progress);
    }
    report.tracers.push_back(r);
  }
}

void missingThings(Report& report) {
  if (const std::string why = importMissing(); !why.empty())
    report.missing.push_back(fmt::format("import module: {}; scenes come from bundles (.hlb), images are .pfm", why));
  for (const SceneListing& s : listScenes())
    if (!s.available) report.missing.push_back(fmt::format("scene {}: {}", s.id, s.missing));
  if (!std::getenv("HALFLIGHT_SCENES"))
    report.missing.push_back(
        "HALFLIGHT_SCENES is not set: folders with scenes beyond the project's own, separated by colons");
}

std::string asJson(const Report& r) {
  JsonWriter w;
  w.beginObject().key("device");
  if (!r.found)
    w.null();
  else
    w.beginObject()
        .member("name", r.device.name)
        .member("type", r.device.type)
        .member("driver", r.device.driver)
        .member("api", r.device.api)
        .endObject();
  w.key("features").beginObject();
  for (const auto& [name, there] : r.device.features) w.member(name, there);
  w.endObject().member("copy_gbps", r.copyGbps).member("scene", r.scene).member("triangles", r.triangles).member("rays", r.rays);
  w.key("tracers").beginArray();
  for (const TracerReport& t : r.tracers) {
    w.beginObject()
        .member("id", t.listing.id)
        .member("available", t.listing.available)
        .member("reason", t.listing.reason);
    for (const auto& [name, rate] : {std::pair{"mrays_closest", t.closest}, std::pair{"mrays_any", t.any}}) {
      w.key(name);
      t.listing.available ? w.number(rate) : w.null();
    }
    w.endObject();
  }
  w.endArray().key("missing").beginArray();
  for (const std::string& m : r.missing) w.text(m);
  return w.endArray().endObject().str() + "\n";
}

std::string asText(const Report& r) {
  std::string out;
  if (r.found) {
    out += fmt::format("device   {} ({})\ndriver   {}\nVulkan   {}\n", r.device.name, r.device.type, r.device.driver,
                       r.device.api);
    for (const auto& [name, there] : r.device.features)
      out += fmt::format("         {:<40} {}\n", name, there ? "yes" : "no");
    out += fmt::format("copy     {:.1f} GB/s copied (each byte read and written)\n", r.copyGbps);
  }
  if (!r.tracers.empty())
    out += fmt::format("tracers  on {} ({} triangles), batches of {} incoherent rays\n", r.scene, r.triangles, r.rays);
  for (const TracerReport& t : r.tracers)
    out += t.listing.available ? fmt::format("         {:<8} {:8.2f} Mrays/s closest hit, {:8.2f} any hit\n",
                                             t.listing.id, t.closest, t.any)
                               : fmt::format("         {:<8} not here: {}\n", t.listing.id, t.listing.reason);
  for (const std::string& m : r.missing) out += fmt::format("missing  {}\n", m);
  return out;
}

}  // namespace

int doctor(const GlobalOptions& global, const std::string& scene) {
  const auto progress = interruptibleProgress(global);
  Report report;
  missingThings(report);
  try {
    Device device({global.device, global.validation});
    report.device = device.info();
    report.found = true;
    ShaderLibrary shaders(device);
    report.copyGbps = copyRate(device, shaders, *progress);
    traceScene(report, device, shaders, scene, *progress);
    finishProgress();
    print(global.json ? asJson(report) : asText(report));
    return validationVerdict(global, device, 0);
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::Device) throw;
    // What is wrong with the device is what the doctor was asked.
    report.missing.insert(report.missing.begin(), e.what());
    finishProgress();
    print(global.json ? asJson(report) : asText(report));
    throw;
  }
}

}  // namespace hl::cli
