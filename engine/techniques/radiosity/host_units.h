#pragma once
// A unit's two steps where the host casts rays and is the device too. What rays hit: they are made, cast and looked up sixteen at a time, so that
// no ray or hit goes through memory. And the sum over what they hit, as in gather.comp.
#include <span>
#include <vector>

#include "engine/core/task_pool.h"
#include "engine/techniques/radiosity/params.h"
#include "engine/techniques/radiosity/unit.h"
#include "engine/trace/tracer.h"
#include "shaders/shared/surface_point.h"

namespace hl {

class HostUnits {
 public:
  /// `triangles` and `lumelOfTexel` as in LightmapTables; `directions` as the shaders read them. The tracer and the pool must outlive this.
  HostUnits(const Tracer&, TaskPool&, const RadiosityParams&, std::span<const vec4> triangles, std::vector<uint32_t> lumelOfTexel,
           std::span<const vec4> directions);

  void setPoints(std::vector<shared::SurfacePoint> points) { points_ = std::move(points); }

  /// Writes the unit's codes, from unit.codeBase on.
  void cast(const shared::RadiosityUnit&, std::span<uint32_t> codes) const;
  /// From codes to irradiance. `counters`: those of unit.h.
  void gather(const shared::RadiosityUnit&, std::span<const uint32_t> codes, std::span<const vec4> radiance, std::span<vec4> irradiance,
              std::span<uint32_t> counters) const;
  /// One lumel's rays, hits and codes, as many as samples.
  void inspect(const shared::RadiosityUnit&, std::span<shared::Ray>, std::span<shared::Hit>, std::span<uint32_t> codes) const;

  uint64_t bytes() const;

 private:
  /// The two entries of LightmapTables::triangles. Together in a cache line.
  struct alignas(32) Triangle {
    vec4 first, second;
  };
  struct Counts {
    uint64_t backFaces = 0, withoutTexel = 0, nonFinite = 0;
  };
  template <class Visit>
  void castLumel(uint32_t lumel, const shared::RadiosityUnit&, uint32_t* codes, const Visit&) const;
  void findTexels(const RayPacket&, uint32_t resolution, std::span<uint32_t> codes) const;
  vec3 gatherLumel(const uint32_t* codes, std::span<const vec4> radiance, Counts&) const;

  const Tracer& tracer_;
  TaskPool& pool_;
  uint32_t samples_;
  bool turns_;
  std::vector<Triangle> triangles_;
  std::vector<uint32_t> lumelOfTexel_;
  std::vector<shared::SurfacePoint> points_;
  std::vector<float> x_, y_, weights_;  ///< of the set of directions, filled up to whole packets
};

}  // namespace hl
