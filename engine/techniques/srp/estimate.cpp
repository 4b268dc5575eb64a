#include "engine/techniques/srp/estimate.h"

#include <algorithm>

#include "engine/techniques/srp/cpca.h"
#include "engine/techniques/srp/precomputation.h"
#include "shaders/shared/spherical_harmonics.h"

namespace hl {
namespace {

/// Rows and columns of a cluster's matrix, and the vectors that it keeps at most.
struct MatrixSize {
  double rows = 0, columns = 0, rank = 0;
};
MatrixSize sizeOf(const ReceiverCluster& c, const SrpParams& params, uint32_t coefficients) {
  MatrixSize s;
  s.rows = allRows(c, params), s.columns = static_cast<double>(c.probes.size()) * coefficients;
  s.rank = std::min({static_cast<double>(params.pca_vectors), s.rows, s.columns});
  return s;
}

}  // namespace

std::vector<WorkPart> transportWork(const ReceiverClusters& clusters, size_t first, size_t last, const SrpParams& params, uint32_t coefficients) {
  WorkPart rays, sums, decompositions;
  rays.name = "rays", rays.passes = {"srp: make rays", "srp: cast rays", "srp: ask probes", "srp: mutual visibility", "srp: weigh"};
  sums.name = "sums", sums.kind = WorkPart::Kind::Sums, sums.passes = {"srp: accumulate", "srp: accumulate radiance", "srp: read surfaces"};
  decompositions.name = "decompositions", decompositions.kind = WorkPart::Kind::Sums, decompositions.passes = {"srp: compress"};
  for (size_t i = first; i < last; ++i) {
    const ReceiverCluster& c = clusters.clusters[i];
    const double samples = static_cast<double>(c.receivers) * params.receiver_rays, questions = samples * c.slots;
    rays.amount += samples + questions;
    sums.amount += allRows(c, params) * static_cast<double>(params.receiver_rays) * c.slots * coefficients;
    const MatrixSize m = sizeOf(c, params, coefficients);
    decompositions.amount += params.compression == kCompressionNone ? m.rows * m.columns : decompositionWork(static_cast<uint32_t>(m.rows), static_cast<uint32_t>(m.columns), static_cast<uint32_t>(params.pca_vectors));
  }
  return {rays, sums, decompositions};
}

WorkPart probeRayWork(double rays) {
  WorkPart part;
  part.name = "probes' rays", part.amount = rays;
  part.passes = {"srp: make probes' rays", "srp: cast probes' rays", "srp: find lumels"};
  return part;
}

WorkPart surfaceShareWork(double probes, const SrpParams& params, uint32_t coefficients) {
  WorkPart part;
  part.name = "share of surfaces", part.kind = WorkPart::Kind::Sums, part.amount = params.surface_share ? probes * params.probe_rays * coefficients : 0;
  part.passes = {"srp: share of surfaces"};
  return part;
}

RebuildEstimate estimateTransport(const Device& device, const SceneView& scene, const SrpParams& params, double lumels, Progress& progress) {
  RebuildEstimate estimate;
  estimate.name = "transport";
  if (scene.atlas->lumels.empty() || scene.probes->count() == 0) return estimate;
  const auto coefficients = static_cast<uint32_t>(shared::shCount(params.sh_order));
  const ReceiverClusters clusters = Precomputation::clustersOf(scene, params, progress);
  // Receivers of another lightmap stand as densely as its texels: more clusters of the same size.
  const double scale = lumels / static_cast<double>(clusters.receivers());
  if (scale == 1) {
    checkFrameMemory(clusters, params, memoryLimits(device, scene));
    planWorkingMemory(clusters, params, scene.probes->count(), memoryLimits(device, scene));
  }
  size_t onDisk = 0;
  if (params.cache && scale == 1) onDisk = TransportStore(Precomputation::key(device, scene, params)).count(clusters.clusters.size());
  estimate.parts = transportWork(clusters, onDisk, clusters.clusters.size(), params, coefficients);
  for (WorkPart& part : estimate.parts) part.amount *= scale;
  const double probeRays = static_cast<double>(scene.probes->count()) * params.probe_rays;
  estimate.rays = estimate.parts.front().amount + probeRays;
  estimate.parts.push_back(probeRayWork(probeRays));
  if (onDisk < clusters.clusters.size()) estimate.parts.push_back(surfaceShareWork(static_cast<double>(scene.probes->count()), params, coefficients));
  estimate.bytesOfFrames = static_cast<double>(incidentBytes(clusters, params)) * scale;
  estimate.bytesMore = lumels * readsOf(params) * sizeof(shared::SrpRead);
  const double number = params.storage == kStorageFloat16 ? 2 : 4;
  for (const ReceiverCluster& c : clusters.clusters) {
    const MatrixSize m = sizeOf(c, params, coefficients);
    const double whole = m.rows * m.columns * number * scale;
    estimate.bytes += params.compression == kCompressionNone ? whole : m.rank * (m.rows + m.columns) * number * scale;
    estimate.bytesBefore += params.compression == kCompressionNone ? 0 : whole;
  }
  return estimate;
}

}  // namespace hl
