#pragma once
// Transport coefficients alpha_ij (Bennett 2019, sections 4.4 and 5.6), cluster after cluster, in numbered units of some rays each.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/lightmap/tables.h"
#include "engine/techniques/srp/clusters.h"
#include "engine/techniques/srp/compressor.h"
#include "engine/techniques/srp/memory_plan.h"
#include "engine/techniques/srp/probe_samples.h"
#include "engine/techniques/technique.h"

namespace hl {

/// Of this device and these threads.
MemoryLimits memoryLimits(const Device&, const SceneView&);

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
  uint64_t workingBytes() const;   ///< on the device, triangles() and what is the lightmap's left out
  const Buffer& triangles() const { return triangles_; }  ///< empty after release()
  uint64_t hostBytes() const;      ///< results, receivers and their probes
  uint64_t raysCast() const { return raysCast_; }
  /// Clusters that are done here, those from disk left out: [first, last).
  std::pair<size_t, size_t> computed() const { return {fromDisk_, cluster_}; }
  uint32_t probesShared() const { return probesShared_; }  ///< probes whose share of surfaces was computed here
  /// What is computed together. @throws Error(Cancelled)
  static ReceiverClusters clustersOf(const SceneView&, const SrpParams&, Progress&);
  /// Of all that decides about the coefficients: what the file on disk is named by.
  static std::string key(const Device&, const SceneView&, const SrpParams&);

  /// How far in front of a surface rays start [m].
  static float rayOffset(const SceneView&);
  /// What units of all clusters have in common.
  static shared::SrpUnit unitOf(const SceneView&, const SrpParams&);
  /// Buffers of recordQuestions: receivers, their rays and hits, the slots of probes, all probes; rays to these, their shares and what hides them; denominators by ray.
  struct Questions {
    Buffer points, rays, hits, near, probes, triangles, questions, shares, blocked, scales;
  };
  /// What the unit's receivers see and which of their probes see it too, up to the kernel's denominator: "srp: make rays" to "srp: weigh".
  static void recordQuestions(FrameGraph&, const SceneView&, const shared::SrpUnit&, const Questions&);

 private:
  uint64_t unitsOf(const ReceiverCluster&) const;
  uint32_t samplesPerUnit(const ReceiverCluster&) const;
  void allocate(const SceneView&);
  void takeUp(std::shared_ptr<TransportStore>);
  void beginCluster(FrameGraph&);
  void recordRadiance(FrameGraph&, const shared::SrpUnit&);
  bool sharesWanted() const;
  uint32_t probesAUnit() const;
  void recordSurfaceShare(FrameGraph&);
  void recordCompression(FrameGraph&);

  /// All of WorkingMemory.
  template <class Self, class Each>
  static void forWorkingBuffers(Self& self, const Each& each) {
    for (auto* b : {&self.points_, &self.probes_, &self.near_, &self.rays_, &self.hits_, &self.questions_, &self.shares_, &self.blocked_, &self.scales_, &self.matrix_, &self.valid_, &self.tallies_, &self.strata_,
                    &self.answered_, &self.directional_, &self.surfaces_, &self.moments_})
      each(*b);
  }

  Device& device_;
  SceneView scene_;
  SrpParams params_;
  ReceiverClusters clusters_;
  std::shared_ptr<Compressor> compressor_;
  Buffer triangles_, lumelOfTexel_, points_, probes_, near_, rays_, hits_, questions_, shares_, blocked_, scales_, matrix_, valid_, tallies_, strata_, answered_, directional_, surfaces_, moments_;
  const ProbeSamples* samples_;   ///< null: not asked
  uint32_t probesShared_ = 0;     ///< whose share of surfaces is known
  uint32_t reads_ = 0;            ///< strata a receiver; 0: surfaces are not read
  uint64_t unitQuestions_ = 0;    ///< rays and questions of a unit at most
  size_t decompositions_ = 1;     ///< at once
  size_t cluster_ = 0;            ///< being computed
  uint32_t sample_ = 0;           ///< of that cluster, done
  uint64_t unitsDone_ = 0, unitsTotal_ = 0, fromDisk_ = 0, raysCast_ = 0;
  float offset_ = 0;
  uint32_t coefficients_ = 1, rows_ = 1;  ///< columns a probe; rows a wide receiver
};

}  // namespace hl
