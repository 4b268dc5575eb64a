#include "engine/techniques/srp/memory_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/math.h"
#include "engine/techniques/srp/directional.h"
#include "engine/techniques/srp/hemisphere_basis.h"
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/spherical_harmonics.h"
#include "shaders/shared/surface_point.h"

namespace hl {
namespace {

/// Rays of a unit: some 50 ms of them on two cores; on a GPU a unit that is too small is all submission.
constexpr uint64_t kUnitRaysOnCpu = 1u << 16, kUnitRaysOnGpu = 1u << 22;
/// What every device takes as groups along y.
constexpr size_t kMostClusters = 65535;
/// Each question belongs to a ray, of which there are fewer the more slots a receiver has.
constexpr uint64_t kBytesARay = sizeof(shared::Ray) + sizeof(shared::Hit) + sizeof(float);
constexpr uint64_t kBytesAQuestion = sizeof(shared::Ray) + sizeof(uint32_t) + sizeof(float) + kBytesARay;

uint64_t mebibytes(uint64_t bytes) { return (bytes >> 20) + 1; }

}  // namespace

uint32_t rowsOf(const SrpParams& params) {
  if (params.receivers == kReceiversRadiance) return 1 + static_cast<uint32_t>(shared::hemisphereTerms(params.glossy_order));
  return params.receivers == kReceiversDirectional ? shared::kSrpDirectionalRows : 1;
}

uint32_t allRows(const ReceiverCluster& c, const SrpParams& params) { return c.receivers + (rowsOf(params) - 1) * c.wide; }

uint32_t readsOf(const SrpParams& params) {
  return params.sample_weight == kSampleWeightSurface ? static_cast<uint32_t>(std::min(params.surface_reads, params.receiver_rays)) : 0;
}

uint64_t WorkingMemory::bytes() const {
  return sizeof(shared::SurfacePoint) * points + sizeof(vec4) * probes + sizeof(vec2) * slopes + sizeof(float) * (surfaces + matrix + moments + 2 * receivers) +
         sizeof(shared::SrpTally) * receivers + sizeof(shared::SrpNear) * near + sizeof(shared::SrpStratum) * strata + kBytesAQuestion * questions;
}

WorkingMemory planWorkingMemory(const ReceiverClusters& clusters, const SrpParams& params, uint64_t probes, const MemoryLimits& limits) {
  if (clusters.clusters.size() > kMostClusters)
    throw Error(ErrorKind::TooLarge, fmt::format("srp: {} clusters are more than {}; raise srp.cluster_size", clusters.clusters.size(), kMostClusters));
  const auto coefficients = static_cast<uint64_t>(shared::shCount(params.sh_order));
  const uint64_t budget = static_cast<uint64_t>(params.precompute_memory_mb) << 20;
  WorkingMemory m;
  m.points = std::max<uint64_t>(1, clusters.receivers()), m.probes = std::max<uint64_t>(1, probes);
  if (params.surface_share) m.surfaces = m.probes * coefficients;
  if (params.receivers == kReceiversDirectional) m.slopes = kDirectionalEntries;
  for (const ReceiverCluster& c : clusters.clusters) {
    m.matrix = std::max(m.matrix, uint64_t{allRows(c, params)} * c.probes.size() * coefficients);
    m.near = std::max<uint64_t>(m.near, c.near.size());
    m.receivers = std::max<uint64_t>(m.receivers, c.receivers);
    if (params.receivers == kReceiversRadiance) m.moments = std::max(m.moments, uint64_t{c.wide} * (rowsOf(params) - 1));
    m.questions = std::max(m.questions, uint64_t{c.receivers} * c.slots);  // a unit takes at least one sample of each receiver
  }
  m.strata = std::max<uint64_t>(1, m.receivers * readsOf(params));
  // A decomposition holds its matrix in single precision and, for a while, three times in double; one is in work at least.
  const uint64_t decomposition = params.compression == kCompressionNone ? 8 * m.matrix : 28 * m.matrix;
  const uint64_t least = m.bytes() + decomposition;
  if (least > budget) {
    const bool table = sizeof(float) * m.surfaces > least / 2;
    throw Error(ErrorKind::BadInput, fmt::format("srp: a cluster of {} receivers needs {} MiB to be computed in{}, and srp.precompute_memory_mb is {}; lower {}", m.receivers, mebibytes(least),
                                                 table ? fmt::format(", with {} for the share of surfaces that {} probes see", mebibytes(sizeof(float) * m.surfaces), m.probes) : std::string(),
                                                 params.precompute_memory_mb, table ? "srp.sh_order or the number of probes, or switch srp.surface_share off" : "srp.cluster_size"));
  }
  if (sizeof(float) * m.surfaces > limits.largestBuffer)
    throw Error(ErrorKind::TooLarge, fmt::format("srp: the share of surfaces that {} probes see is {} MiB, more than a buffer of this device holds ({}); lower srp.sh_order or the number of probes", m.probes,
                                                 mebibytes(sizeof(float) * m.surfaces), limits.largestBuffer >> 20));
  if (const uint64_t most = std::max(sizeof(float) * m.matrix, m.questions * sizeof(shared::Ray)); most > limits.largestBuffer)
    throw Error(ErrorKind::TooLarge, fmt::format("srp: a cluster's {} MiB are more than a buffer of this device holds ({}); lower srp.cluster_size", mebibytes(most), limits.largestBuffer >> 20));
  const uint64_t wanted = std::min(limits.cpu ? kUnitRaysOnCpu : kUnitRaysOnGpu, limits.largestBuffer / sizeof(shared::Ray));
  m.questions = std::max(m.questions, std::min(wanted, m.questions + (budget - least) / kBytesAQuestion));
  const uint64_t left = budget - decomposition - m.bytes();
  // On a CPU device its rays and ours would only be in each other's way, and in that of the frames between.
  m.decompositions = limits.cpu ? 0 : static_cast<size_t>(std::clamp<uint64_t>(1 + left / decomposition, 1, limits.threads));
  return m;
}

uint64_t incidentBytes(const ReceiverClusters& clusters, const SrpParams& params) {
  if (params.receivers != kReceiversRadiance) return 0;
  uint64_t wide = 0;
  for (const ReceiverCluster& c : clusters.clusters) wide += c.wide;
  return sizeof(vec3) * wide * (rowsOf(params) - 1);
}

void checkFrameMemory(const ReceiverClusters& clusters, const SrpParams& params, const MemoryLimits& limits) {
  if (const uint64_t bytes = incidentBytes(clusters, params); bytes > limits.largestBuffer)
    throw Error(ErrorKind::TooLarge, fmt::format("srp: radiance at receivers on glossy surfaces is {} MiB, more than a buffer of this device holds ({}); lower srp.glossy_order or lightmap.resolution",
                                                 mebibytes(bytes), limits.largestBuffer >> 20));
}

}  // namespace hl
