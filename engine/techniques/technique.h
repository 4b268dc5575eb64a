#pragma once
// What a global illumination technique is to the rest of the program (DESIGN.md sections 1 and 3).
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/progress.h"
#include "engine/gpu/frame_graph.h"
#include "engine/lightmap/atlas.h"
#include "engine/params/groups.h"
#include "engine/params/param.h"
#include "engine/passes/direct_light.h"
#include "engine/passes/gbuffer.h"
#include "engine/placement/placement.h"
#include "engine/scene/gpu_scene.h"
#include "engine/techniques/rebuild_estimate.h"
#include "engine/techniques/transport.h"
#include "engine/trace/tracer.h"

namespace hl {

struct Gpu {
  Device& device;
  ShaderLibrary& shaders;
};

/// What may change under a technique while it runs.
enum class Change {
  Camera,    ///< another camera, or the same one moved
  Lights,    ///< punctual lights, sky or emission
  Geometry,  ///< vertices of moving objects, within the same triangles
};

/// The loaded scene in every form that a technique may use. Lives at least as long as the technique.
struct SceneView {
  const Scene& scene;
  const SceneFeatures& features;
  const GpuScene& gpuScene;
  Tracer& tracer;
  DirectLight& directLight;
  TaskPool& pool;
  const Atlas* atlas = nullptr;      ///< where Needs::lightmap
  const LightmapParams& lightmap;
  const DirectParams& direct;
  uint32_t seed = 1;
  const PlacedProbes* probes = nullptr;  ///< where Needs::probes
};

struct FrameInputs {
  const GBuffer& gbuffer;
  uint32_t frame = 0;                ///< since the last reset
  uint32_t seed = 1;
  std::string_view view = {};        ///< the view on screen: what only one debug view shows is recorded for that view alone
  Camera camera = {}, previousCamera = {};  ///< of this frame and of the one before; the same in the first frame
  double time = 0, previousTime = 0;        ///< [s] of the scene's animations; a function of the frame's number alone
  uint32_t sinceChange = 0;                 ///< frames since the last reset, or the last change that the technique follows
  bool cameraMoved = false;                            ///< since the frame before
  bool lightsChanged = false, geometryMoved = false;   ///< since the technique's frame before
};

/// Both RGBA32F at G-buffer pixels.
struct IndirectLight {
  GpuImage irradiance;  ///< indirect irradiance [W/m^2]
  /// Indirect radiance that the glossy lobe reflects towards the camera [W/(sr m^2)]: lobe (shaders/shared/ggx.h with GBuffer::specular), Fresnel term and cosine included; 0 where the
  /// surface is not glossy. Of the same light as the irradiance: what surfaces reflect; emission and sky seen in the lobe are direct light. Empty where the scene has no glossy
  /// surfaces, or the technique does not model them (Transport::glossyLastBounce).
  GpuImage specular = {};
};

struct MemoryItem {
  std::string name;
  uint64_t bytes = 0;
};

/// An image or overlay for the viewport, of G-buffer size unless `lightmap`.
struct DebugView {
  std::string id, label;
  GpuImage image;
  bool lightmap = false;             ///< the image is the lightmap itself
  bool irradiance = true;            ///< scene-referred (exposure and tone map apply); else shown as it is
};

/// Long work in numbered units (bake, precomputation). What a unit computes never depends on time.
struct WorkState {
  uint64_t done = 0, total = 0;      ///< units; equal: settled
  std::string label;                 ///< "bounce 3 of 8"
  double residual = 0;
  bool settled() const { return done >= total; }
};

/// A surface point the person picked, and why it looks as it does.
struct PickedPoint {
  vec3 position{0.0f}, normal{0.0f};
  uint32_t triangle = kNone;
  vec2 lightmapUv{0.0f};
  int x = 0, y = 0;
};
struct PickSample {
  vec3 from{0.0f}, to{0.0f};
  vec3 radiance{0.0f};
  float weight = 0;
};
struct PickReport {
  std::vector<std::pair<std::string, std::string>> facts;  ///< "texel", "(12, 40)"
  std::vector<PickSample> samples;
};

class Technique {
 public:
  struct Needs {
    bool lightmap = false;
    bool motion = false;             ///< GBuffer::motion
    bool probes = false;             ///< SceneView::probes, placed by the parameters probes.*
  };
  virtual ~Technique() = default;
  virtual Needs needs() const { return {}; }
  virtual ParamView params() = 0;
  virtual Transport transport() const = 0;
  /// Allocation and precomputation after a scene, resolution or Rebuild-parameter change. @throws Error(BadInput) for settings that make no sense together.
  virtual void rebuild(Gpu&, const SceneView&, Progress&) = 0;
  /// What rebuild() and the work after it would take with the parameters as they stand, of a technique that precomputes; also before the first rebuild. `lumels`: as many as
  /// the lightmap will have, where the atlas is still that of another resolution. Takes the time of looking for receivers' probes at most, and leaves the technique as it is.
  /// @throws Error(BadInput) as rebuild().
  virtual RebuildEstimate rebuildEstimate(const Device&, const SceneView&, double /*lumels*/, Progress&) const { return {}; }
  /// Of the same parts what units of work have done since the last rebuild or reset: the session learns their speed from it.
  virtual std::vector<WorkPart> workDone() const { return {}; }
  /// A Reset-parameter changed, or something that the technique does not follow: histories and work start again, allocations stay.
  virtual void reset() {}
  /// Whether the technique carries its caches through such a change, and converges to what is new by itself. Where it does not, it is reset by another
  /// camera or light. What an animation does to lights and geometry it is spared while the time runs: its cache belongs to the moment it was made in (the
  /// session says which), and is made anew, after geometry with `rebuild`, once the time stands still.
  virtual bool follows(Change) const { return false; }
  virtual WorkState work() const { return {}; }
  /// Records the next unit of work(), at most about 50 ms of it on a CPU device; called between frames while it has not settled.
  virtual void recordWork(FrameGraph&) {}
  /// Frames since the last reset, or since the last change that was followed without one, from which on the picture counts as settled: for
  /// techniques that converge over frames. A function of parameters and scene alone, never of time.
  virtual uint32_t framesToSettle() const { return 0; }
  virtual IndirectLight record(FrameGraph&, const FrameInputs&) = 0;
  virtual std::vector<DebugView> debugViews() const { return {}; }
  virtual std::vector<MemoryItem> memory() const { return {}; }
  /// Bytes that a frame's passes have to move through memory, by pass: what they read and write at least, each once. Of passes that do little else.
  virtual std::vector<MemoryItem> bytesMoved() const { return {}; }
  /// Counters since the last reset: "back_face_hits", "invalid_texels", ... Read between frames.
  virtual std::vector<std::pair<std::string, double>> counters() const { return {}; }
  virtual PickReport pick(const PickedPoint&) { return {}; }
  /// The technique's irradiance by lumel, in the atlas's order, RGB; empty where it has no lightmap. Blocking.
  virtual std::vector<vec3> lightmapIrradiance() { return {}; }
};

struct TechniqueInfo {
  std::string_view id, label, summary;
  std::unique_ptr<Technique> (*create)();
};
/// All techniques, `none` (direct light only) first. CMake writes it from the folders: each has technique.cmake, and defines
/// `TechniqueInfo <id>TechniqueInfo()`.
std::span<const TechniqueInfo> techniqueInfos();
/// @throws Error(BadInput) naming the nearest known id.
const TechniqueInfo& techniqueInfo(std::string_view id);

}  // namespace hl
