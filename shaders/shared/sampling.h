#ifndef HALFLIGHT_SAMPLING_H
#define HALFLIGHT_SAMPLING_H
// Directions, points and weights for Monte Carlo integration, the same in C++ and GLSL. `u` are uniform numbers in [0, 1).
#include "shaders/shared/interop.h"
#include "shaders/shared/random.h"
HL_BEGIN

#ifndef __cplusplus
HL_CONST float kPi = 3.14159265358979323846f;
#endif

// ---------------------------------------------------------------------------------------------------------------- frames and directions

/// Two unit vectors that make a right-handed frame (tangent, bitangent, n) with the unit vector `n`, without a branch that jumps.
/// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
HL_INLINE void orthonormalBasis(vec3 n, HL_OUT(vec3) tangent, HL_OUT(vec3) bitangent) {
  float s = n.z >= 0.0f ? 1.0f : -1.0f;
  float a = -1.0f / (s + n.z);
  float b = n.x * n.y * a;
  tangent = vec3(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
  bitangent = vec3(b, s + n.y * n.y * a, -n.y);
}

/// From the frame in which `n` is +z to the world's.
HL_INLINE vec3 fromLocal(vec3 local, vec3 n) {
  vec3 t = vec3(0.0f);
  vec3 b = vec3(0.0f);
  orthonormalBasis(n, t, b);
  return t * local.x + b * local.y + n * local.z;
}

/// From the world's frame to the one in which `n` is +z: the inverse of fromLocal.
HL_INLINE vec3 toLocal(vec3 world, vec3 n) {
  vec3 t = vec3(0.0f);
  vec3 b = vec3(0.0f);
  orthonormalBasis(n, t, b);
  return vec3(dot(world, t), dot(world, b), dot(world, n));
}

/// Uniform in the unit disc; neighbours stay neighbours. Shirley and Chiu, "A Low Distortion Map Between Disk and Square", 1997.
HL_INLINE vec2 sampleDisc(vec2 u) {
  float x = 2.0f * u.x - 1.0f;
  float y = 2.0f * u.y - 1.0f;
  if (x == 0.0f && y == 0.0f) return vec2(0.0f, 0.0f);
  bool wide = abs(x) > abs(y);
  float r = wide ? x : y;
  float angle = wide ? 0.25f * kPi * (y / x) : 0.5f * kPi - 0.25f * kPi * (x / y);
  return vec2(r * cos(angle), r * sin(angle));
}

/// Density z / pi round +z.
HL_INLINE vec3 sampleCosineHemisphere(vec2 u) {
  vec2 d = sampleDisc(u);
  return vec3(d.x, d.y, sqrt(max(0.0f, 1.0f - d.x * d.x - d.y * d.y)));
}

/// Density 1 / (2 pi) round +z. The disc's radius squared is uniform, so 1 - r^2 is a uniform height.
HL_INLINE vec3 sampleUniformHemisphere(vec2 u) {
  vec2 d = sampleDisc(u);
  float r2 = d.x * d.x + d.y * d.y;
  float scale = sqrt(max(0.0f, 2.0f - r2));
  return vec3(d.x * scale, d.y * scale, 1.0f - r2);
}

/// Density 1 / (4 pi).
HL_INLINE vec3 sampleUniformSphere(vec2 u) {
  float z = 1.0f - 2.0f * u.x;
  float r = sqrt(max(0.0f, 1.0f - z * z));
  float angle = 2.0f * kPi * u.y;
  return vec3(r * cos(angle), r * sin(angle), z);
}

// ---------------------------------------------------------------------------------------------------------------- triangles

/// Uniform on a triangle: weights of p1 and p2. Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.
HL_INLINE vec2 sampleTriangle(vec2 u) {
  if (u.y > u.x) {
    float x = 0.5f * u.x;
    return vec2(x, u.y - x);
  }
  float y = 0.5f * u.y;
  return vec2(u.x - y, y);
}

/// Solid angle [sr] that the triangle subtends at `from`, in [0, 2 pi], whichever way it faces. Van Oosterom and Strackee, 1983, with the triple
/// product taken from edges, so that far and tiny triangles keep their figures.
HL_INLINE float triangleSolidAngle(vec3 from, vec3 p0, vec3 p1, vec3 p2) {
  vec3 a = p0 - from;
  vec3 b = p1 - from;
  vec3 c = p2 - from;
  float la = length(a);
  float lb = length(b);
  float lc = length(c);
  float triple = abs(dot(a, cross(p1 - p0, p2 - p0)));
  float cosines = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  if (triple == 0.0f && cosines <= 0.0f) return 0.0f;  // `from` lies in the triangle itself: nothing in front of it
  return 2.0f * atan(triple, cosines);
}

/// Below this largest edge over smallest distance a triangle's points are sampled by area: single precision could not resolve its spherical
/// image, and the area density differs from the uniform one by about as little.
HL_CONST float kSphericalMinSize = 0.02f;
/// Above this solid angle [sr] two vertices are nearly opposite each other as seen from the point, and the arc between them is undefined.
HL_CONST float kSphericalMaxSolidAngle = 6.28f;

struct TriangleSample {
  vec3 direction;  ///< unit
  float distance;  ///< to the triangle's plane along it
  float pdf;       ///< per solid angle; 0: the triangle can't be seen from here
};

HL_INLINE bool triangleSampledByArea(vec3 from, vec3 p0, vec3 p1, vec3 p2, float solidAngle) {
  float near = min(length(p0 - from), min(length(p1 - from), length(p2 - from)));
  float edge = max(length(p1 - p0), max(length(p2 - p0), length(p2 - p1)));
  return edge < kSphericalMinSize * near || solidAngle > kSphericalMaxSolidAngle;
}

/// Density per solid angle with which sampleTriangleLight finds a point at `distance` along the unit vector `direction`.
HL_INLINE float triangleLightPdf(vec3 from, vec3 p0, vec3 p1, vec3 p2, vec3 direction, float distance) {
  float solidAngle = triangleSolidAngle(from, p0, p1, p2);
  if (!(solidAngle > 0.0f)) return 0.0f;
  if (!triangleSampledByArea(from, p0, p1, p2, solidAngle)) return 1.0f / solidAngle;
  float projected = 0.5f * abs(dot(cross(p1 - p0, p2 - p0), direction));
  return projected > 0.0f ? distance * distance / projected : 0.0f;
}

/// A direction from `from` to the triangle, uniform in solid angle (by area where that is not resolved; `pdf` says the truth either way).
/// Arvo 1995 split the triangle by area from one vertex; here the split point comes from the half-angle tangent of the arc,
/// tan(phi/2) = T (1 + a.b) / (det(a, b, t) - T b.t) with T = tan(area/2), which is stable for slivers too.
HL_INLINE TriangleSample sampleTriangleLight(vec3 from, vec3 p0, vec3 p1, vec3 p2, vec2 u) {
  TriangleSample s;
  s.direction = vec3(0.0f, 0.0f, 1.0f);
  s.distance = 0.0f;
  s.pdf = 0.0f;
  vec3 e1 = p1 - p0;
  vec3 e2 = p2 - p0;
  vec3 normal = cross(e1, e2);
  vec3 va = p0 - from;
  float solidAngle = triangleSolidAngle(from, p0, p1, p2);
  if (!(solidAngle > 0.0f)) return s;
  if (triangleSampledByArea(from, p0, p1, p2, solidAngle)) {
    vec2 w = sampleTriangle(u);
    vec3 to = va + e1 * w.x + e2 * w.y;
    s.distance = length(to);
    s.direction = to / s.distance;
    float projected = 0.5f * abs(dot(normal, s.direction));
    s.pdf = projected > 0.0f ? s.distance * s.distance / projected : 0.0f;
    return s;
  }
  vec3 vb = p1 - from;
  vec3 vc = p2 - from;
  float lb = length(vb);
  float lc = length(vc);
  vec3 a = normalize(va);
  vec3 b = vb / lb;
  vec3 t = normalize(e2 - a * dot(a, e2));  // tangent at a of the arc towards c
  vec3 ab = a + b;
  float oneAb = 0.5f * dot(ab, ab);  // 1 + a.b, which cancels where they are nearly opposite
  float bt = dot(e1, t) / lb;
  float half0 = 0.5f * solidAngle;
  float half1 = half0 * u.x;
  float numerator = 0.0f;
  float denominator = 1.0f;
  if (solidAngle < 1.0f) {
    // det(a, b, t) expressed by the whole arc's own half-angle tangent: exact at both ends however thin the triangle is.
    float cotC = (lc + dot(a, vc)) / dot(e2, t);
    numerator = sin(half1) * cos(half0) * oneAb;
    denominator = cos(half1) * sin(half0) * oneAb * cotC + sin(half0 - half1) * bt;
  } else {
    numerator = sin(half1) * oneAb;
    denominator = cos(half1) * abs(dot(e1, cross(t, a))) / lb - sin(half1) * bt;
  }
  float phi = 2.0f * atan(numerator, denominator);
  vec3 cut = a * cos(phi) + t * sin(phi);
  // The chord's square is linear in the area swept round b: 1 - cos = chord^2 / 2.
  vec3 chord = cut - b;
  float chord2 = dot(chord, chord);
  vec3 along = chord - b * dot(b, chord);
  float alongLength = length(along);
  float versine = 0.5f * u.y * chord2;
  s.direction = b * (1.0f - versine);
  if (alongLength > 0.0f) s.direction += along * (sqrt(max(0.0f, versine * (2.0f - versine))) / alongLength);
  s.direction = normalize(s.direction);
  float slope = dot(s.direction, normal);
  s.distance = slope != 0.0f ? max(0.0f, dot(va, normal) / slope) : 0.0f;
  s.pdf = s.distance > 0.0f ? 1.0f / solidAngle : 0.0f;
  return s;
}

// ---------------------------------------------------------------------------------------------------------------- form factors

/// One edge's share of Lambert's sum: with a, b from the point to the edge's ends, n . (a x b)/|a x b| times the angle between them.
HL_INLINE float formFactorEdge(vec3 a, vec3 b, vec3 n) {
  vec3 m = cross(a, b - a);
  float s = length(m);
  return s > 0.0f ? dot(n, m) / s * atan(s, dot(a, b)) : 0.0f;
}

/// Form factor from a point with unit normal `n` to a triangle, unoccluded: the share of a Lambertian's light that reaches it, in [0, 1], whichever
/// way the triangle faces. What lies below the horizon is cut off.
HL_INLINE float triangleFormFactor(vec3 from, vec3 n, vec3 p0, vec3 p1, vec3 p2) {
  vec3 previous = p2 - from;
  float hPrevious = dot(previous, n);
  float near = min(length(p0 - from), min(length(p1 - from), length(previous)));
  float edge = max(length(p1 - p0), max(length(p2 - p0), length(p2 - p1)));
  if (edge < kSphericalMinSize * near && min(hPrevious, min(dot(p0 - from, n), dot(p1 - from, n))) > 0.0f) {
    // Far away the edges' shares cancel unless the point faces the triangle; the kernel at the edges' middles (exact to second order) does not.
    vec3 areaNormal = cross(p1 - p0, p2 - p0);
    float ahead = abs(dot(areaNormal, p0 - from));
    float kernel = 0.0f;
    for (int i = 0; i < 3; ++i) {
      vec3 middle = 0.5f * (i == 0 ? p0 + p1 : (i == 1 ? p1 + p2 : p2 + p0)) - from;
      float d2 = dot(middle, middle);
      kernel += dot(middle, n) / (d2 * d2);
    }
    return ahead * kernel / (6.0f * kPi);
  }
  vec3 first = vec3(0.0f);
  vec3 last = vec3(0.0f);
  int count = 0;
  float sum = 0.0f;
  for (int i = 0; i < 3; ++i) {
    vec3 v = (i == 0 ? p0 : (i == 1 ? p1 : p2)) - from;
    float h = dot(v, n);
    if ((h > 0.0f) != (hPrevious > 0.0f)) {
      vec3 cut = previous + (v - previous) * (hPrevious / (hPrevious - h));
      if (count > 0) sum += formFactorEdge(last, cut, n);
      if (count == 0) first = cut;
      last = cut;
      ++count;
    }
    if (h > 0.0f) {
      if (count > 0) sum += formFactorEdge(last, v, n);
      if (count == 0) first = v;
      last = v;
      ++count;
    }
    previous = v;
    hPrevious = h;
  }
  if (count < 3) return 0.0f;
  sum += formFactorEdge(last, first, n);
  return abs(sum) / (2.0f * kPi);
}

// ---------------------------------------------------------------------------------------------------------------- weights

HL_INLINE float balanceHeuristic(float pdf, float otherPdf) { return pdf > 0.0f ? pdf / (pdf + otherPdf) : 0.0f; }

/// Veach's power heuristic with exponent 2, from the ratio, so that large densities don't overflow.
HL_INLINE float powerHeuristic(float pdf, float otherPdf) {
  if (!(pdf > 0.0f)) return 0.0f;
  float r = otherPdf / pdf;
  return 1.0f / (1.0f + r * r);
}

/// Share of a spot light's intensity at an angle off its axis: a smoothstep of the cosine from `cosOuter` up to `cosInner`.
HL_INLINE float spotFalloff(float cosAngle, float cosInner, float cosOuter) {
  if (cosInner <= cosOuter) return cosAngle >= cosOuter ? 1.0f : 0.0f;
  float x = clamp((cosAngle - cosOuter) / (cosInner - cosOuter), 0.0f, 1.0f);
  return x * x * (3.0f - 2.0f * x);
}

// ---------------------------------------------------------------------------------------------------------------- low-discrepancy points

/// [0, 1) from the top 24 bits, so that 1 is never returned.
HL_INLINE float unitFloat(uint bits) { return float(bits >> 8u) * (1.0f / 16777216.0f); }

HL_INLINE uint reverseBits(uint v) {
  uint x = ((v >> 1u) & 0x55555555u) | ((v & 0x55555555u) << 1u);
  x = ((x >> 2u) & 0x33333333u) | ((x & 0x33333333u) << 2u);
  x = ((x >> 4u) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4u);
  x = ((x >> 8u) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8u);
  return (x >> 16u) | (x << 16u);
}

/// Point `index` of Roberts's R2 sequence (powers of the plastic number), moved by a Cranley-Patterson shift given as fixed-point fractions.
/// Integer arithmetic: it never loses figures, whatever the index.
HL_INLINE vec2 r2Point(uint index, uvec2 shift) {
  return vec2(unitFloat(shift.x + index * 3242174889u), unitFloat(shift.y + index * 2447445414u));
}

/// Point `index` of the (0, 2)-sequence (van der Corput and Sobol'), each digit flipped by `scramble`: any 2^k points in a row from a multiple
/// of 2^k on are stratified in every elementary interval. Kollig and Keller, "Efficient Multidimensional Sampling", 2002.
HL_INLINE uvec2 sobolBits(uint index) {
  uint y = 0u;
  uint v = 0x80000000u;
  for (uint i = index; i != 0u; i >>= 1u) {
    if ((i & 1u) != 0u) y ^= v;
    v ^= v >> 1u;
  }
  return uvec2(reverseBits(index), y);
}
HL_INLINE vec2 sobolPoint(uint index, uvec2 scramble) {
  uvec2 b = sobolBits(index);
  return vec2(unitFloat(b.x ^ scramble.x), unitFloat(b.y ^ scramble.y));
}

/// Nested uniform (Owen) scramble by hashing: Laine and Karras 2011 as used in Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020,
/// with N. Vegdahl's constants.
HL_INLINE uint owenScramble(uint bits, uint seed) {
  uint x = reverseBits(bits);
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16u) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return reverseBits(x);
}

/// Owen-scrambled (0, 2) points in an order that `seed` shuffles: sets with different seeds are independent, so that pairs of dimensions
/// can be padded. The first 2^k indices keep their stratification.
HL_INLINE vec2 shuffledSobolPoint(uint index, uint seed) {
  uvec2 b = sobolBits(owenScramble(index, pcgHash(seed)));
  return vec2(unitFloat(owenScramble(b.x, pcgHash(seed ^ 0xa511e9b3u))), unitFloat(owenScramble(b.y, pcgHash(seed ^ 0x63d83595u))));
}

HL_END
#endif
