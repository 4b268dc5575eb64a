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
#include "engine/passes/measured_rates.h"
#include "engine/scene/scene_file.h"
#include "engine/trace/surface_rays.h"
#include "engine/trace/tracer.h"

namespace hl::cli {
namespace {

/// A batch that fills the device without running for seconds.
uint32_t rayCount(const Device& device) { return device.isCpu() ? 1u << 18 : 1u << 22; }
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

void traceScene(Report& report, Device& device, ShaderLibrary& shaders, const std::string& name, Progress& progress) {
  const Scene scene = loadScene(name, &progress);
  const uint32_t rays = rayCount(device);
  report.scene = scene.name, report.triangles = scene.triangles(), report.rays = rays;
  TaskPool pool;
  const GpuScene gpuScene = uploadScene(device, scene);
  const auto embree = std::make_shared<EmbreeScene>(scene, &progress);
  const float offset = kRayOffset * scene.bounds.diagonal();
  const std::vector<shared::Ray> gatherings = gatherRays(scene, rays, offset), visibilities = visibilityRays(scene, rays, offset);
  if (gatherings.empty()) throw badInput(fmt::format("{}: a scene without surfaces has no rays to time", name));
  const Buffer gather = device.buffer("doctor: gather rays", std::span<const shared::Ray>(gatherings));
  const Buffer visibility = device.buffer("doctor: visibility rays", std::span<const shared::Ray>(visibilities));
  const Buffer hits = device.buffer("doctor: hits", rays * sizeof(shared::Hit));
  const Buffer bits = device.buffer("doctor: bits", rays * sizeof(uint32_t));
  for (const TracerListing& listing : listTracers(device)) {
    TracerReport r{listing};
    if (listing.available) {
      const auto tracer = makeTracer(listing.id, device, shaders, scene, gpuScene, embree, pool, &progress);
      FrameGraph graph(device, shaders);
      r.closest = traceRate(device, graph, *tracer, gather, hits, rays, Query::Closest, progress);
      r.any = traceRate(device, graph, *tracer, visibility, bits, rays, Query::Any, progress);
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
