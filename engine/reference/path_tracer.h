#pragma once
// Single random samples of the light that reaches a receiver: the estimators of the reference, without its bookkeeping.
#include <array>
#include <memory>

#include "engine/reference/emitters.h"
#include "engine/reference/path_sampler.h"
#include "engine/reference/reference.h"
#include "engine/reference/surface.h"
#include "engine/scene/environment.h"

namespace hl {

/// Rays start this far in front of the surface, as a share of the scene's extent (the larger of its diagonal and its largest coordinate): more than a
/// hit point is off through rounding, less than anything that could be modelled.
inline constexpr float kHitRayOffset = 1e-6f;
/// The same for receivers that a rasteriser interpolated.
inline constexpr float kReceiverRayOffset = 4e-6f;

/// A point that light arrives at.
struct ShadingPoint {
  vec3 origin{0.0f};           ///< where its rays start
  vec3 normal{0.0f};           ///< that incoming light is weighed with
  vec3 geometricNormal{0.0f};  ///< light from below it does not arrive
};

/// Irradiance of one path by bounce, as in ReferenceResult.
using BounceSample = std::array<vec3, kBounceBuckets>;

struct PathCounters {
  uint64_t backFaceHits = 0, nonFinite = 0, paths = 0, rays = 0;
};

class PathTracer {
 public:
  PathTracer(const EmbreeScene&, const ReferenceSettings&);

  /// False where the receiver gets nothing by definition: no surface, or a side that does not count.
  bool receives(const Receiver&) const;
  ShadingPoint shadingPoint(const Receiver&) const;

  /// One path's estimate of indirect irradiance, added to `sum`. `sampler` has begun its sample.
  void indirect(const ShadingPoint&, PathSampler& sampler, BounceSample& sum, PathCounters&) const;
  /// The same of the radiance that a glossy receiver's lobe reflects towards the camera; all bounces before are diffuse.
  void specular(const Receiver&, PathSampler& sampler, BounceSample& sum, PathCounters&) const;
  /// Irradiance from punctual lights, without noise.
  vec3 punctual(const ShadingPoint&, PathCounters&) const;
  /// One estimate of direct irradiance from emissive surfaces, sky and environment map.
  vec3 extended(const ShadingPoint&, PathSampler& sampler, PathCounters&) const;
  /// The two for what the lobe of a glossy receiver reflects of such light towards the camera, as radiance.
  vec3 punctualSpecular(const Receiver&, PathCounters&) const;
  vec3 extendedSpecular(const Receiver&, PathSampler& sampler, PathCounters&) const;
  /// Whether `extended` is more than 0 anywhere.
  bool hasExtendedLight() const { return !emitters_.empty() || scene_.sky != vec3(0.0f) || environment_.shines(); }

 private:
  struct Lamp {
    vec3 position{0.0f}, direction{0.0f}, intensity{0.0f};
    float cosInner = -2, cosOuter = -2;
    bool directional = false;
  };
  /// What a point makes of light from a direction: irradiance, or radiance by a lobe.
  class Response {
   public:
    explicit Response(const ShadingPoint& p) : p_(&p) {}
    Response(const ShadingPoint& p, const Receiver& r) : p_(&p), lobe_(&r), view_(shared::toLocal(r.view, p.normal)) {}
    /// Of irradiance. Unit direction.
    vec3 reflect(vec3 irradiance, vec3 direction) const;
    /// Density of the direction that continues a path.
    float pdf(vec3 direction) const;

   private:
    const ShadingPoint* p_;
    const Receiver* lobe_ = nullptr;
    vec3 view_{0.0f};
  };
  vec3 fromLamps(const ShadingPoint&, const Response&, PathCounters&) const;
  vec3 sampledEmitter(const ShadingPoint&, const Response&, const EmitterChoice&, vec2 pointU, float choiceU, PathCounters&) const;
  /// Radiance that the hit triangle sends back along the ray, weighed against light sampling.
  vec3 foundEmission(const ShadingPoint& from, const Response&, const EmitterChoice&, const shared::Hit&, vec3 direction) const;

  /// By one direction that the environment map chose, weighed against chance finds.
  vec3 sampledEnvironment(const ShadingPoint&, const Response&, vec2 u, PathCounters&) const;
  /// Radiance of sky and map where a ray that the response chose hits nothing; the map's weighed against sampling it.
  vec3 foundSky(const Response&, vec3 direction) const;

  /// One sample of extended lights, and of `weight` times what shines along a ray that the response chose.
  vec3 fromExtended(const ShadingPoint&, const Response&, vec3 direction, vec3 weight, PathSampler&, PathCounters&) const;
  /// What surfaces along the path that begins with this ray reflect, times `throughput`, by bounce.
  void follow(vec3 origin, vec3 direction, vec3 throughput, PathSampler&, BounceSample& sum, PathCounters&) const;

  const EmbreeScene& embree_;
  const Scene& scene_;
  Emitters emitters_;
  EnvironmentLight environment_;
  std::vector<Lamp> lamps_;
  bool frontFacesOnly_, mappedReceiver_, mappedBounces_;
  int maxBounces_;
  float hitOffset_ = 0, receiverOffset_ = 0;
};

}  // namespace hl
