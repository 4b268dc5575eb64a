#include "engine/techniques/ddgi/lattice.h"

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/scene/texture_sampling.h"

namespace hl {
namespace {

/// An axis along which the scene is flatter than this share of its longest side is given that much room.
constexpr float kLeastSide = 1e-3f;
/// Every device has images of at least this side.
constexpr uint32_t kAtlasSide = 4096;
/// Distances are cut at so many diagonals of a cell: farther ones never decide, and would only add variance.
constexpr float kFarthestDiagonals = 1.5f;
constexpr float kStartResidual = 0.005f, kSettledResidual = 0.01f;
constexpr uint32_t kMostStartFrames = 64;
/// After a reset the noise has become what it will be after so many lengths of the average's memory.
constexpr float kMemoriesToSettle = 2;

uint32_t logRatio(float residual, float base) {
  return base > 0 ? static_cast<uint32_t>(std::ceil(std::log(residual) / std::log(std::min(base, 0.9999f)))) : 1u;
}

double meanLuminance(const Texture& texture) {
  // A grid of samples: the mean of a texture needs no more.
  constexpr int kAcross = 32;
  double sum = 0;
  for (int y = 0; y < kAcross; ++y)
    for (int x = 0; x < kAcross; ++x) {
      const vec4 c = sampleTexture(texture, vec2((static_cast<float>(x) + 0.5f) / kAcross, (static_cast<float>(y) + 0.5f) / kAcross));
      sum += static_cast<double>(luminance(vec3(c.x, c.y, c.z)));
    }
  return sum / (kAcross * kAcross);
}

}  // namespace

uint32_t probeCount(const shared::DdgiGrid& g) { return g.counts.x * g.counts.y * g.counts.z; }

shared::DdgiGrid fitLattice(const Bounds& surfaces, const DdgiParams& params) {
  vec3 low = surfaces.empty() ? vec3(0) : surfaces.min, high = surfaces.empty() ? vec3(1) : surfaces.max;
  vec3 side = high - low;
  const float longest = std::max(side.x, std::max(side.y, side.z));
  const int wanted[3] = {params.count_x, params.count_y, params.count_z};
  shared::DdgiGrid g{};
  uint64_t total = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const float pad = std::max(0.0f, kLeastSide * std::max(longest, 1e-30f) - side[axis]);
    low[axis] -= 0.5f * pad, side[axis] += pad;
    const float along = side[axis] / (params.spacing * longest) + 1 - 2 * params.inset;
    const float least = params.inset >= 0.5f ? 1.0f : 2.0f;
    const auto n = wanted[axis] > 0 ? std::max(static_cast<uint32_t>(wanted[axis]), static_cast<uint32_t>(least))
                                    : static_cast<uint32_t>(std::max(least, std::round(along)));
    g.counts[axis] = n;
    g.spacing[axis] = side[axis] / (static_cast<float>(n) - 1 + 2 * params.inset);
    g.first[axis] = low[axis] + params.inset * g.spacing[axis];
    total *= n;
  }
  const uint32_t tile = static_cast<uint32_t>(std::max(params.irradiance_texels, params.distance_texels)) + 2;
  const uint64_t across = kAtlasSide / tile;
  const uint64_t most = std::min<uint64_t>(kMostProbes, across * across);
  if (total > most)
    throw Error(ErrorKind::TooLarge, "ddgi: " + std::to_string(g.counts.x) + " x " + std::to_string(g.counts.y) + " x " + std::to_string(g.counts.z) +
                                       " probes are more than " + std::to_string(most) + " with maps of " + std::to_string(tile - 2) +
                                       " texels; raise ddgi.spacing, or lower the counts");
  // A flat axis has cells of almost no height: what biases and distances go by is the widest of what is left.
  const float widest = std::max(g.spacing.x, std::max(g.spacing.y, g.spacing.z));
  g.leastSpacing = widest;
  for (int axis = 0; axis < 3; ++axis)
    if (side[axis] > 2 * kLeastSide * longest) g.leastSpacing = std::min(g.leastSpacing, g.spacing[axis]);
  g.farthest = kFarthestDiagonals * glm::length(g.spacing);
  g.tilesAcross = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(total))));
  return g;
}

float meanAlbedo(const Scene& scene) {
  std::vector<double> albedo;
  std::vector<double> ofTexture(scene.textures.size(), -1);
  for (const Material& m : scene.materials) {
    double value = static_cast<double>(luminance(glm::min(m.albedo, vec3(kMaxAlbedo))));
    if (m.albedoTexture != kNone) {
      double& mean = ofTexture[m.albedoTexture];
      if (mean < 0) mean = meanLuminance(scene.textures[m.albedoTexture]);
      value *= mean;
    }
    albedo.push_back(value);
  }
  double sum = 0, area = 0;
  for (size_t t = 0; t < scene.indices.size(); ++t) {
    const uvec3 i = scene.indices[t];
    const double a = static_cast<double>(
        glm::length(glm::cross(scene.positions[i.y] - scene.positions[i.x], scene.positions[i.z] - scene.positions[i.x])));
    sum += a * albedo[scene.materialIds[t]], area += a;
  }
  return area > 0 ? static_cast<float>(std::min(sum / area, static_cast<double>(kMaxAlbedo))) : 0.0f;
}

uint32_t startFrames(float albedo, const DdgiParams& params) {
  if (params.start == kStartEma) return 0;
  return params.multi_bounce ? std::clamp(logRatio(kStartResidual, albedo), 1u, kMostStartFrames) : 1;
}

uint32_t settlingFrames(float albedo, const DdgiParams& params, bool followed) {
  const float feedback = params.multi_bounce ? albedo : 0.0f;
  if (followed || params.start == kStartEma)
    return std::min(kMostSettlingFrames, logRatio(kSettledResidual, 1 - (1 - params.hysteresis) * (1 - feedback)));
  return startFrames(albedo, params) + static_cast<uint32_t>(std::ceil(kMemoriesToSettle / (1 - params.hysteresis)));
}

}  // namespace hl
