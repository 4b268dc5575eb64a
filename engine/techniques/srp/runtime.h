#pragma once
// A frame: lightmap -> probes -> clusters -> receivers (Bennett 2019, section 5.1), as passes over matrices on the device.
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/lightmap/tables.h"
#include "engine/techniques/srp/cluster_transport.h"
#include "engine/techniques/srp/clusters.h"
#include "engine/techniques/srp/probe_samples.h"
#include "engine/techniques/technique.h"

namespace hl {

class SrpRuntime {
 public:
  /// `samples`: what the probes' rays hit. @throws Error(TooLarge) naming what does not fit
  SrpRuntime(Gpu&, const SceneView&, const SrpParams&, const ReceiverClusters&, std::span<const ClusterTransport>, const LightmapTables&, const ProbeSamples& samples);

  /// What can be known before precomputation. @throws Error(TooLarge) naming what does not fit
  static void check(const Device&, const SrpParams&, uint64_t probes);
  void restart(const SrpParams&);
  void lightsChanged();
  void setParams(const SrpParams& params) { params_ = params; }
  /// All passes of a frame up to irradiance().
  void record(FrameGraph&);

  uint32_t directSamples() const;
  const Buffer& irradiance() const { return irradiance_; }  ///< vec4 a lumel
  /// How it changes with the normal, where receivers are directional: LightmapImages::recordLinear's four a lumel.
  const Buffer& slopes() const { return slopes_; }
  bool directional() const { return params_.receivers == kReceiversDirectional; }
  const Buffer& direct() const { return direct_; }          ///< vec4 a lumel: sum; w: samples
  const Buffer& coefficients() const { return coefficients_; }  ///< vec4 a probe and coefficient
  std::vector<MemoryItem> memory() const;
  uint64_t matrixBytes() const;                             ///< of clusters' matrices as they are stored
  uint64_t readBytes() const;                               ///< of what receivers read off surfaces
  const Buffer& radiance() const { return radiance_; }      ///< vec4 a lumel
  /// RGB a receiver on a glossy surface and coefficient (hemisphere_basis.h, each times its norm), receivers in the order of clusters; empty where there is none.
  const Buffer& incident() const { return incident_; }
  struct Counts {
    uint32_t negative = 0, nonFinite = 0;                   ///< receivers
  };
  Counts counts() const;                                    ///< in the last frame. Blocking.

 private:
  static constexpr uint32_t kSlopes = 4;  ///< a lumel: of red, green and blue, and the constants
  struct Page {
    Buffer words;
    uint32_t firstCluster = 0, clusters = 0, mostRank = 0, mostReceivers = 0, mostWide = 0;
  };
  void uploadPages(const ReceiverClusters&, std::span<const ClusterTransport>);
  void uploadReads(std::span<const ClusterTransport>);
  void recordDirect(FrameGraph&);
  void recordProbes(FrameGraph&);
  void recordClusters(FrameGraph&);

  Device& device_;
  SceneView scene_;
  SrpParams params_;
  uint32_t lumels_ = 0, probes_ = 0, coefficientCount_ = 1, parts_ = 1;
  std::vector<Page> pages_;
  Buffer points_, reflectance_, direct_, irradiance_, slopes_, directionalTable_, noIrradiance_, radiance_, codes_, basis_, partSums_, coefficients_, clusters_, clusterProbes_, vectors_, lumelOfReceiver_, firstRead_, reads_, counters_;
  Buffer incident_;
  uint32_t wide_ = 0, terms_ = 0;  ///< receivers on glossy surfaces, coefficients of each
  bool anyReads_ = false;
  uint32_t directSample_ = 0, frame_ = 0;
  bool clearWanted_ = true, clearDirectWanted_ = true;
};

}  // namespace hl
