#include "engine/techniques/srp/probe_samples.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "engine/core/error.h"
#include "engine/core/spherical_harmonics64.h"
#include "shaders/shared/lightmap_codes.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/sampling.h"

namespace hl {
namespace {
constexpr uint32_t kUnitRays = 1u << 16;

std::vector<float> weightedBasis(std::span<const vec3> directions, int order) {
  std::vector<float> table;
  const double weight = 4 * std::numbers::pi / static_cast<double>(directions.size());
  for (vec3 d : directions) {
    const sh64::ShCoefficients y = sh64::shBasis(order, glm::normalize(glm::dvec3(d)));
    for (int j = 0; j < sh64::shCount(order); ++j) table.push_back(static_cast<float>(weight * y.c[j]));
  }
  return table;
}

}  // namespace

std::vector<vec3> sphereDirections(uint32_t count, uint32_t seed) {
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  shared::Random random = shared::randomInit(seed, 0, 0);
  const float u = shared::randomFloat(random), v = shared::randomFloat(random);
  const vec3 axis = shared::sampleUniformSphere(vec2(u, v));
  vec3 tangent, bitangent;
  shared::orthonormalBasis(axis, tangent, bitangent);
  std::vector<vec3> directions;
  directions.reserve(count);
  for (uint32_t i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(std::max(0.0, 1 - z * z)), angle = golden * i;
    directions.push_back(tangent * static_cast<float>(r * std::cos(angle)) + bitangent * static_cast<float>(r * std::sin(angle)) + axis * static_cast<float>(z));
  }
  return directions;
}

ProbeSamples::ProbeSamples(Gpu& gpu, const SceneView& scene, uint32_t samples, int order, const Buffer& triangles, const Buffer& lumelOfTexel)
    : device_(gpu.device), scene_(scene), samples_(samples), triangles_(triangles), lumelOfTexel_(lumelOfTexel) {
  probes_ = static_cast<uint32_t>(scene.probes->count());
  probesAUnit_ = std::clamp(kUnitRays / samples, 1u, std::max(1u, probes_));
  units_ = (probes_ + probesAUnit_ - 1) / probesAUnit_;
  const uint64_t bytes = uint64_t{4} * probes_ * samples;
  if (bytes > device_.maxStorageBufferBytes())
    throw Error(ErrorKind::TooLarge, "srp: " + std::to_string(probes_) + " probes with " + std::to_string(samples) + " rays each need " + std::to_string(bytes >> 20) +
                                       " MiB, more than a buffer of this device holds; lower srp.probe_rays");
  std::vector<vec4> positions, table;
  for (vec3 p : scene.probes->positions) positions.push_back(vec4(p, 0.0f));
  const std::vector<vec3> directions = sphereDirections(samples, scene.seed);
  for (vec3 d : directions) table.push_back(vec4(d, 0.0f));
  positions_ = device_.buffer("srp: probes", std::span<const vec4>(positions));
  directionTable_ = device_.buffer("srp: directions", std::span<const vec4>(table));
  basis_ = device_.buffer("srp: basis of samples", std::span<const float>(weightedBasis(directions, order)));
  const uint64_t rays = uint64_t{probesAUnit_} * samples;
  rays_ = device_.buffer("srp: probes' rays", rays * sizeof(shared::Ray), TexelFormat::RGBA32F);
  hits_ = device_.buffer("srp: probes' hits", rays * sizeof(shared::Hit));
  codes_ = device_.buffer("srp: what probes see", std::max<uint64_t>(4, bytes));
}

void ProbeSamples::recordUnit(FrameGraph& graph) {
  const auto first = static_cast<uint32_t>(done_) * probesAUnit_;
  const uint32_t count = std::min(probesAUnit_, probes_ - first), rays = count * samples_;
  struct Constants {
    uint32_t first, count, samples, seed;
  } constants{first, count, samples_, scene_.seed};
  graph.compute("srp: make probes' rays", "srp/probe_rays.comp")
      .bind("probes", positions_, Access::Read)
      .bind("directions", directionTable_, Access::Read)
      .bind("rays", rays_, Access::Write)
      .push(constants)
      .dispatchThreads(rays);
  scene_.tracer.record(graph, "srp: cast probes' rays", rays_, hits_, rays, Query::Closest);
  graph.compute("srp: find lumels", "passes/find_lumels.comp")
      .bind("rays", rays_, Access::Read)
      .bind("hits", hits_, Access::Read)
      .bind("triangles", triangles_, Access::Read)
      .bind("lumelOfTexel", lumelOfTexel_, Access::Read)
      .bind("codes", codes_, Access::Write)
      .push(shared::LumelSearch{rays, first * samples_, static_cast<uint32_t>(scene_.atlas->resolution)})
      .dispatchThreads(rays);
  ++done_;
}

uint64_t ProbeSamples::workingBytes() const {
  uint64_t bytes = 0;
  for (const Buffer* b : {&rays_, &hits_, &positions_, &directionTable_}) bytes += *b ? b->size() : 0;
  return bytes;
}

const ProbeSamples::Counts& ProbeSamples::counts() const {
  if (counted_ == done_) return counts_;
  counted_ = done_;
  counts_ = {};
  std::vector<uint32_t> codes(std::min<uint64_t>(done_ * probesAUnit_, probes_) * samples_);
  device_.download(codes_, codes.data(), codes.size() * sizeof(uint32_t));
  for (uint32_t c : codes) {
    counts_.misses += c == shared::kCodeMiss;
    counts_.backFaces += c == shared::kCodeBackFace;
    counts_.withoutTexel += c == shared::kCodeNoTexel;
  }
  return counts_;
}

}  // namespace hl
