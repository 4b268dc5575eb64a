#include "engine/techniques/radiosity/host_units.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "shaders/shared/lumel_rays.h"

namespace hl {
namespace {

// What a task takes: a millisecond or so, so that few pieces wait for the last.
constexpr size_t kPieceRays = 4096, kPieceCodes = 1u << 16;

/// A packet's directions, from points of the disc.
template <class Disc>
void fill(RayPacket& packet, const float* x, const float* y, const vec3& tangent, const vec3& bitangent, const vec3& normal, const Disc& disc) {
  for (size_t i = 0; i < kPacketRays; ++i) {
    const vec2 d = disc(vec2(x[i], y[i]));
    const float h = shared::hemisphereHeight(d);
    packet.directionX[i] = tangent.x * d.x + bitangent.x * d.y + normal.x * h;
    packet.directionY[i] = tangent.y * d.x + bitangent.y * d.y + normal.y * h;
    packet.directionZ[i] = tangent.z * d.x + bitangent.z * d.y + normal.z * h;
  }
}

/// Adds to a counter in two words.
void add(std::span<uint32_t> counters, uint32_t which, uint64_t n) {
  const uint64_t sum = (uint64_t{counters[2 * which + 1]} << 32 | counters[2 * which]) + n;
  counters[2 * which] = static_cast<uint32_t>(sum), counters[2 * which + 1] = static_cast<uint32_t>(sum >> 32);
}

}  // namespace

HostUnits::HostUnits(const Tracer& tracer, TaskPool& pool, const RadiosityParams& params, std::span<const vec4> triangles, std::vector<uint32_t> lumelOfTexel,
                   std::span<const vec4> directions)
    : tracer_(tracer),
      pool_(pool),
      samples_(static_cast<uint32_t>(params.samples)),
      turns_(params.directions == kDirectionsLargestEmptyCircle),
      lumelOfTexel_(std::move(lumelOfTexel)) {
  triangles_.reserve(triangles.size() / 2);
  for (size_t t = 0; t + 1 < triangles.size(); t += 2) triangles_.push_back({triangles[t], triangles[t + 1]});
  const size_t whole = (directions.size() + kPacketRays - 1) / kPacketRays * kPacketRays;
  for (size_t i = 0; i < whole; ++i) {
    const vec4 d = directions[std::min(i, directions.size() - 1)];
    x_.push_back(d.x), y_.push_back(d.y), weights_.push_back(d.z);
  }
}

template <class Visit>
void HostUnits::castLumel(uint32_t lumel, const shared::RadiosityUnit& unit, uint32_t* codes, const Visit& visit) const {
  const shared::SurfacePoint& p = points_[lumel];
  const vec3 origin = p.position + p.offset * p.geometricNormal, normal = p.geometricNormal;
  vec3 tangent, bitangent;
  shared::orthonormalBasis(normal, tangent, bitangent);
  shared::Random random = shared::randomInit(unit.seed, lumel, 0);
  const float shiftX = shared::randomFloat(random), shiftY = shared::randomFloat(random);
  const vec2 shift(shiftX, shiftY), turn(std::cos(2 * kPi * shiftX), std::sin(2 * kPi * shiftX));
  RayPacket packet;
  packet.originX.fill(origin.x), packet.originY.fill(origin.y), packet.originZ.fill(origin.z);
  packet.tMin.fill(0), packet.tMax.fill(shared::kRayEnd);
  for (uint32_t first = 0; first < samples_; first += kPacketRays) {
    const uint32_t count = std::min(kPacketRays, samples_ - first);
    if (turns_) {
      fill(packet, &x_[first], &y_[first], tangent, bitangent, normal, [&](vec2 point) { return shared::turned(point, turn); });
    } else {
      fill(packet, &x_[first], &y_[first], tangent, bitangent, normal,
           [&](vec2 point) { return shared::concentricDisc(shared::shifted(point, shift)); });
    }
    tracer_.closest(packet, count);
    findTexels(packet, unit.resolution, {codes + first, count});
    visit(first, count, packet);
  }
}

void HostUnits::findTexels(const RayPacket& p, uint32_t resolution, std::span<uint32_t> codes) const {
  for (size_t i = 0; i < codes.size(); ++i) {
    uint32_t code = shared::kCodeMiss;
    if (const uint32_t triangle = p.primitive[i]; triangle != shared::kMiss) {
      const auto& [first, second] = triangles_[triangle];
      code = shared::hitsBack(second, vec3(p.directionX[i], p.directionY[i], p.directionZ[i]))
                 ? shared::kCodeBackFace
                 : shared::codeOfLumel(lumelOfTexel_[shared::texelHit(first, second, p.u[i], p.v[i], resolution)]);
    }
    codes[i] = code;
  }
}

void HostUnits::cast(const shared::RadiosityUnit& unit, std::span<uint32_t> codes) const {
  pool_.parallelFor(unit.lumels, std::max<size_t>(1, kPieceRays / samples_), [&](size_t begin, size_t end, unsigned) {
    for (size_t i = begin; i < end; ++i)
      castLumel(unit.firstLumel + static_cast<uint32_t>(i), unit, &codes[unit.codeBase + i * samples_], [](uint32_t, uint32_t, const RayPacket&) {});
  });
}

void HostUnits::inspect(const shared::RadiosityUnit& unit, std::span<shared::Ray> rays, std::span<shared::Hit> hits, std::span<uint32_t> codes) const {
  castLumel(unit.firstLumel, unit, codes.data(), [&](uint32_t first, uint32_t count, const RayPacket& p) {
    for (size_t i = 0; i < count; ++i) {
      rays[first + i] = {vec3(p.originX[i], p.originY[i], p.originZ[i]), p.tMin[i], vec3(p.directionX[i], p.directionY[i], p.directionZ[i]), p.tMax[i]};
      hits[first + i] = {p.t[i], p.primitive[i], p.u[i], p.v[i]};
    }
  });
}

/// Sums of sixteen first: an order of its own, but always the same, and one that loses few figures.
vec3 HostUnits::gatherLumel(const uint32_t* codes, std::span<const vec4> radiance, Counts& counts) const {
  vec4 sum(0.0f);
  for (uint32_t first = 0; first < samples_; first += kPacketRays) {
    vec4 part(0.0f);
    for (uint32_t j = first; j < std::min<uint32_t>(first + kPacketRays, samples_); ++j) {
      const uint32_t code = codes[j];
      if (code < shared::kFirstCode) {
        part += weights_[j] * radiance[code];
      } else {
        counts.backFaces += code == shared::kCodeBackFace;
        counts.withoutTexel += code == shared::kCodeNoTexel;
      }
    }
    sum += part;
  }
  return kPi * vec3(sum.x, sum.y, sum.z);
}

void HostUnits::gather(const shared::RadiosityUnit& unit, std::span<const uint32_t> codes, std::span<const vec4> radiance, std::span<vec4> irradiance,
                       std::span<uint32_t> counters) const {
  std::mutex mutex;
  Counts all;
  pool_.parallelFor(unit.lumels, std::max<size_t>(1, kPieceCodes / samples_), [&](size_t begin, size_t end, unsigned) {
    Counts counts;
    for (size_t i = begin; i < end; ++i) {
      const vec3 e = gatherLumel(&codes[unit.codeBase + i * samples_], radiance, counts);
      vec4& value = irradiance[unit.firstLumel + i];
      value = vec4(e, luminance(glm::abs(e - vec3(value.x, value.y, value.z))));
      counts.nonFinite += !(std::isfinite(e.x) && std::isfinite(e.y) && std::isfinite(e.z));
    }
    std::lock_guard lock(mutex);
    all.backFaces += counts.backFaces, all.withoutTexel += counts.withoutTexel, all.nonFinite += counts.nonFinite;
  });
  if (unit.counting != 0) {
    add(counters, shared::kCountBackFace, all.backFaces);
    add(counters, shared::kCountNoTexel, all.withoutTexel);
  }
  add(counters, shared::kCountNonFinite, all.nonFinite);
}

uint64_t HostUnits::bytes() const {
  return triangles_.size() * sizeof(Triangle) + lumelOfTexel_.size() * sizeof(uint32_t) + points_.size() * sizeof(shared::SurfacePoint) +
         (x_.size() + y_.size() + weights_.size()) * sizeof(float);
}

}  // namespace hl
