#pragma once
// The bake: direct light at lumels, then bounce after bounce, in numbered units.
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/lightmap/tables.h"
#include "engine/passes/lightmap_images.h"
#include "engine/techniques/radiosity/host_units.h"
#include "engine/techniques/radiosity/params.h"
#include "engine/techniques/technique.h"

namespace hl {

class RadiosityBake {
 public:
  /// Allocates everything. @throws Error(TooLarge) naming what does not fit; Error(Cancelled)
  RadiosityBake(Gpu&, const SceneView&, const RadiosityParams&, Progress&);

  /// Light or parameters changed. What rays hit is kept as long as it is still true.
  void restart(const RadiosityParams&);
  WorkState work() const;
  void recordUnit(FrameGraph&);
  /// Brings the lightmap's images up to date with what units have done. Its own texels, and then the dilated ones.
  void recordImages(FrameGraph&);

  uint32_t lumels() const { return lumels_; }
  LightmapImages& images() { return *images_; }
  const GpuImage& directLightmap() const { return directImage_; }
  const Buffer& irradiance() const { return irradiance_; }

  /// What units have done since the start.
  struct Done {
    double directRays = 0, rays = 0, gathered = 0;  ///< gathered: samples, remembered or cast
  };
  const Done& workDone() const { return workDone_; }
  /// Lumels whose hits are remembered: the first so many.
  static uint64_t rememberedLumels(uint64_t lumels, const RadiosityParams&);
  /// Rays that direct light takes at a lumel and a sample, at most.
  static uint32_t directRays(const GpuScene&);
  static uint32_t directSamples(const SceneView&);

  std::vector<MemoryItem> memory() const;
  std::vector<std::pair<std::string, double>> counters() const;
  PickReport pick(uint32_t lumel);

 private:
  struct Piece {
    uint32_t first = 0, count = 0;
    bool cached = false;    ///< what its rays hit is remembered
    bool remember = false;  ///< what they hit is to be remembered
  };
  Piece pieceAt(uint32_t lumel, uint32_t cached) const;
  uint64_t piecesFrom(uint32_t lumel, uint32_t cached) const;
  uint64_t directUnits() const;
  bool settled() const;
  void checkSize(const char* what, uint64_t bytes) const;
  std::vector<vec4> makeDirections(Progress&);
  void allocateCache();
  void uploadPoints();
  void recordClears(FrameGraph&);
  void recordDirect(FrameGraph&);
  void recordPiece(FrameGraph&, const Piece&);
  void recordCast(FrameGraph&, const Piece&, const Buffer& codes, uint32_t codeBase);
  void recordGather(FrameGraph&, const Piece&, const Buffer& codes, uint32_t codeBase);
  void recordReflect(FrameGraph&);
  void recordResidual(FrameGraph&);

  Device& device_;
  ShaderLibrary& shaders_;
  SceneView scene_;
  RadiosityParams params_;
  uint32_t lumels_ = 0, resolution_ = 0;
  uint32_t castLumels_ = 0, cachedLumels_ = 0;  ///< lumels a unit, with rays and without

  Buffer points_, reflectance_, triangles_, directions_;
  std::unique_ptr<LightmapImages> images_;
  Buffer direct_, irradiance_, radiance_, counters_;
  Buffer rays_, hits_, codes_;       ///< rays and hits: where they are not made and used on the host
  std::shared_ptr<HostUnits> host_;   ///< where rays are cast on the host, and that is the device too
  std::vector<Buffer> cache_;
  uint32_t lumelsPerCache_ = 0, cacheCapacity_ = 0;
  GpuImage directImage_;

  float offset_ = -1;
  uint32_t cached_ = 0;          ///< lumels from the start whose hits are remembered
  bool clearWanted_ = true, imageStale_ = true, directImageStale_ = true;
  uint32_t directSample_ = 0, directFirst_ = 0;
  int bounce_ = 0;               ///< complete ones
  uint32_t next_ = 0;            ///< first lumel of the current bounce still to do
  uint64_t done_ = 0;
  Done workDone_;
  struct Outcome {
    double residual = 1;
    bool converged = false;
  };
  std::shared_ptr<Outcome> outcome_ = std::make_shared<Outcome>();
};

}  // namespace hl
