#include "engine/techniques/radiosity/estimate.h"

#include <algorithm>
#include <cmath>

#include "shaders/shared/surface_point.h"

namespace hl {
namespace {

/// Of what arrives, the share that leaves again, over all of the lightmap's area.
double meanAlbedo(const Atlas& atlas) {
  double sum = 0, area = 0;
  for (const Lumel& l : atlas.lumels) {
    sum += static_cast<double>(luminance(l.albedo)) * static_cast<double>(l.area);
    area += static_cast<double>(l.area);
  }
  return area > 0 ? sum / area : 0;
}

/// Bounce n changes the light by (1 - rho) rho^(n-1) of it.
double expectedBounces(double albedo, const RadiosityParams& params) {
  const auto most = static_cast<double>(params.bounces), limit = static_cast<double>(params.residual);
  if (!(albedo > 0)) return 1;
  if (!(limit > 0) || albedo >= 1) return most;
  return std::clamp(std::ceil(std::log(limit / (1 - albedo)) / std::log(albedo)) + 1, 1.0, most);
}

}  // namespace

std::vector<WorkPart> bakeWork(const RadiosityBake::Done& done) {
  WorkPart direct, rays, gathered;
  direct.name = "direct light", direct.amount = done.directRays, direct.passes = {"radiosity: direct light"};
  rays.name = "rays", rays.amount = done.rays, rays.passes = {"radiosity: make rays", "radiosity: cast rays", "radiosity: find texels"};
  gathered.name = "gathered samples", gathered.kind = WorkPart::Kind::Sums, gathered.amount = done.gathered;
  gathered.passes = {"radiosity: gather", "radiosity: reflect", "radiosity: residual"};
  return {direct, rays, gathered};
}

RebuildEstimate estimateBake(const SceneView& scene, const RadiosityParams& params, double lumels) {
  RebuildEstimate estimate;
  estimate.name = "light";
  if (!(lumels > 0)) return estimate;
  const double samples = params.samples, bounces = expectedBounces(meanAlbedo(*scene.atlas), params);
  const auto remembered = static_cast<double>(RadiosityBake::rememberedLumels(static_cast<uint64_t>(lumels), params));
  RadiosityBake::Done done;
  done.directRays = lumels * RadiosityBake::directSamples(scene) * RadiosityBake::directRays(scene.gpuScene);
  done.rays = samples * (lumels + (bounces - 1) * (lumels - remembered));
  done.gathered = samples * lumels * bounces;
  estimate.parts = bakeWork(done);
  estimate.rays = done.directRays + done.rays;
  estimate.bytes = 4 * samples * remembered + lumels * (sizeof(shared::SurfacePoint) + 4 * sizeof(vec4));
  estimate.atMost = params.residual > 0;
  return estimate;
}

}  // namespace hl
