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
#include "engine/core/task_pool.h"
#include "engine/scene/scene_file.h"
#include "engine/trace/tracer.h"
#include "shaders/shared/random.h"

namespace hl::cli {
namespace {

constexpr uint32_t kRays = 1u << 18;  // a batch that fills any device without running for seconds on a slow one
constexpr int kRuns = 5;              // after one that is warm-up
constexpr int kCopySide = 2048;       // 64 MiB as RGBA32F
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
std::vector<shared::Ray> gatherRays(const SurfacePoints& points, float diagonal) {
  std::vector<shared::Ray> rays(kRays);
  for (uint32_t i = 0; i < kRays; ++i) {
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
std::vector<shared::Ray> visibilityRays(const SurfacePoints& points, float diagonal) {
  std::vector<shared::Ray> rays(kRays);
  for (uint32_t i = 0; i < kRays; ++i) {
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

double millionRays(FrameGraph& graph, Tracer& tracer, const Buffer& rays, const Buffer& out, Query query,
                   Progress& progress) {
  std::vector<double> ms;
  for (int run = 0; run <= kRuns; ++run) {
    progress.check();
    tracer.record(graph, "doctor: rays", rays, out, kRays, query);
    const BatchTimings t = graph.execute();
    if (run > 0) ms.push_back(t.wallMs);  // the first compiles
  }
  return kRays / (median(ms) * 1e3);
}

double copyRate(Device& device, ShaderLibrary& shaders) {
  FrameGraph graph(device, shaders);
  const ImageDesc desc{kCopySide, kCopySide, Format::RGBA32F};
  const GpuImage from = device.image("doctor: from", desc), to = device.image("doctor: to", desc);
  graph.clear("doctor: clear", from);
  graph.execute();
  std::vector<double> ms;
  for (int run = 0; run <= kRuns; ++run) {
    graph.copy("doctor: copy", from, to);
    const double wall = graph.execute().wallMs;
    if (run > 0) ms.push_back(wall);
  }
  return 16.0 * kCopySide * kCopySide / (median(ms) * 1e6);
}

void traceScene(Report& report, Device& device, ShaderLibrary& shaders, const std::string& name, Progress& progress) {
  const Scene scene = loadScene(name, &progress);
  report.scene = scene.name, report.triangles = scene.triangles();
  TaskPool pool;
  const GpuScene gpuScene = uploadScene(device, scene);
  const auto embree = std::make_shared<const EmbreeScene>(scene, &progress);
  const SurfacePoints points(scene);
  if (points.empty()) throw badInput(fmt::format("{}: a scene without surfaces has no rays to time", name));
  const Buffer gather =
      device.buffer("doctor: gather rays", std::span<const shared::Ray>(gatherRays(points, scene.bounds.diagonal())));
  const Buffer visibility = device.buffer(
      "doctor: visibility rays", std::span<const shared::Ray>(visibilityRays(points, scene.bounds.diagonal())));
  const Buffer hits = device.buffer("doctor: hits", kRays * sizeof(shared::Hit));
  const Buffer bits = device.buffer("doctor: bits", kRays * sizeof(uint32_t));
  for (const TracerListing& listing : listTracers(device)) {
    TracerReport r{listing};
    if (listing.available) {
      const auto tracer = makeTracer(listing.id, device, shaders, scene, gpuScene, embree, pool, &progress);
      FrameGraph graph(device, shaders);
      r.closest = millionRays(graph, *tracer, gather, hits, Query::Closest, progress);
      r.any = millionRays(graph, *tracer, visibility, bits, Query::Any, progress);
    }
    report.tracers.push_back(r);
  }
}

void missingThings(Report& report) {
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
  w.endObject().member("copy_gbps", r.copyGbps).member("scene", r.scene).member("triangles", r.triangles);
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
    out += fmt::format("copy     {:.1f} GB/s, image to image\n", r.copyGbps);
  }
  if (!r.tracers.empty())
    out += fmt::format("tracers  on {} ({} triangles), batches of {} incoherent rays\n", r.scene, r.triangles, kRays);
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
    report.copyGbps = copyRate(device, shaders);
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
