#include "engine/techniques/srp/probe_factors.h"

#include <algorithm>
#include <cmath>

#include "engine/lightmap/tables.h"
#include "engine/techniques/srp/clusters.h"
#include "engine/techniques/srp/precomputation.h"
#include "shaders/shared/ray.h"

namespace hl {
namespace {

template <class T>
std::vector<T> valuesOf(Device& device, const Buffer& buffer, size_t count) {
  std::vector<T> out(count);
  device.download(buffer, out.data(), count * sizeof(T));
  return out;
}

}  // namespace

std::vector<ProbeFactors> probeFactors(Gpu gpu, const SceneView& scene, const SrpParams& params, uint32_t lumel) {
  Device& device = gpu.device;
  const vec3 extent = scene.scene.bounds.max - scene.scene.bounds.min;
  const std::vector<AskedProbe> asked = askedProbes(scene.atlas->lumels[lumel].position, scene.probes->positions, params, std::max(extent.x, std::max(extent.y, extent.z)));
  if (asked.empty()) return {};
  Progress progress;
  const LightmapTables tables = makeLightmapTables(scene.scene, *scene.atlas, 0, progress);
  const Buffer triangles = device.buffer("srp: triangles", tables.triangles.size() * sizeof(vec4), TexelFormat::RGBA32F);
  device.upload(triangles, tables.triangles.data(), tables.triangles.size() * sizeof(vec4));
  shared::SurfacePoint point = lumelPoints(*scene.atlas, Precomputation::rayOffset(scene))[lumel];
  point.flags = lumel;
  std::vector<vec4> places;
  for (const vec3 p : scene.probes->positions) places.push_back(vec4(p, 0.0f));
  std::vector<shared::SrpNear> slots;
  for (const AskedProbe& a : asked) slots.push_back({a.probe, 0, a.weight});

  shared::SrpUnit unit = Precomputation::unitOf(scene, params);
  unit.receivers = 1, unit.samples = std::min(kFactorSamples, static_cast<uint32_t>(params.receiver_rays)), unit.slots = static_cast<uint32_t>(slots.size());
  const uint32_t rays = unit.samples, questions = rays * unit.slots;
  const Buffer points = device.buffer("srp: picked receiver", std::span<const shared::SurfacePoint>(&point, 1));
  const Buffer near = device.buffer("srp: its probes", std::span<const shared::SrpNear>(slots)), probes = device.buffer("srp: probes", std::span<const vec4>(places));
  const Buffer rayBuffer = device.buffer("srp: its rays", sizeof(shared::Ray) * rays, TexelFormat::RGBA32F), hits = device.buffer("srp: its hits", sizeof(shared::Hit) * rays);
  const Buffer questionBuffer = device.buffer("srp: its questions", sizeof(shared::Ray) * questions, TexelFormat::RGBA32F);
  const Buffer shares = device.buffer("srp: its shares", sizeof(float) * questions), blocked = device.buffer("srp: blocked", sizeof(uint32_t) * questions);
  const Buffer scales = device.buffer("srp: its scales", sizeof(float) * rays);

  FrameGraph graph(device, gpu.shaders);
  Precomputation::recordQuestions(graph, scene, unit, {points, rayBuffer, hits, near, probes, triangles, questionBuffer, shares, blocked, scales});
  graph.execute();

  const auto what = valuesOf<shared::Hit>(device, hits, rays);
  const auto asks = valuesOf<shared::Ray>(device, questionBuffer, questions);
  const auto hidden = valuesOf<uint32_t>(device, blocked, questions);
  const auto kept = valuesOf<float>(device, shares, questions), scale = valuesOf<float>(device, scales, rays);
  std::vector<ProbeFactors> out;
  for (uint32_t q = 0; q < unit.slots; ++q) {
    ProbeFactors f;
    f.probe = asked[q].probe, f.distance = asked[q].weight;
    double front = 0, seen = 0, used = 0, angle = 0, share = 0;
    for (uint32_t r = 0; r < rays; ++r) {
      const size_t i = size_t{r} * unit.slots + q;
      if (what[r].primitive != shared::kMiss && scale[r] != shared::kSrpDark) ++front;
      const bool sees = asks[i].tMin <= asks[i].tMax && hidden[i] == 0;
      if (sees && what[r].primitive != shared::kMiss) {
        ++seen;
        if (kept[i] > 0) ++used, angle += static_cast<double>(kept[i] / f.distance);
      }
      if (kept[i] > 0 && scale[r] > 0) share += static_cast<double>(kept[i] * scale[r]);
    }
    f.visibility = front > 0 ? static_cast<float>(seen / front) : 0;
    f.blurred = front > 0 ? static_cast<float>((seen - used) / front) : 0;
    f.solidAngle = unit.solidAngle == 0 ? 1 : used > 0 ? static_cast<float>(angle / used) : 0;
    f.share = static_cast<float>(share / rays);
    out.push_back(f);
  }
  std::stable_sort(out.begin(), out.end(), [](const ProbeFactors& a, const ProbeFactors& b) { return a.share > b.share; });
  return out;
}

}  // namespace hl
