// How fast the radiosity bake casts its rays against the tracer alone on the very same rays, interleaved.
//
//   bench_bake_rays_bench [UNITS [STRIDE [RESOLUTION [SCENE [TRACER [buffers]]]]]]
//
// A first run of the bake keeps the rays of every STRIDE-th unit of the first bounce. The second run does each of those units as
// the bake runs it, and right before or after it, in changing order, the tracer alone casts that unit's rays: as a batch of any
// rays, and in the very packets that the bake casts (where it does). Wall-clock time and the process's own CPU time: what other
// processes take of the machine is in the first alone. With `buffers` the bake does its units in shaders, round batches of rays, even
// where the host casts them.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "engine/core/error.h"
#include "engine/lightmap/inside.h"
#include "engine/scene/scene_file.h"
#include "engine/techniques/technique.h"
#include "engine/trace/tracer.h"

namespace hl {
namespace {

struct Packet {
  RayPacket rays;
  size_t count = 0;
};

/// Casts with another tracer and remembers the last batch of closest hits, or the packets.
class WatchedTracer final : public Tracer {
 public:
  WatchedTracer(std::unique_ptr<Tracer> tracer, bool buffers) : tracer_(std::move(tracer)), buffers_(buffers) {}
  const char* id() const override { return tracer_->id(); }
  bool onHost() const override { return !buffers_ && tracer_->onHost(); }
  void record(FrameGraph& graph, const std::string& name, const Buffer& rays, const Buffer& out, uint32_t count, Query query) override {
    if (query == Query::Closest) lastRays = rays, lastCount = count;
    tracer_->record(graph, name, rays, out, count, query);
  }
  void closest(RayPacket& packet, size_t count) const override {
    if (keeping) {
      std::lock_guard lock(mutex_);
      packets_[std::this_thread::get_id()].push_back({packet, count});
    }
    tracer_->closest(packet, count);
  }
  /// Packets since the last call, those of each thread in their order.
  std::vector<Packet> takePackets() {
    std::vector<Packet> all;
    for (auto& [thread, list] : packets_) all.insert(all.end(), list.begin(), list.end());
    packets_.clear();
    return all;
  }

  Buffer lastRays;
  uint32_t lastCount = 0;
  bool keeping = false;

 private:
  std::unique_ptr<Tracer> tracer_;
  bool buffers_;
  mutable std::mutex mutex_;
  mutable std::map<std::thread::id, std::vector<Packet>> packets_;
};

std::vector<shared::Ray> raysOf(const std::vector<Packet>& packets) {
  std::vector<shared::Ray> rays;
  for (const auto& [p, count] : packets)
    for (size_t i = 0; i < count; ++i)
      rays.push_back({vec3(p.originX[i], p.originY[i], p.originZ[i]), p.tMin[i], vec3(p.directionX[i], p.directionY[i], p.directionZ[i]), p.tMax[i]});
  return rays;
}

double processMs() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto ms = [](const timeval& t) { return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec); };
  return ms(usage.ru_utime) + ms(usage.ru_stime);
}

double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double at = fraction * static_cast<double>(values.size() - 1);
  const auto low = static_cast<size_t>(at);
  const size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

void print(const std::string& what, const std::vector<double>& values) {
  printf("  %-38s median %8.3f   quartiles %8.3f %8.3f   5 and 95 %% %8.3f %8.3f\n", what.c_str(), quantile(values, 0.5), quantile(values, 0.25), quantile(values, 0.75),
         quantile(values, 0.05), quantile(values, 0.95));
}

/// One way of doing the units, each unit once.
class Series {
 public:
  void add(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    const double before = processMs();
    work();
    cpu_.push_back(processMs() - before);
    wall_.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  void print(const std::string& what, const std::vector<double>& rays) const {
    hl::print(what + ", wall [ms]", wall_), hl::print(what + ", CPU [ms]", cpu_);
    std::vector<double> rate;
    for (size_t i = 0; i < rays.size(); ++i) rate.push_back(1e-3 * rays[i] / cpu_[i]);
    hl::print(what + " [M rays / CPU s]", rate);
  }
  /// By unit, and of sums.
  void printRate(const std::string& what, const Series& other) const {
    for (const auto& [kind, mine, others] : {std::tuple(", wall", &wall_, &other.wall_), std::tuple(", CPU", &cpu_, &other.cpu_)}) {
      std::vector<double> ratio;
      for (size_t i = 0; i < mine->size(); ++i) ratio.push_back((*others)[i] / (*mine)[i]);
      hl::print(what + kind, ratio);
      printf("  %-38s %15.3f\n", "  of sums", std::accumulate(others->begin(), others->end(), 0.0) / std::accumulate(mine->begin(), mine->end(), 0.0));
    }
  }

 private:
  std::vector<double> wall_, cpu_;  ///< [ms]
};

void castPackets(const Tracer& tracer, TaskPool& pool, std::vector<Packet>& packets, std::vector<shared::Hit>& hits) {
  pool.parallelFor(packets.size(), 256, [&](size_t begin, size_t end, unsigned) {
    for (size_t k = begin; k < end; ++k) {
      RayPacket& p = packets[k].rays;
      tracer.closest(p, packets[k].count);
      for (size_t i = 0; i < packets[k].count; ++i) hits[k * kPacketRays + i] = {p.t[i], p.primitive[i], p.u[i], p.v[i]};
    }
  });
}

struct Unit {
  uint64_t number = 0;  ///< of the bake's units, in order
  std::vector<shared::Ray> rays;
  std::vector<Packet> packets;
};

void run(size_t wanted, uint64_t stride, int resolution, const std::string& sceneName, const std::string& tracerId, bool buffers) {
  const Scene scene = loadScene(sceneName);
  const SceneFeatures features = sceneFeatures(scene);
  Device device{DeviceOptions{}};
  ShaderLibrary shaders(device);
  TaskPool pool;
  Progress progress;
  const GpuScene gpuScene = uploadScene(device, scene);
  const auto embree = std::make_shared<EmbreeScene>(scene);
  WatchedTracer tracer(makeTracer(tracerId, device, shaders, scene, gpuScene, embree, pool), buffers);
  DirectLight directLight(device, shaders, gpuScene, tracer);
  LightmapParams lightmap;
  lightmap.resolution = resolution;
  DirectParams direct;
  direct.lumel_samples = 1;
  AtlasSettings settings;
  settings.resolution = lightmap.resolution;
  settings.uvOverlapTolerance = lightmap.uv_overlap_tolerance;
  settings.margin = lightmap.margin;
  const auto cast = [&](std::span<const shared::Ray> rays, std::span<shared::Hit> hits) { embree->closest(rays, hits); };
  const Atlas atlas = buildAtlas(scene, settings, pool, progress, insideTest(scene, pool, direct.ray_offset * gpuScene.diagonal, cast));
  const auto technique = techniqueInfo("radiosity").create();
  Gpu gpu{device, shaders};
  const SceneView view{scene, features, gpuScene, tracer, directLight, pool, &atlas, lightmap, direct, 1};
  FrameGraph graph(device, shaders), tracerGraph(device, shaders);

  /// One more unit of the bake.
  const auto unit = [&](BatchTimings* timings = nullptr) {
    technique->recordWork(graph);
    const BatchTimings t = graph.execute();
    if (timings != nullptr) *timings = t;
  };
  const auto start = [&] {
    technique->rebuild(gpu, view, progress);
    technique->reset();
    while (technique->work().label.starts_with("direct")) unit();
  };

  start();
  std::vector<Unit> kept;
  tracer.keeping = true;
  for (uint64_t n = 0; kept.size() < wanted && !technique->work().settled(); ++n) {
    tracer.lastCount = 0;
    unit();
    Unit u{n, std::vector<shared::Ray>(tracer.lastCount), tracer.takePackets()};
    if (tracer.lastCount == 0 && u.packets.empty()) break;  // the first bounce is over
    if (n % stride != 0) continue;
    if (tracer.lastCount > 0) device.download(tracer.lastRays, u.rays.data(), u.rays.size() * sizeof(shared::Ray));
    else u.rays = raysOf(u.packets);
    kept.push_back(std::move(u));
  }
  tracer.keeping = false;
  if (kept.empty()) throw badInput("the bake casts no rays");

  uint64_t capacity = 0;
  for (const Unit& u : kept) capacity = std::max({capacity, uint64_t{u.rays.size()}, u.packets.size() * kPacketRays});
  const Buffer rays = device.buffer("the same rays", capacity * sizeof(shared::Ray), TexelFormat::RGBA32F);
  const Buffer hits = device.buffer("their hits", capacity * sizeof(shared::Hit));
  std::vector<shared::Hit> packetHits(capacity);
  const bool packets = !kept[0].packets.empty();
  Series bake, batches, together;
  std::vector<double> count;
  std::map<std::string, std::vector<double>> passes;
  std::vector<std::string> order;
  start();
  uint64_t number = 0;
  for (size_t k = 0; k < kept.size(); ++k) {
    Unit& u = kept[k];
    for (; number < u.number; ++number) unit();
    const auto n = static_cast<uint32_t>(u.rays.size());
    device.upload(rays, u.rays.data(), n * sizeof(shared::Ray));
    BatchTimings batch;
    const std::function<void()> runs[] = {[&] { bake.add([&] { unit(&batch); }); },
                                          [&] {
                                            batches.add([&] {
                                              static_cast<Tracer&>(tracer).record(tracerGraph, "the same rays", rays, hits, n, Query::Closest);
                                              tracerGraph.execute();
                                            });
                                          },
                                          [&] {
                                            if (packets) together.add([&] { castPackets(tracer, pool, u.packets, packetHits); });
                                          }};
    for (size_t i = 0; i < 3; ++i) runs[(i + k) % 3]();
    ++number;
    count.push_back(n);
    for (const PassTiming& pass : batch.passes) {
      if (!pass.skipped.empty()) continue;
      if (passes.find(pass.name) == passes.end()) order.push_back(pass.name);
      passes[pass.name].push_back(pass.ms);
    }
    passes["between passes"].push_back(batch.wallMs * batch.unaccounted());
  }
  order.push_back("between passes");
  printf("%s, %d x %d, tracer %s: %zu units of %.0f rays, spread over %llu\n", sceneName.c_str(), resolution, resolution, tracer.id(), kept.size(), count[0],
         static_cast<unsigned long long>(kept.back().number + 1));
  bake.print("bake", count);
  batches.print("tracer, batch", count);
  bake.printRate("bake's rate / tracer's, batch", batches);
  if (packets) together.print("tracer, packets", count), bake.printRate("bake's rate / tracer's, packets", together);
  for (const std::string& name : order) print(name + " [ms]", passes[name]);
}

}  // namespace
}  // namespace hl

int main(int argc, char** argv) {
  try {
    const auto number = [&](int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; };
    const auto text = [&](int i, const char* otherwise) { return argc > i ? argv[i] : otherwise; };
    hl::run(static_cast<size_t>(number(1, 60)), static_cast<uint64_t>(std::max(1, number(2, 4))), number(3, 512), text(4, "sponza"), text(5, "embree"), argc > 6);
  } catch (const std::exception& e) {
    fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
