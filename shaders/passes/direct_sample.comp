#version 460
#extension GL_GOOGLE_include_directive : require
// A shadow ray for every slot of every point, and what the point receives where nothing stands in its way.
#include "shaders/passes/direct_lights.glsl"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer points_block { SurfacePoint points[]; };
layout(scalar) readonly buffer environment_texels { vec3 environmentTexels[]; };
layout(scalar) readonly buffer environment_table { float environmentTable[]; };
layout(scalar) writeonly buffer rays_block { Ray rays[]; };
layout(scalar) writeonly buffer unshadowed_block { vec3 unshadowed[]; };

const uint kSkyDimension = 0xc2b2ae35u;
const uint kEnvironmentDimension = 0x27d4eb2fu;
const uint kEnvironmentChoiceDimension = 0x165667b1u;

/// In [0, 1] with a density that runs linearly from `a` at 0 to `b` at 1, up to a constant.
float sampleLinear(float u, float a, float b) { return u * (a + b) / (a + sqrt(mix(a * a, b * b, u))); }

/// Moves uniform `u` towards where the receiver's cosine is large: bilinear between the cosines at the spherical triangle's corners, to which
/// sampleTriangleLight maps the square (u.y = 0: p1; u.y = 1: from p0 to p2). Returns the density.
float warpByCosine(SurfacePoint p, GpuEmitter e, inout vec2 u) {
  const float least = 0.01;  // no direction is left out
  float w0 = max(least, dot(p.normal, normalize(e.p0 - p.position)));
  float w1 = max(least, dot(p.normal, normalize(e.p1 - p.position)));
  float w2 = max(least, dot(p.normal, normalize(e.p2 - p.position)));
  u.y = min(sampleLinear(u.y, 2.0 * w1, w0 + w2), 0.99999994);
  float left = mix(w1, w0, u.y), right = mix(w1, w2, u.y);
  u.x = min(sampleLinear(u.x, left, right), 0.99999994);
  return mix(left, right, u.x) / (0.25 * (2.0 * w1 + w0 + w2));
}

Sample sampleEmitter(SurfacePoint p, uint index, uint key) {
  Sample s = Sample(kNoRay, vec3(0.0));
  vec2 u = shuffledSobolPoint(index, key ^ kEmitterDimension);
  bool joint = batch.emitters <= kJointChoice;
  Choice c = choose(p, joint ? u.x : shuffledSobolPoint(index, key ^ kChoiceDimension).x);
  if (!(c.probability > 0.0)) return s;
  if (joint) u.x = clamp((u.x - c.before) / c.probability, 0.0, 0.99999994);
  GpuEmitter e = emitters[c.index];
  float solidAngle = triangleSolidAngle(p.position, e.p0, e.p1, e.p2);
  float warp = triangleSampledByArea(p.position, e.p0, e.p1, e.p2, solidAngle) ? 1.0 : warpByCosine(p, e, u);
  TriangleSample t = sampleTriangleLight(p.position, e.p0, e.p1, e.p2, u);
  if (!(t.pdf > 0.0)) return s;
  vec3 normal = normalize(cross(e.p1 - e.p0, e.p2 - e.p0));
  if (dot(normal, t.direction) >= 0.0) return s;  // one-sided: seen from behind
  s.irradiance = e.emission * (receivedCosine(p, t.direction) / (t.pdf * warp * c.probability));
  // The ray ends in front of the emitter, at whatever angle it comes in.
  vec3 target = p.position + t.direction * t.distance + normal * p.offset;
  s.ray = Ray(rayOrigin(p), 0.0, target - rayOrigin(p), 1.0);
  return s;
}

Sample sampleSky(SurfacePoint p, uint index, uint key) {
  vec3 direction = fromLocal(sampleCosineHemisphere(shuffledSobolPoint(index, key ^ kSkyDimension)), p.normal);
  if (dot(p.geometricNormal, direction) <= 0.0) return Sample(kNoRay, vec3(0.0));
  return Sample(Ray(rayOrigin(p), 0.0, direction, kFar), batch.sky * kPi);
}

/// The first of `count` entries whose cumulative share exceeds u; u becomes how far into it.
uint chooseCumulative(uint first, uint count, inout float u) {
  uint low = 0u, high = count - 1u;
  while (low < high) {
    uint middle = (low + high) / 2u;
    if (environmentTable[first + middle] > u) high = middle; else low = middle + 1u;
  }
  float before = low == 0u ? 0.0 : environmentTable[first + low - 1u];
  float share = environmentTable[first + low] - before;
  u = share > 0.0 ? clamp((u - before) / share, 0.0, 0.99999994) : 0.5;
  return low;
}

/// By the map's luminance or by the receiver's cosine, evenly, weighed by the density of both together: each sample alone is without bias, and neither a small bright sun
/// nor an even sky is left to the other's chance.
Sample sampleEnvironment(SurfacePoint p, uint index, uint key) {
  vec2 u = shuffledSobolPoint(index, key ^ kEnvironmentDimension);
  vec3 direction;
  if (shuffledSobolPoint(index, key ^ kEnvironmentChoiceDimension).x < 0.5) {
    uint row = chooseCumulative(0u, batch.environment.height, u.y);
    uint column = chooseCumulative(batch.environment.height + row * batch.environment.width, batch.environment.width, u.x);
    direction = environmentDirection(batch.environment, column, row, u);
  } else {
    direction = fromLocal(sampleCosineHemisphere(u), p.normal);
  }
  float cosine = receivedCosine(p, direction);
  if (!(cosine > 0.0)) return Sample(kNoRay, vec3(0.0));
  vec3 radiance = environmentTexels[environmentTexel(batch.environment, direction)];
  float density = 0.5 * (dot(radiance, vec3(0.2126, 0.7152, 0.0722)) / batch.environment.power + cosine / kPi);
  return Sample(Ray(rayOrigin(p), 0.0, direction, kFar), radiance * (cosine / density));
}

void main() {
  uint i = gl_GlobalInvocationID.x, slot = gl_GlobalInvocationID.y;
  if (i >= batch.count) return;
  SurfacePoint p = points[batch.pointBase + i];
  Sample s = Sample(kNoRay, vec3(0.0));
  if (dot(p.normal, p.normal) > 0.0) {
    if (slot < batch.lights) {
      s = samplePunctual(p, lights[slot]);
    } else {
      uint key = pcgHash((batch.targetBase + i) ^ pcgHash(batch.seed));
      uint emitterRays = batch.emitters > 0u ? 1u : 0u;
      uint kinds = emitterRays + batch.skyRays + batch.environmentRays;
      uint k = slot - batch.lights;
      uint index = batch.firstSample + k / kinds, kind = k % kinds;
      if (kind < emitterRays) s = sampleEmitter(p, index, key);
      else if (kind < emitterRays + batch.skyRays) s = sampleSky(p, index, key);
      else s = sampleEnvironment(p, index, key);
    }
  }
  bool dark = !(max(s.irradiance.x, max(s.irradiance.y, s.irradiance.z)) > 0.0);
  uint ray = slot * batch.count + i;
  rays[ray] = dark ? kNoRay : s.ray;
  unshadowed[ray] = dark ? vec3(0.0) : s.irradiance;
}
