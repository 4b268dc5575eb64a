// Casting rays through the four-wide tree of engine/trace/bvh.h. The including file defines HL_ANY (0: closest hit, 1: any hit) and
// HL_ALPHA (1: the scene has alpha-tested triangles).
#include "shaders/shared/ray.h"
#if HL_ALPHA
#define HL_SCENE_UVS
#define HL_SCENE_MATERIALS
#define HL_SCENE_TEXTURES
#include "shaders/scene.glsl"
#endif

layout(local_size_x = 64) in;

// Entries that a walk of this tree needs at most.
layout(constant_id = 0) const uint kStackSize = 64;
layout(constant_id = 1) const uint kRaysPerThread = 1;

uniform samplerBuffer nodes;
uniform samplerBuffer triangles;
layout(scalar) readonly buffer rays_block { Ray rays[]; };
#if HL_ANY
layout(scalar) writeonly buffer result_block { uint result[]; };
#else
layout(scalar) writeonly buffer result_block { Hit result[]; };
#endif
layout(push_constant, scalar) uniform Constants { uint rayCount; };

const uint kLeafBit = 0x80000000u;
const uint kNodeMask = (1u << 29) - 1u;
const uint kFirstMask = (1u << 26) - 1u;
const uint kCountShift = 26u;
const int kNodeTexels = 7;
const int kTriangleTexels = 3;
// Below this a direction's component counts as this: 0 would make NaN of a slab that the ray starts in.
const float kMinDirection = 1e-12;
// Rounding of a slab's distance (three operations, two units in the last place each), on the safe side.
const float kSlabSlack = 1.0 + 6.0 * 1.1920929e-7;

const float kNever = 3.4e38;

float safeInverse(float d) { return 1.0 / (abs(d) < kMinDirection ? (d < 0.0 ? -kMinDirection : kMinDirection) : d); }

/// The signed volumes of the ray with the triangle's edges decide, so that neighbours share one verdict on their common edge: nothing slips
/// through between them. Distances come from the plane. Contraction into fused operations would break the symmetry: hence `precise`.
bool hitTriangle(int index, Ray ray, float tMax, out Hit hit) {
  vec4 texel0 = texelFetch(triangles, index * kTriangleTexels);
  vec4 texel1 = texelFetch(triangles, index * kTriangleTexels + 1);
  precise vec3 a = texel0.xyz - ray.origin;
  precise vec3 b = texel1.xyz - ray.origin;
  precise vec3 c = texelFetch(triangles, index * kTriangleTexels + 2).xyz - ray.origin;
  precise vec3 ca = c - a, ab = a - b, bc = b - c;
  precise vec3 crossCa = cross(ca, c + a), crossAb = cross(ab, a + b), crossBc = cross(bc, b + c);
  precise float volumeB = dot(crossCa, ray.direction);  // weight of b
  precise float volumeC = dot(crossAb, ray.direction);
  precise float volumeA = dot(crossBc, ray.direction);
  float sum = volumeA + volumeB + volumeC;
  float slack = abs(sum) * 1.1920929e-7;
  float least = min(volumeA, min(volumeB, volumeC)), most = max(volumeA, max(volumeB, volumeC));
  if (least < -slack && most > slack) return false;
  vec3 normal = cross(ab, ca);
  float slope = dot(normal, ray.direction);
  float t = dot(a, normal) / slope;
  if (slope == 0.0 || !(t >= ray.tMin && t <= tMax)) return false;
  float scale = sum != 0.0 ? 1.0 / sum : 0.0;
  hit.t = t;
  hit.primitive = floatBitsToUint(texel0.w) & kNodeMask;
  hit.u = clamp(volumeB * scale, 0.0, 1.0);
  hit.v = clamp(volumeC * scale, 0.0, 1.0);
#if HL_ALPHA
  if (texel1.w != 0.0 && !materialOpaque(fetchMaterial(hit.primitive), fetchUv(hit.primitive, vec2(hit.u, hit.v)))) return false;
#endif
  return true;
}

void order(inout uint childA, inout float nearA, inout uint childB, inout float nearB) {
  bool swapped = nearB < nearA;
  uint child = swapped ? childB : childA;
  float near = swapped ? nearB : nearA;
  childB = swapped ? childA : childB;
  nearB = swapped ? nearA : nearB;
  childA = child;
  nearA = near;
}

struct Traversal {
  Ray ray;
  vec3 inverse;   ///< of the direction
  ivec3 side;     ///< 1 along an axis: the box's upper face comes first
  float tMax;     ///< what is further away doesn't count any more
  uint depth;     ///< entries on the stack
  uint next;      ///< child word to look at: a node, or a leaf's triangles
  Hit best;
};

uint stack[kStackSize];

Traversal start(Ray ray) {
  Traversal t;
  // NaN makes an interval empty as well, which max() would hide.
  if (!(ray.tMin <= ray.tMax)) ray.tMax = -1.0;
  ray.tMin = max(ray.tMin, 0.0);
  t.ray = ray;
  t.inverse = vec3(safeInverse(ray.direction.x), safeInverse(ray.direction.y), safeInverse(ray.direction.z));
  t.side = ivec3(lessThan(t.inverse, vec3(0.0)));
  t.tMax = ray.tMax;
  t.depth = 0u;
  t.next = 0u;  // the root
  t.best = Hit(0.0, kMiss, 0.0, 0.0);
  return t;
}

/// Puts the children that the ray enters on the stack: for the closest hit the nearest on top, for any hit the first, which is the largest. Every slot is written and then counted or not:
/// a masked store costs more than a plain one.
void enterNode(inout Traversal t) {
  int base = int(t.next & kNodeMask) * kNodeTexels;
  vec4 nearX = (texelFetch(nodes, base + t.side.x) - t.ray.origin.x) * t.inverse.x;
  vec4 farX = (texelFetch(nodes, base + 1 - t.side.x) - t.ray.origin.x) * t.inverse.x;
  vec4 nearY = (texelFetch(nodes, base + 2 + t.side.y) - t.ray.origin.y) * t.inverse.y;
  vec4 farY = (texelFetch(nodes, base + 3 - t.side.y) - t.ray.origin.y) * t.inverse.y;
  vec4 nearZ = (texelFetch(nodes, base + 4 + t.side.z) - t.ray.origin.z) * t.inverse.z;
  vec4 farZ = (texelFetch(nodes, base + 5 - t.side.z) - t.ray.origin.z) * t.inverse.z;
  uvec4 child = floatBitsToUint(texelFetch(nodes, base + 6));
  vec4 near = max(max(nearX, nearY), max(nearZ, vec4(t.ray.tMin)));
  vec4 far = min(min(farX, farY), min(farZ, vec4(t.tMax))) * kSlabSlack;
  bvec4 entered = lessThanEqual(near, far);
#if !HL_ANY
  near = mix(vec4(kNever), near, entered);
  order(child.x, near.x, child.y, near.y);
  order(child.z, near.z, child.w, near.w);
  order(child.x, near.x, child.z, near.z);
  order(child.y, near.y, child.w, near.w);
  order(child.y, near.y, child.z, near.z);
  entered = lessThan(near, vec4(kNever));
#endif
  stack[t.depth] = child.w;
  t.depth += uint(entered.w);
  stack[t.depth] = child.z;
  t.depth += uint(entered.z);
  stack[t.depth] = child.y;
  t.depth += uint(entered.y);
  stack[t.depth] = child.x;
  t.depth += uint(entered.x);
}

bool pop(inout Traversal t) {
  if (t.depth == 0u) return false;
  t.next = stack[--t.depth];
  return true;
}

void testLeaf(inout Traversal t) {
  int first = int(t.next & kFirstMask);
  int last = first + int((t.next >> kCountShift) & 7u);
  for (int i = first; i <= last; ++i) {
    Hit hit;
    if (!hitTriangle(i, t.ray, t.tMax, hit)) continue;
    t.best = hit;
    t.tMax = hit.t;
#if HL_ANY
    t.depth = 0u;
    break;
#endif
  }
}

// A thread that is done with its ray takes the next one of its group's at once, instead of waiting for its neighbours' longer ones; and leaves
// wait until every thread of the subgroup has found one.
void main() {
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  uint share = gl_WorkGroupSize.x * kRaysPerThread;
  uint index = group * share + gl_LocalInvocationIndex;
  uint end = min(rayCount, (group + 1u) * share);
  bool fresh = true;
  Traversal t;
  while (index < end) {
    if (fresh) t = start(rays[index]);
    fresh = false;
    bool atLeaf = (t.next & kLeafBit) != 0u;
    bool more = true;
    while (more && !atLeaf) {
      enterNode(t);
      more = pop(t);
      atLeaf = (t.next & kLeafBit) != 0u;
    }
    if (more) {
      testLeaf(t);
      more = pop(t);
    }
    if (!more) {
#if HL_ANY
      result[index] = t.best.primitive == kMiss ? 0u : 1u;
#else
      result[index] = t.best;
#endif
      index += gl_WorkGroupSize.x;
      fresh = true;
    }
  }
}
