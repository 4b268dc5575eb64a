#pragma once
// Transport coefficients alpha_ij (Bennett 2019, sections 4.4 and 5.6), cluster after cluster, in numbered units of some rays each.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/lightmap/tables.h"
#include "engine/techniques/srp/clusters.h"
#include "engine/techniques/srp/compressor.h"
#include "engine/techniques/srp/probe_samples.h"
#include "engine/techniques/technique.h"

namespace hl {

/// Lumels that a receiver reads at most.
uint32_t readsOf(const SrpParams&);
/// Rows of transport that a wide receiver has: of directional receivers all are, of radiance receivers those on glossy surfaces.
uint32_t rowsOf(const SrpParams&);
uint32_t allRows(const ReceiverCluster&, const SrpParams&);

class Precomputation {
 public:
  /// Clusters, working memory, and what the cache on disk has. `triangles`, `lumelOfTexel`: of LightmapTables, on the device.
  /// @throws Error(TooLarge), or Error(BadInput) where a parameter is at fault, naming what does not fit, and what would; Error(Cancelled)
  /// `samples`: what probes see, which has to be known before the first unit; it lives as long as this. Null only without SrpParams::surface_share.
  Precomputation(Gpu&, const SceneView&, const SrpParams&, const Buffer& triangles, const Buffer& lumelOfTexel, const ProbeSamples* samples, Progress&);

  WorkState work() const;
  void recordUnit(FrameGraph&);

  const ReceiverClusters& clusters() const { return clusters_; }
  const std::vector<ClusterTransport>& transport() const { return compressor_->finished(); }
  /// Drops the working memory; to be called once work() has settled.
  void release();
  uint64_t clustersFromDisk() const { return fromDisk_; }
  uint64_t workingBytes() const;   ///< on the device
  uint64_t hostBytes() const;      ///< results, and the probes of receivers
  uint64_t raysCast() const { return raysCast_; }
  /// Clusters that are done here, those from disk left out: [first, last).
  std::pair<size_t, size_t> computed() const { return {fromDisk_, cluster_}; }
  /// What is computed together. @throws Error(Cancelled)
  static ReceiverClusters clustersOf(const SceneView&, const SrpParams&, Progress&);
  /// Of all that decides about the coefficients: what the file on disk is named by.
  static std::string key(const Device&, const SceneView&, const SrpParams&);

 private:
  uint64_t unitsOf(const ReceiverCluster&) const;
  uint32_t samplesPerUnit(const ReceiverCluster&) const;
  void allocate(const SceneView&);
  void takeUp(std::shared_ptr<TransportStore>);
  void beginCluster(FrameGraph&);
  void recordRadiance(FrameGraph&, const shared::SrpUnit&);
  void recordSurfaceShare(FrameGraph&);
  void recordCompression(FrameGraph&);

  Device& device_;
  SceneView scene_;
  SrpParams params_;
  ReceiverClusters clusters_;
  std::shared_ptr<Compressor> compressor_;
  Buffer triangles_, lumelOfTexel_, points_, probes_, near_, rays_, hits_, questions_, shares_, blocked_, scales_, matrix_, valid_, strata_, answered_, directional_, surfaces_, moments_;
  const ProbeSamples* samples_;   ///< null: not asked
  bool surfacesKnown_ = false;
  uint32_t reads_ = 0;            ///< strata a receiver; 0: surfaces are not read
  uint64_t unitQuestions_ = 0;    ///< rays and questions of a unit at most
  size_t compressions_ = 1;       ///< at once
  size_t cluster_ = 0;            ///< being computed
  uint32_t sample_ = 0;           ///< of that cluster, done
  uint64_t unitsDone_ = 0, unitsTotal_ = 0, fromDisk_ = 0, raysCast_ = 0;
  float offset_ = 0;
  uint32_t coefficients_ = 1, rows_ = 1;  ///< columns a probe; rows a wide receiver
};

}  // namespace hl
