#pragma once
// What a Session holds. Seen by the session's own files alone.
#include <chrono>
#include <functional>
#include <map>
#include <optional>

#include "engine/core/task_pool.h"
#include "engine/params/groups.h"
#include "engine/passes/direct_light.h"
#include "engine/passes/display.h"
#include "engine/passes/gbuffer.h"
#include "engine/scene/scene_pose.h"
#include "engine/session/session.h"
#include "engine/session/work_rates.h"
#include "engine/trace/embree_scene.h"

namespace hl {

/// A reference that is being traced, or is done: against all light paths, or limited to those the technique models.
struct ReferenceRun {
  std::unique_ptr<ReferenceTracer> tracer;
  std::shared_ptr<const ReferenceResult> result;  ///< of the last whole pass
  double ms = 0;                                  ///< spent on it here

  /// From what the cache holds of it; nothing where it has been started.
  void start(const std::shared_ptr<const EmbreeScene>&, std::vector<Receiver>, int width, int height, const ReferenceSettings&, TaskPool&);
  /// A unit. The last one puts it into the cache.
  void advance(Progress&);
  /// Forgets it; what was traced goes to the cache first where it took long enough to be missed.
  void drop();
};

/// What an error is of: indirect irradiance, indirect specular radiance, the picture.
enum class Component { Indirect, Specular, Final };
inline constexpr const char* kComponentNames[] = {"indirect", "specular", "final"};

/// What the host needs of the G-buffer to see a picture as the composite pass does. Images have 4 channels.
struct SurfaceImages {
  Image position, geometricNormal, albedo, emission;
  Image specular;  ///< GBuffer::specular; without pixels where the scene has no glossy surfaces
  vec3 sky{0.0f};
  std::vector<vec3> map;  ///< radiance of the environment map by pixel; empty without one

  bool seen(size_t pixel) const { return position.data[pixel * 4 + 3] != 0; }
  /// Emission, irradiance times albedo / pi, and what lobes reflect of direct (`highlights`) and indirect light (without pixels: none); where no surface is seen, the sky. 3 channels.
  Image composite(const Image& direct, const Image& indirect, const Image& highlights, const Image& lobes) const;
  ReferenceImage composite(const ReferenceImage& direct, const ReferenceImage& indirect, const ReferenceImage& highlights, const ReferenceImage& lobes) const;
  /// For a reference of such light at these pixels.
  std::shared_ptr<const ReferenceSurfaces> ofReference(Component) const;
  Mask glossy() const;  ///< pixels whose surface has a lobe
};

/// Pixels that see a surface, from the G-buffer's positions.
Mask maskOf(const Image& position);
bool anySet(const Mask&);

/// @throws Error(BadInput) naming the cameras there are, where the scene has none of that name ("" is its first).
void checkCamera(const Scene&, const std::string& name);
/// @throws Error(BadInput)
void checkPlayback(const Scene&, const Playback&);

/// The part of a rebuild that comes before its units of work, among WorkRates: its amount is lumels.
inline constexpr const char* kAllocation = "allocation";

struct Session::Impl {
  explicit Impl(const SessionOptions&);
  ~Impl();

  SessionOptions options;
  std::shared_ptr<Progress> progress = std::make_shared<Progress>();
  Device device;
  ShaderLibrary shaders;
  std::shared_ptr<Presenter> presenter;
  TaskPool pool;
  FrameGraph graph;

  // The scene and what is derived from it. Order matters: later members refer to earlier ones.
  std::shared_ptr<Scene> scene;
  std::shared_ptr<const Scene> summary;  ///< published with results
  SceneFeatures features;
  std::vector<Region> sceneRegions;      ///< as the scene's file has them
  std::vector<vec3> sceneProbes;         ///< likewise
  std::string transportKey;               ///< of the paths the matched reference was limited to
  bool smoothNormals = false;            ///< some vertex normal differs from its triangle's: mapped and geometric receivers differ
  std::shared_ptr<EmbreeScene> embree;
  GpuScene gpuScene;
  std::unique_ptr<Tracer> tracer;
  std::unique_ptr<DirectLight> directLight;
  std::optional<Atlas> atlas;
  std::shared_ptr<const PlacedProbes> placed;  ///< made anew only where scene or probes.* changed
  Buffer cornerUvs;

  Preset preset;  ///< scene, camera, resolution, seed, technique, display; parameters live in the groups below
  LightmapParams lightmap;
  ProbesParams probes;
  DirectParams direct;
  ReferenceParams reference;
  std::unique_ptr<Technique> technique;
  std::optional<SceneView> view;
  ParamSet params;
  std::map<std::string, std::map<std::string, std::string>> otherTechniques;  ///< parameters of techniques that are not shown now

  bool atlasStale = true, probesStale = true, techniqueStale = true, resetWanted = true;
  bool held = false;           ///< a rebuild was cancelled or failed: frames go on without indirect light until restartWork()
  bool workStopped = false, workPaused = false, referenceWanted = false, referenceStopped = false;
  bool serialisedTiming = false;
  std::string message;
  ErrorKind heldKind = ErrorKind::Run;  ///< of what `held` is about
  std::function<void(const RebuildForecast&)> onRebuild;

  // What changed since the last frame, and what the technique did not follow while the time ran.
  bool cameraMoved = false, lightsMoved = false, geometryMoved = false, measureAnew = false;
  std::optional<Camera> previousCamera;  ///< none before the first frame of a scene
  double time = 0, previousTime = 0;
  ScenePose pose;               ///< the scene at rest
  uint64_t clockFrame = 0;      ///< frames since the time was set
  BatchTimings momentTimings;   ///< of what brought geometry to this frame's moment
  bool embreeStale = false;     ///< geometry moved since Embree's structures were made
  bool geometryMissed = false, lightsMissed = false;  ///< moved, and the technique does not follow
  double madeAt = 0;            ///< the moment that the technique's caches belong to

  uint64_t frameNumber = 0;
  uint32_t frameSinceReset = 0;
  uint32_t frameSinceChange = 0;  ///< since the last reset, or the last change that the technique follows without one
  double msSinceReset = 0, prepareMs = 0, settledMs = 0;
  uint32_t settledFrames = 0;
  Profiler frameProfiler, workProfiler;
  BatchTimings lastTimings;
  double workMs = 0;           ///< in the current bake, for the time left
  std::map<std::string, double> workPassMs;  ///< of its passes, in all, as long as it has not settled
  WorkRates rates;
  double atlasMs = 0;          ///< that the atlas took, when it was last made
  double measuredTraceRate = 0;  ///< [1e6 rays/s] in this scene; 0: not measured
  /// Probes that were placed for a forecast, with what they depend on beside the scene.
  struct ProbeCandidate {
    ProbesParams params;
    std::vector<vec3> manual;
    std::shared_ptr<const EmbreeScene> embree;
    std::shared_ptr<const PlacedProbes> placed;
    bool fits(const ProbesParams&, const std::vector<vec3>& manual, const EmbreeScene*) const;
  };
  std::optional<ProbeCandidate> candidate;
  uint64_t workUnitsTimed = 0;
  double referenceMs = 0, referenceStart = 0;

  GBuffer gbuffer;
  GpuImage directImage, directSpecularImage, indirectImage, specularImage, finalImage, displayImage;
  Buffer displayCounters;
  uint32_t nonFinite = 0, negative = 0;
  std::vector<std::string> imagesWanted;
  /// Of a reference's result and a number of bounces: they stay the same from frame to frame.
  struct KeptImage {
    std::shared_ptr<const ReferenceResult> result;
    int bounces = 0;
    bool lobes = false;  ///< glossy last bounces are among them
    std::shared_ptr<const ReferenceImage> image;
  };
  std::map<std::string, KeptImage> keptImages;
  std::optional<std::pair<int, int>> pickPixel;
  PickReport pickReport;
  PickedPoint picked;
  std::optional<uint32_t> pickedProbe;

  ReferenceRun full, matched, lightmapRun;
  std::vector<ErrorValue> errors;
  std::shared_ptr<const std::vector<ConvergencePoint>> convergence = std::make_shared<std::vector<ConvergencePoint>>();
  double lastMeasurementMs = -1e9, measurementMs = 0;  ///< when the last one was due; what it took
  bool measuredSettled = false;  ///< the errors are those of the settled state
  int framesToMeasure = 0;       ///< until a settled picture that is shown in another way is measured again; 0: it need not be

  // edits.cpp
  void install(std::shared_ptr<Scene>, Progress&);
  void makeTechnique(const std::string& id);
  void collectParams();
  void want(Effect);
  void changed(Change);
  void lightsChanged();
  void summarise();
  void referenceStale();
  void cameraChanged();
  std::map<std::string, std::string> changedParams() const;
  Camera camera() const;
  float sliceMs();

  // playback.cpp
  bool timeRuns() const;
  void moveToMoment();
  void freshEmbree();
  void addMomentTimings(BatchTimings&);
  std::string momentNote() const;

  // long_work.cpp
  void prepare(Progress&);
  void buildLightmap(Progress&);
  void placeProbes(Progress&);
  void runWork(double budgetMs, Progress&);
  /// A slice of it, as part of all that preparation and work may take. @throws Error(Run) where that is over.
  void runWorkWithin(double limitMs, Progress&);
  void checkLimit(double limitMs) const;
  bool framesAreWork() const;            ///< the technique converges over frames
  double shownMs(double frameMs) const;  ///< see FrameResult::settledMs
  void runReference(double budgetMs, Progress&);
  bool workSettled() const;
  bool techniqueSettled() const;  ///< its work, and the frames it takes to converge
  bool motionWanted() const;
  bool referencesStarted() const;
  bool referencesSettled() const;
  void startReferences();
  bool referenceShared() const;  ///< full and matched differ in the number of bounces alone
  int fullBounces() const { return reference.bounces > 0 ? reference.bounces : kAllBounces; }
  ReferenceSettings referenceSettings(bool matchedPaths) const;

  // rebuild_forecast.cpp
  RebuildForecast forecastOf(const Technique&, const SceneView&, double lumels, bool atlasAnew, bool betweenFrames, Progress&);
  std::shared_ptr<const PlacedProbes> placeCandidate(const ProbesParams&, const std::vector<vec3>& manual, Progress&);
  std::string workName() const;
  double sceneTraceRate(Progress&);
  void learnRates();

  // frame.cpp
  void addConvergencePoint();

  // errors.cpp
  std::vector<std::pair<std::string, Mask>> regionMasks(const Mask& surfaces) const;  ///< the whole image ("") first, then each region that shows a surface
  Appearance appearance() const;  ///< of the picture as it is shown
  Image errorMap(const std::string& metric, bool againstFull);

  // images.cpp
  std::vector<Receiver> receivers();
  SurfaceImages surfaceImages();
  Mask surfaceMask();          ///< without the rest of surfaceImages()
  Image indirectIrradiance();  ///< at pixels, 4 channels; 0 where the technique gave none
  Image indirectSpecular();    ///< likewise; without pixels where the scene has no glossy surfaces
  Image directSpecular();      ///< likewise
  int bouncesOf(bool matchedPaths) const { return matchedPaths ? technique->transport().bounces : fullBounces(); }
  /// Of a run, by the number of bounces and by whether lobes are among the paths.
  ReferenceImage lobesOf(const ReferenceRun&, bool matchedPaths) const;
  bool showHostView(FrameResult&);
  // probe_views.cpp
  void pickProbe();
  bool showProbeView(FrameResult&);
  void publishPicture(FrameResult&);
  void publishImages(FrameResult&);
  const ReferenceRun* matchedRun() const;  ///< null as long as it has no picture
  std::vector<std::string> imageNames() const;
  /// By the names that begin with "reference". @throws Error(BadInput) where there is none yet.
  ReferenceImage referenceImage(const std::string& view);
  Image linearImage(const std::string& view);
};

inline double nowMs() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace hl
