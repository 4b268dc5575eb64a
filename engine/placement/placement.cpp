#include "engine/placement/placement.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "engine/placement/coverage.h"
#include "engine/placement/free_space.h"
#include "engine/placement/strategies.h"

namespace hl {
namespace {

/// How far from a surface the rays that look for it end, as a share of the scene's diagonal.
constexpr float kSeenOffset = 1e-5f;
constexpr size_t kMostNamed = 4;  ///< manual probes inside geometry that a warning names

}  // namespace

void keepFree(const PlacementTask& task, const std::vector<vec3>& places, PlacedProbes& out) {
  out.candidates += places.size();
  // Cleared first: a place in a wall's plane is judged where it would stand.
  std::vector<Cleared> cleared(places.size());
  task.pool.parallelFor(places.size(), 64, [&](size_t begin, size_t end, unsigned) {
    for (size_t i = begin; i < end; ++i) cleared[i] = clearOfSurfaces(task.embree, places[i], task.params.surface_distance * task.longest);
    task.progress.check();
  });
  std::vector<vec3> there(places.size());
  for (size_t i = 0; i < places.size(); ++i) there[i] = cleared[i].position;
  const std::vector<Surroundings> seen = lookAround(task.embree, there, task.pool, task.progress);
  for (size_t i = 0; i < places.size(); ++i) {
    if (seen[i].backs >= task.params.inside_threshold) {
      ++out.rejectedInside;
    } else if (!cleared[i].clear) {
      ++out.rejectedNear;
    } else {
      out.moved += cleared[i].moved;
      out.positions.push_back(there[i]);
    }
  }
  if (out.positions.empty())
    throw badInput(fmt::format("probes: of {} places {} are inside geometry and {} too near to surfaces, so that no probe is left; other counts, a smaller "
                               "probes.surface_distance or another probes.placement may find some",
                               places.size(), out.rejectedInside, out.rejectedNear));
}

void takeManual(const PlacementTask& task, PlacedProbes& out) {
  const Scene& scene = task.embree.scene();
  if (scene.probes.empty())
    throw badInput(fmt::format("probes.placement manual: the scene '{}' has no probes of its own; add some (\"probes\": [[x, y, z], ...] in its file, or by hand), "
                               "or let probes.placement be grid",
                               scene.name));
  if (scene.probes.size() > kMostPlacedProbes)
    throw Error(ErrorKind::TooLarge, fmt::format("probes: the scene '{}' has {} of its own; {} is the most", scene.name, scene.probes.size(), kMostPlacedProbes));
  out.positions = scene.probes;
  out.candidates = scene.probes.size();
  const std::vector<Surroundings> seen = lookAround(task.embree, out.positions, task.pool, task.progress);
  out.inside.assign(out.positions.size(), 0);
  std::string named;
  for (size_t i = 0; i < seen.size(); ++i) {
    if (seen[i].backs < task.params.inside_threshold) continue;
    out.inside[i] = 1;
    if (++out.insideGeometry <= kMostNamed) {
      const vec3 at = out.positions[i] + scene.report.recentred;
      named += fmt::format("{}{} at ({:.4g}, {:.4g}, {:.4g})", named.empty() ? "" : ", ", i + 1, at.x, at.y, at.z);
    }
  }
  if (out.insideGeometry > 0)
    out.warnings.push_back(fmt::format("probes: {} of {} manual ones {} inside geometry: number {}{}", out.insideGeometry, out.positions.size(),
                                       out.insideGeometry == 1 ? "stands" : "stand", named, out.insideGeometry > kMostNamed ? ", ..." : ""));
}

PlacedProbes placeProbes(const ProbesParams& params, const Scene& scene, const EmbreeScene& embree, TaskPool& pool, Progress& progress) {
  const auto began = std::chrono::steady_clock::now();
  PlacedProbes out;
  const vec3 side = scene.bounds.empty() ? vec3(0.0f) : scene.bounds.max - scene.bounds.min;
  const PlacementTask task{params, embree, pool, progress, scene.bounds, std::max({side.x, side.y, side.z})};
  if (scene.triangles() == 0 || !(task.longest > 0)) return out;
  progress.begin("placing probes", 1);
  switch (params.placement) {
    case kPlacementManual: takeManual(task, out); break;
    case kPlacementVoxelGreedy: placeVoxelGreedy(task, out); break;
    default: placeGrid(task, out);
  }
  out.inside.resize(out.positions.size(), 0);
  progress.begin("measuring what probes see", 1);
  out.coverage = coverageOf(embree, out.positions, sampleSurfaces(scene, static_cast<uint32_t>(params.coverage_samples)), kSeenOffset * scene.bounds.diagonal(), pool,
                            progress);
  progress.check();
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return out;
}

}  // namespace hl
