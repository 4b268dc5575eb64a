// What it takes to bring a tracer to where objects are now, against making it anew, and how fast each then casts rays. Interleaved, wall-clock medians.
//
//   bench_moving_tracers_bench [SCENE [OBJECT [UPDATES]]]      default: cornell_spin as it is; atrium "blue banner" has swing what is named so
//
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "engine/core/error.h"
#include "engine/passes/pose.h"
#include "engine/scene/scene_build.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_pose.h"
#include "engine/trace/tracer.h"
#include "shaders/shared/random.h"

namespace hl {
namespace {

constexpr uint32_t kRays = 1u << 16;

double milliseconds(const std::function<void()>& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

void swing(Scene& scene, const std::string& name) {
  ObjectAnimation a;
  for (uint32_t i = 0; i < scene.objects.size(); ++i)
    if (scene.objects[i].starts_with(name)) a.objects.push_back(i);
  if (a.objects.empty()) throw badInput("there is no object '" + name + "'");
  a.name = "swing", a.axis = vec3(1, 0, 0), a.pivot = (scene.bounds.min + scene.bounds.max) * 0.5f;
  a.keys = {{0, vec3(0), 0, vec3(1)}, {4, vec3(0), 2 * kPi, vec3(1)}};
  scene.animations = {a};
  finishScene(scene);
}

std::vector<shared::Ray> raysThrough(const Scene& scene) {
  shared::Random r = shared::randomInit(11, 5, 2);
  const auto random = [&] { return shared::randomFloat(r); };
  std::vector<shared::Ray> rays;
  const vec3 size = scene.bounds.max - scene.bounds.min;
  while (rays.size() < kRays) {
    const vec3 from = scene.bounds.min + size * vec3(random(), random(), random()), to = scene.bounds.min + size * vec3(random(), random(), random());
    if (glm::length(to - from) > 0) rays.push_back({from, 0, to - from, 2});
  }
  return rays;
}

void run(const std::string& name, const std::string& object, int updates) {
  Scene scene = loadScene(name);
  if (!object.empty()) swing(scene, object);
  const std::vector<bool> moves = movingTriangles(scene);
  std::printf("%s: %zu triangles, %td of them move\n", name.c_str(), scene.triangles(), std::count(moves.begin(), moves.end(), true));
  Device device{DeviceOptions{}};
  ShaderLibrary shaders(device);
  FrameGraph graph(device, shaders);
  TaskPool pool;
  ScenePose pose(scene);
  GpuScene gpuScene = uploadScene(device, scene);
  const std::vector<shared::Ray> rays = raysThrough(scene);
  const Buffer in = device.buffer("rays", std::span<const shared::Ray>(rays)), hits = device.buffer("hits", kRays * sizeof(shared::Hit));
  const auto cast = [&](Tracer& tracer) {
    return milliseconds([&] {
      tracer.record(graph, "cast", in, hits, kRays, Query::Closest);
      graph.execute();
    });
  };
  for (const TracerListing& listed : listTracers(device)) {
    if (!listed.available) continue;
    const auto moved = makeTracer(listed.id, device, shaders, scene, gpuScene, nullptr, pool);
    std::vector<double> update, make, castMoved, castMade;
    double worst = 0;
    for (int i = 0; i <= updates; ++i) {
      if (pose.apply(scene, 0.05 + 0.037 * i).geometry) {
        updateTransforms(device, gpuScene, pose.transforms());
        recordPose(graph, gpuScene);
        graph.execute();
      }
      const double u = milliseconds([&] {
        moved->recordUpdate(graph);
        graph.execute();
      });
      std::unique_ptr<Tracer> made;
      const double m = milliseconds([&] { made = makeTracer(listed.id, device, shaders, scene, gpuScene, nullptr, pool); });
      const double a = cast(*moved), b = cast(*made);
      if (i == 0) continue;  // pipelines are made with the first
      update.push_back(u), make.push_back(m), castMoved.push_back(a), castMade.push_back(b);
      worst = std::max(worst, u);
    }
    std::printf("%-9s update %.3f ms (worst %.3f), anew %.2f ms; %u rays %.2f ms after updates, %.2f ms anew\n", listed.id.c_str(), median(update), worst, median(make), kRays,
                median(castMoved), median(castMade));
  }
}

}  // namespace
}  // namespace hl

int main(int argc, char** argv) {
  try {
    hl::run(argc > 1 ? argv[1] : "cornell_spin", argc > 2 ? argv[2] : "", argc > 3 ? std::max(1, std::atoi(argv[3])) : 40);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "moving_tracers_bench: %s\n", e.what());
    return 1;
  }
  return 0;
}
