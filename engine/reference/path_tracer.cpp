#include "engine/reference/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shaders/shared/ggx.h"

namespace hl {
namespace {

using shared::Hit;
using shared::Ray;

// How much of the way to a light a shadow ray leaves out, so that the light's own surface does not shadow it.
constexpr float kShadowGap = 1e-5f;
constexpr float kFar = std::numeric_limits<float>::infinity();

bool finite(vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

float largest(vec3 v) { return std::max(v.x, std::max(v.y, v.z)); }

Ray rayFrom(vec3 origin, vec3 direction, float tMax = kFar) { return Ray{origin, 0.0f, direction, tMax}; }

bool above(const ShadingPoint& p, vec3 direction) {
  return glm::dot(p.normal, direction) > 0 && glm::dot(p.geometricNormal, direction) > 0;
}

}  // namespace

vec3 PathTracer::Response::reflect(vec3 irradiance, vec3 direction) const {
  return lobe_ ? irradiance * shared::ggxBrdf(view_, shared::toLocal(direction, p_->normal), lobe_->specular, lobe_->roughness) : irradiance;
}

float PathTracer::Response::pdf(vec3 direction) const {
  return lobe_ ? shared::ggxPdf(view_, shared::toLocal(direction, p_->normal), lobe_->roughness) : std::max(0.0f, glm::dot(p_->normal, direction)) / kPi;
}

PathTracer::PathTracer(const EmbreeScene& embree, const ReferenceSettings& settings)
    : embree_(embree),
      scene_(embree.scene()),
      emitters_(scene_),
      environment_(scene_.environment),
      frontFacesOnly_(settings.frontFacesOnly),
      mappedReceiver_(settings.receiver != ReceiverNormal::Geometric),
      mappedBounces_(settings.receiver == ReceiverNormal::Mapped),
      maxBounces_(settings.maxBounces) {
  Bounds bounds;
  for (const uvec3& t : scene_.indices)
    for (const uint32_t v : {t.x, t.y, t.z}) bounds.extend(scene_.positions[v]);
  if (!bounds.empty()) {
    const float extent =
        std::max(bounds.diagonal(), largest(glm::max(glm::abs(bounds.min), glm::abs(bounds.max))));
    hitOffset_ = kHitRayOffset * extent;
    receiverOffset_ = kReceiverRayOffset * extent;
  }
  for (const PointLight& l : scene_.pointLights) {
    Lamp lamp;
    lamp.position = l.position, lamp.intensity = l.intensity;
    lamps_.push_back(lamp);
  }
  for (const SpotLight& l : scene_.spotLights) {
    Lamp lamp;
    lamp.position = l.position, lamp.direction = glm::normalize(l.direction), lamp.intensity = l.intensity;
    lamp.cosInner = std::cos(l.innerAngle), lamp.cosOuter = std::cos(l.outerAngle);
    lamps_.push_back(lamp);
  }
  for (const DirectionalLight& l : scene_.directionalLights) {
    Lamp lamp;
    lamp.direction = glm::normalize(l.direction), lamp.intensity = l.irradiance;
    lamp.directional = true;
    lamps_.push_back(lamp);
  }
}

bool PathTracer::receives(const Receiver& r) const {
  if (r.geometricNormal == vec3(0.0f)) return false;
  return !r.backFace || (r.twoSided && !frontFacesOnly_);
}

ShadingPoint PathTracer::shadingPoint(const Receiver& r) const {
  ShadingPoint p;
  p.geometricNormal = r.geometricNormal;
  p.normal = mappedReceiver_ ? r.mappedNormal : r.geometricNormal;
  p.origin = r.position + r.geometricNormal * receiverOffset_;
  return p;
}

vec3 PathTracer::punctual(const ShadingPoint& p, PathCounters& counters) const { return fromLamps(p, Response(p), counters); }

vec3 PathTracer::punctualSpecular(const Receiver& receiver, PathCounters& counters) const {
  const ShadingPoint p = shadingPoint(receiver);
  return fromLamps(p, Response(p, receiver), counters);
}

vec3 PathTracer::fromLamps(const ShadingPoint& p, const Response& response, PathCounters& counters) const {
  vec3 sum(0.0f);
  for (const Lamp& lamp : lamps_) {
    vec3 to = -lamp.direction;
    float distance = kFar, falloff = 1;
    if (!lamp.directional) {
      to = lamp.position - p.origin;
      distance = glm::length(to);
      to /= distance;
      falloff = 1 / (distance * distance);
      if (lamp.cosOuter > -2)
        falloff *= shared::spotFalloff(-glm::dot(to, lamp.direction), lamp.cosInner, lamp.cosOuter);
    }
    if (!above(p, to) || falloff == 0) continue;
    const vec3 e = response.reflect(lamp.intensity * (falloff * glm::dot(p.normal, to)), to);
    if (!finite(e)) {
      ++counters.nonFinite;
      continue;
    }
    ++counters.rays;
    if (!embree_.occluded(rayFrom(p.origin, to, distance * (1 - kShadowGap)))) sum += e;
  }
  return sum;
}

vec3 PathTracer::sampledEmitter(const ShadingPoint& p, const Response& response, const EmitterChoice& choice, vec2 pointU, float choiceU,
                                PathCounters& counters) const {
  const uint32_t i = emitters_.choose(choice, choiceU);
  if (i == kNone) return vec3(0.0f);
  const Emitter& e = emitters_[i];
  if (glm::dot(p.origin - e.p0, e.normal) <= 0) return vec3(0.0f);
  const shared::TriangleSample s = shared::sampleTriangleLight(p.origin, e.p0, e.p1, e.p2, pointU);
  if (!(s.pdf > 0) || !above(p, s.direction)) return vec3(0.0f);
  const float pdf = emitters_.probability(choice, i) * s.pdf;
  const float cosine = glm::dot(p.normal, s.direction);
  ++counters.rays;
  if (embree_.occluded(rayFrom(p.origin, s.direction, s.distance * (1 - kShadowGap) - hitOffset_))) return vec3(0.0f);
  return response.reflect(e.emission * (cosine / pdf * shared::powerHeuristic(pdf, response.pdf(s.direction))), s.direction);
}

vec3 PathTracer::foundEmission(const ShadingPoint& from, const Response& response, const EmitterChoice& choice, const Hit& hit,
                               vec3 direction) const {
  const uint32_t i = emitters_.ofTriangle(hit.primitive);
  if (i == kNone) return vec3(0.0f);
  const Emitter& e = emitters_[i];
  if (glm::dot(direction, e.normal) >= 0) return vec3(0.0f);
  float lightPdf = emitters_.probability(choice, i);
  if (lightPdf > 0)
    lightPdf *= shared::triangleLightPdf(from.origin, e.p0, e.p1, e.p2, direction, hit.t);
  return e.emission * shared::powerHeuristic(response.pdf(direction), lightPdf);
}

vec3 PathTracer::sampledEnvironment(const ShadingPoint& p, const Response& response, vec2 u, PathCounters& counters) const {
  const EnvironmentSample s = environment_.sample(u);
  if (!(s.pdf > 0) || !above(p, s.direction)) return vec3(0.0f);
  const float cosine = glm::dot(p.normal, s.direction);
  ++counters.rays;
  if (embree_.occluded(rayFrom(p.origin, s.direction))) return vec3(0.0f);
  return response.reflect(s.radiance * (cosine / s.pdf * shared::powerHeuristic(s.pdf, response.pdf(s.direction))), s.direction);
}

vec3 PathTracer::foundSky(const Response& response, vec3 direction) const {
  if (!environment_.shines()) return scene_.sky;
  const vec3 seen = environment_.radiance(direction);
  return scene_.sky + seen * shared::powerHeuristic(response.pdf(direction), environment_.pdf(seen));
}

vec3 PathTracer::extended(const ShadingPoint& p, PathSampler& sampler, PathCounters& counters) const {
  const vec3 direction = shared::fromLocal(
      shared::sampleCosineHemisphere(sampler.next(0, SamplePurpose::Direction)), p.normal);
  return fromExtended(p, Response(p), direction, vec3(kPi), sampler, counters);
}

vec3 PathTracer::extendedSpecular(const Receiver& receiver, PathSampler& sampler, PathCounters& counters) const {
  const ShadingPoint p = shadingPoint(receiver);
  const shared::GgxSample s = shared::sampleGgx(shared::toLocal(receiver.view, p.normal), receiver.specular, receiver.roughness, sampler.next(0, SamplePurpose::Direction));
  return fromExtended(p, Response(p, receiver), shared::fromLocal(s.light, p.normal), s.weight, sampler, counters);
}

vec3 PathTracer::fromExtended(const ShadingPoint& p, const Response& response, vec3 direction, vec3 weight, PathSampler& sampler, PathCounters& counters) const {
  const EmitterChoice choice = emitters_.weigh(p.origin, p.normal);
  vec3 sum(0.0f);
  if (emitters_.any())
    sum += sampledEmitter(p, response, choice, sampler.next(0, SamplePurpose::LightPoint), sampler.next(0, SamplePurpose::Choices).x,
                          counters);
  if (environment_.shines()) sum += sampledEnvironment(p, response, sampler.next(0, SamplePurpose::Environment), counters);
  if (largest(weight) > 0 && above(p, direction)) {
    ++counters.rays;
    const Hit hit = embree_.closest(rayFrom(p.origin, direction));
    sum += weight * (hit.primitive == shared::kMiss ? foundSky(response, direction) : foundEmission(p, response, choice, hit, direction));
  }
  if (finite(sum)) return sum;
  ++counters.nonFinite;
  return vec3(0.0f);
}

void PathTracer::indirect(const ShadingPoint& receiver, PathSampler& sampler, BounceSample& sum,
                          PathCounters& counters) const {
  ++counters.paths;
  if (maxBounces_ <= 0) return;
  const vec3 direction = shared::fromLocal(
      shared::sampleCosineHemisphere(sampler.next(0, SamplePurpose::Direction)), receiver.normal);
  if (!above(receiver, direction)) return;
  follow(receiver.origin, direction, vec3(kPi), sampler, sum, counters);  // pi: of radiance, towards irradiance
}

void PathTracer::specular(const Receiver& receiver, PathSampler& sampler, BounceSample& sum, PathCounters& counters) const {
  ++counters.paths;
  if (maxBounces_ <= 0) return;
  const ShadingPoint p = shadingPoint(receiver);
  const shared::GgxSample s = shared::sampleGgx(shared::toLocal(receiver.view, p.normal), receiver.specular, receiver.roughness, sampler.next(0, SamplePurpose::Direction));
  if (!(largest(s.weight) > 0)) return;
  const vec3 direction = shared::fromLocal(s.light, p.normal);
  if (!above(p, direction)) return;
  follow(p.origin, direction, s.weight, sampler, sum, counters);
}

void PathTracer::follow(vec3 origin, vec3 direction, vec3 throughput, PathSampler& sampler, BounceSample& sum, PathCounters& counters) const {
  const auto add = [&](size_t bucket, vec3 value) {
    if (finite(value))
      sum[bucket] += value;
    else
      ++counters.nonFinite;
  };
  ++counters.rays;
  Hit hit = embree_.closest(rayFrom(origin, direction));
  for (int bounce = 0; hit.primitive != shared::kMiss; ++bounce) {
    const Surface y = surfaceAt(scene_, hit, direction, mappedBounces_);
    if (y.backFace && (!y.twoSided || frontFacesOnly_)) {
      ++counters.backFaceHits;
      return;
    }
    throughput *= y.albedo;
    if (!(largest(throughput) > 0)) return;
    const size_t bucket = static_cast<size_t>(std::min(bounce, kBounceBuckets - 1));
    const uint32_t dimension = static_cast<uint32_t>(bounce) + 1;
    const ShadingPoint p{y.position + y.geometricNormal * hitOffset_, y.normal, y.geometricNormal};
    const Response diffuse(p);

    // Light that reaches y without a further bounce.
    const vec2 choices = sampler.next(dimension, SamplePurpose::Choices);
    if (!lamps_.empty()) add(bucket, throughput * punctual(p, counters) / kPi);
    const EmitterChoice choice = emitters_.weigh(p.origin, p.normal);
    if (emitters_.any()) {
      const vec2 u = sampler.next(dimension, SamplePurpose::LightPoint);
      add(bucket, throughput * sampledEmitter(p, diffuse, choice, u, choices.x, counters) / kPi);
    }

    if (environment_.shines()) add(bucket, throughput * sampledEnvironment(p, diffuse, sampler.next(dimension, SamplePurpose::Environment), counters) / kPi);

    const bool last = bounce + 1 >= maxBounces_;
    if (last && !hasExtendedLight()) return;
    // Up to the last bucket of its own no path ends by chance, so that no bucket pays for another's speed.
    if (bounce + 1 >= kBounceBuckets && !last) {
      const float survival = std::min(largest(y.albedo), kMaxAlbedo);
      if (choices.y >= survival) return;
      throughput /= survival;
    }
    direction = shared::fromLocal(
        shared::sampleCosineHemisphere(sampler.next(dimension, SamplePurpose::Direction)), p.normal);
    if (!above(p, direction)) return;
    ++counters.rays;
    hit = embree_.closest(rayFrom(p.origin, direction));
    // Emission that this ray finds, and the sky where it finds nothing, are direct light at y too.
    if (hit.primitive == shared::kMiss) {
      add(bucket, throughput * foundSky(diffuse, direction));
      return;
    }
    if (!emitters_.empty()) add(bucket, throughput * foundEmission(p, diffuse, choice, hit, direction));
    if (last) return;
  }
}

}  // namespace hl
