// Probes from the empty voxels next to surfaces, as few as see the rest of them (after Silvennoinen and Lehtinen 2017, section on probe placement).
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <queue>

#include "engine/placement/free_space.h"
#include "engine/placement/strategies.h"
#include "engine/placement/voxels.h"

namespace hl {
namespace {

/// Pairs of candidates within the merge radius that are looked at: each is a ray, and 8 bytes.
constexpr uint64_t kMostPairs = uint64_t{1} << 26;
constexpr size_t kGrain = 64;

/// Of each candidate those others within `radius` that it sees, by number; itself included.
std::vector<std::vector<uint32_t>> seenBy(const PlacementTask& task, const VoxelSpace& s, const std::vector<vec3>& places, const std::vector<uint32_t>& candidateOf, float radius) {
  std::vector<std::vector<uint32_t>> out(places.size());
  const int reach = static_cast<int>(radius / s.side);
  std::atomic<uint64_t> pairs{0};
  task.pool.parallelFor(places.size(), kGrain, [&](size_t begin, size_t end, unsigned) {
    for (size_t i = begin; i < end; ++i) {
      task.progress.check();
      const ivec3 v = s.voxelOf(places[i]);
      for (int z = -reach; z <= reach; ++z)
        for (int y = -reach; y <= reach; ++y)
          for (int x = -reach; x <= reach; ++x) {
            const ivec3 w = v + ivec3(x, y, z);
            if (!s.contains(w)) continue;
            const uint32_t k = candidateOf[s.index(w)];
            if (k == kNone || k <= i || glm::length(places[k] - places[i]) > radius) continue;
            if (++pairs > kMostPairs) throw Error(ErrorKind::TooLarge, "probes: too many voxels see each other; raise probes.voxel, or lower probes.merge_radius");
            if (!task.embree.occluded({places[i], 0, places[k] - places[i], 1})) out[i].push_back(k);
          }
    }
  });
  const std::vector<std::vector<uint32_t>> forward = out;
  for (uint32_t i = 0; i < out.size(); ++i) {
    for (const uint32_t k : forward[i]) out[k].push_back(i);
    out[i].push_back(i);
  }
  return out;
}

}  // namespace

void placeVoxelGreedy(const PlacementTask& task, PlacedProbes& out) {
  const VoxelSpace s = voxelise(task.embree.scene(), task.bounds, task.params.voxel * task.longest, task.pool, task.progress);
  const std::vector<bool> open = openSpaces(task, s);
  std::vector<vec3> places;
  for (size_t i = 0; i < s.space.size(); ++i) {
    if (s.space[i] == kSurfaceVoxel || !s.nextToSurface(s.at(i))) continue;
    if (open[s.space[i]])
      places.push_back(s.centre(s.at(i)));
    else
      ++out.candidates, ++out.rejectedInside;
  }
  keepFree(task, places, out);
  const std::vector<vec3> kept = std::move(out.positions);
  out.positions.clear();
  std::vector<uint32_t> candidateOf(s.space.size(), kNone);
  for (uint32_t k = 0; k < kept.size(); ++k) candidateOf[s.index(s.voxelOf(kept[k]))] = k;  // of two in one voxel the later stands for both
  const auto seen = seenBy(task, s, kept, candidateOf, task.params.merge_radius * task.longest);

  // Again and again the candidate that stands for most of those that nobody stands for yet; of equals the first.
  struct Offer {
    uint64_t gain;
    uint32_t candidate;
    bool operator<(const Offer& o) const { return gain != o.gain ? gain < o.gain : candidate > o.candidate; }
  };
  std::priority_queue<Offer> queue;
  for (uint32_t k = 0; k < kept.size(); ++k) queue.push({seen[k].size(), k});
  std::vector<uint8_t> served(kept.size(), 0);
  std::vector<uint32_t> chosen;
  for (size_t left = kept.size(); left > 0;) {
    const Offer offer = queue.top();
    queue.pop();
    const auto gain = static_cast<uint64_t>(std::count_if(seen[offer.candidate].begin(), seen[offer.candidate].end(), [&](uint32_t k) { return !served[k]; }));
    if (gain == 0) continue;
    if (gain < offer.gain) {  // gains only ever fall: what is still the largest is the one
      queue.push({gain, offer.candidate});
      continue;
    }
    for (const uint32_t k : seen[offer.candidate])
      if (!served[k]) served[k] = 1, --left;
    chosen.push_back(offer.candidate);
    if (chosen.size() > kMostPlacedProbes)
      throw Error(ErrorKind::TooLarge, fmt::format("probes: more than {} are left; raise probes.merge_radius or probes.voxel", kMostPlacedProbes));
  }
  std::sort(chosen.begin(), chosen.end());
  for (const uint32_t k : chosen) out.positions.push_back(kept[k]);
  out.merged = kept.size() - chosen.size();
}

}  // namespace hl
