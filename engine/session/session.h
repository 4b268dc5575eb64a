#pragma once
// The one path: window, command line, tests and benchmarks drive the same Session. It belongs to one thread.
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/image.h"
#include "engine/core/progress.h"
#include "engine/experiment/preset.h"
#include "engine/gpu/device.h"
#include "engine/gpu/profiler.h"
#include "engine/metrics/metrics.h"
#include "engine/params/param.h"
#include "engine/reference/progressive_tracer.h"
#include "engine/reference/reference.h"
#include "engine/scene/scene.h"
#include "engine/session/rebuild_forecast.h"
#include "engine/techniques/technique.h"

namespace hl {

class Presenter;

struct SessionOptions {
  DeviceOptions device;
  std::string tracer = "auto";
};

struct ErrorValue {
  std::string reference;  ///< "matched" or "full"
  std::string target;     ///< "image" or "lightmap"
  std::string component;  ///< "indirect" (irradiance), "specular" (radiance by lobes, over the pixels that show a glossy surface) or "final"
  std::string metric;
  double value = 0, noiseFloor = 0, standardError = 0;
  uint64_t nonFinite = 0;
  std::string roi;        ///< "" for the whole image
};

/// A sudden change whose transient is followed: all lights and the sky times a factor, another moment of the scene's animations (a door that is open), a cut to
/// another camera, or a parameter.
struct Step {
  std::string key, value;  ///< "lights", "time", "camera", or a parameter's key
  float factor = 1;        ///< of the lights; or the moment [s]
  bool ofLights() const { return key == "lights"; }
  bool ofTime() const { return key == "time"; }
  bool ofCamera() const { return key == "camera"; }
  bool ofParameter() const { return !ofLights() && !ofTime() && !ofCamera(); }
};
/// "lights=FACTOR", "time=SECONDS", "camera=NAME" or "KEY=VALUE". @throws Error(BadInput)
Step parseStep(const std::string& text);

/// How the indirect light follows a step. Frames count from 1, milliseconds from the edit.
struct StepReport {
  double size = 0;                         ///< rms of what the step changes in the indirect irradiance, at the pixels that show a surface after it; after a
                                           ///< cut, where there is no picture before, rms of the settled picture itself. 0: nothing, and nothing to follow
  std::optional<uint64_t> frames5, frames1;  ///< from which on at most 5 %, 1 % of it are left; none: not within the frames that were rendered
  std::optional<double> ms5, ms1;
  std::vector<double> left;                ///< by frame
  double noise = 0;                        ///< share of the step that frames of the settled picture leave by their own noise: `left` falls no lower
  /// The same of the image's mean, which noise of single pixels hardly moves.
  std::vector<double> meanLeft;
  std::optional<uint64_t> meanFrames5, meanFrames1;
  bool settled = false;                    ///< at the last of them
};

struct Provenance {
  std::string commit, presetHash, sceneHash, device, driver, api, tracer, timing;
  bool dirty = false;
  uint32_t seed = 1;
};

/// Where long work stands; published with each frame.
struct WorkReport {
  std::string label;        ///< "radiosity: bounce 3 of 8", "reference"
  double done = 1;          ///< 0 to 1
  double secondsLeft = -1;  ///< unknown
  bool running = false;
};

struct ConvergencePoint {
  uint64_t frame = 0;
  double ms = 0;            ///< of work since the reset, frames and units
  double shownMs = 0;       ///< as FrameResult::settledMs would be, had the work ended here
  std::vector<ErrorValue> errors;
};

/// Everything about a finished frame. Immutable once published; shared between threads.
struct FrameResult {
  uint64_t number = 0;               ///< frames since the session started
  uint32_t frame = 0;                ///< frames since the last reset
  int width = 0, height = 0;
  double time = 0;                   ///< [s] of the scene's animations
  bool playing = false;
  Camera camera;                     ///< that it was seen with
  std::vector<unsigned char> display;  ///< RGBA8, rows from the top: the chosen view, tone mapped; empty while a Presenter shows it and nobody wants "display"
  std::string displayHash;             ///< "" without it
  std::string view;
  double publishMs = 0;              ///< that bringing the picture to the host, to a window or to both took; no part of the frame's time
  PassStatistics frameTime;
  double unaccounted = 0;            ///< share of a frame's time that is in no pass (median); above a tenth the passes' times do not tell the whole
  double prepareMs = 0;              ///< that the lightmap's atlas and the technique's allocation and precomputation took, when they were last needed
  double workMs = 0;                 ///< that units of long work have taken since the reset
  uint64_t workUnits = 0;            ///< ... and how many
  double sinceResetMs = 0;           ///< frames and units of work since the reset
  uint32_t settledFrames = 0;        ///< frames since the reset with the first that shows the technique's finished work; 0 before it. Direct light may take more
  double settledMs = 0;              ///< units of work and that frame: frames that show work unfinished are not its own. Of a technique that converges over frames: sinceResetMs
  std::vector<PassStatistics> passes;     ///< of frames
  std::vector<PassStatistics> workPasses; ///< of the units of long work
  std::vector<PassTiming> lastPasses;     ///< of this frame alone
  std::vector<MemoryItem> memory;
  std::vector<MemoryItem> bytesMoved;  ///< by pass, of a frame; of those that move data and do little else
  std::vector<std::pair<std::string, double>> counters;
  WorkReport technique, reference;
  std::vector<ErrorValue> errors;    ///< as of the last measurement
  std::shared_ptr<const std::vector<ConvergencePoint>> convergence = std::make_shared<std::vector<ConvergencePoint>>();
  bool settled = false;              ///< nothing would change with further frames
  Provenance provenance;
  std::string message;               ///< what went wrong (a technique that failed, a shader that did not compile), or ""
  bool techniqueFailed = false;      ///< its preparation was cancelled or failed: there is no indirect light in the picture
  ErrorKind failure = ErrorKind::Run;  ///< ... of which kind; `message` is the error's
  PickReport pick;
  PickedPoint picked;                ///< of the last pick(); `triangle` is kNone where the pixel shows no surface
  std::shared_ptr<const Scene> scene;  ///< names, materials, lights, cameras, regions, bounds and report; geometry and textures left out
  SceneFeatures features;
  uint64_t triangles = 0;
  AtlasReport atlas;                 ///< zero where the technique has no lightmap
  std::shared_ptr<const PlacedProbes> probes;  ///< null where the technique needs none
  std::optional<uint32_t> pickedProbe;         ///< of these, by the last pick()
  Preset preset;                     ///< as it stands
  /// What setImagesWanted() named, of this frame: linear, 3 channels. Those of a reference are missing as long as there is none.
  std::map<std::string, std::shared_ptr<const Image>> images;
  /// Of these images a reference's, with their halves: errors against them are free of the reference's own variance.
  std::map<std::string, std::shared_ptr<const ReferenceImage>> references;
  std::shared_ptr<const Mask> surfaces;  ///< pixels that see a surface, which errors are means over; null where no image is wanted
  std::shared_ptr<const Mask> glossy;    ///< those of them that see a glossy surface, where an image of lobes' light is wanted, whose errors are means over these
};

class Session {
 public:
  explicit Session(const SessionOptions& = {});
  ~Session();

  /// Where long work reports, and how it is cancelled, when a call is given no Progress of its own.
  void useProgress(std::shared_ptr<Progress>);

  // Edits. Each is checked here and takes effect at the next frame; one that throws Error(BadInput) leaves everything as it was.
  /// `loaded`: the preset's scene, as loadScene() gives it, where the caller has it already.
  void load(const Preset&, Progress* = nullptr, const std::shared_ptr<const Scene>& loaded = nullptr);
  void setScene(const std::string& nameOrPath, Progress* = nullptr);  ///< keeps technique, parameters and display
  void setTechnique(const std::string& id);
  void setParam(const std::string& key, const std::string& text);
  void setCamera(const Camera&);
  void setCameraName(const std::string&);
  void setLights(const std::vector<PointLight>&, const std::vector<SpotLight>&, const std::vector<DirectionalLight>&, vec3 sky);
  void setResolution(int width, int height);
  void setSeed(uint32_t);
  void setDisplay(const Display&);
  /// Plays from `start`, or stands still there. @throws Error(BadInput) for a camera path that the scene has not, a time below 0, a rate that is not above 0
  void setPlayback(const Playback&);
  /// The scene's recorded flights, in place of those it has: for "Save scene". @throws Error(BadInput) for one without a name of its own, without keys, or
  /// whose times do not ascend from 0
  void setCameraPaths(const std::vector<CameraPath>&);
  void setTime(double seconds);             ///< goes there; goes on from there where it plays
  /// What a rebuild after these changes of parameters (key, text) would take, said before they are made; nothing is changed. `manual`: after setProbes() with it, too.
  /// Probes are placed for it, which their rebuild then need not do again. @throws Error(BadInput) as setParam. Error(Cancelled)
  RebuildForecast forecastRebuild(const std::map<std::string, std::string>& changes, const std::optional<std::optional<std::vector<vec3>>>& manual = {}, Progress* = nullptr);
  /// Told of each rebuild as it begins, by the thread that is in frame(): counts are exact then. Null (as it starts): nobody is, and nothing is counted.
  void tellRebuilds(std::function<void(const RebuildForecast&)>);
  void pick(int x, int y);                  ///< a pixel, for debug views and FrameResult::pick
  void setReferenceWanted(bool);            ///< progress the reference between frames
  /// Linear images that frames carry from now on, by the names that image() knows; each costs a copy from the device. "display" is FrameResult::display. Not
  /// part of the preset.
  void setImagesWanted(const std::vector<std::string>& names);
  void setRegions(const std::optional<std::vector<Region>>&);  ///< of interest, in place of the scene's (none: those): errors are measured for each
  /// Manual probes, in place of the scene's (none: those). @throws Error(BadInput) as checkProbes.
  void setProbes(const std::optional<std::vector<vec3>>&);
  void setWorkPaused(bool);
  void forgetTimes();  ///< of frames so far: statistics begin with the next one
  void cancelWork();                        ///< stops the bake or reference that runs; frames go on with what is there
  void restartWork();
  ReloadReport reloadShaders();
  void resetTechnique();

  Preset preset() const;
  ParamSet& params();                       ///< groups of the current technique and the shared ones; read only outside the session
  const Scene& scene() const;
  const SceneFeatures& features() const;
  Device& device();
  Technique& technique();
  const Atlas* atlas() const;
  const PlacedProbes* probes() const;       ///< null where the technique needs none, or they are not placed yet
  Transport transport() const;

  /// Drains edits, renders one frame, publishes. Between frames it gives long work `slice_ms`.
  std::shared_ptr<const FrameResult> frame(Progress* = nullptr);
  /// Frames until nothing would change any more (bake and direct light settled). @throws Error(Run) once preparation and work take longer than `limitMs` (0: no limit).
  std::shared_ptr<const FrameResult> settle(Progress* = nullptr, double limitMs = 0);
  /// Long work to its end, with one frame before it where it needs preparing: the number of frames does not depend on the machine. @throws as settle.
  void finishWork(Progress* = nullptr, double limitMs = 0);
  /// Runs the reference to its settings, or takes it from the cache. Camera image, or lightmap (`target` "image" or "lightmap").
  std::shared_ptr<const ReferenceResult> reference(const std::string& target = "image", Progress* = nullptr);
  std::shared_ptr<const ReferenceResult> currentReference() const;
  /// The cache's files of the references that are complete, for bundles.
  std::vector<std::filesystem::path> referenceFiles() const;

  /// Linear images of the last frame: "final", "indirect", "direct", "albedo", "reference", "reference_matched" (limited to the light paths that the
  /// technique models), a debug view. @throws Error(BadInput) naming the views there are.
  Image image(const std::string& view);
  /// Against the reference as far as it has come (empty without one).
  std::vector<ErrorValue> measureErrors(const std::vector<std::string>& metrics, const std::string& target = "image");
  /// The same for an image of indirect irradiance that was made elsewhere, at the pixels of the last frame. `specular`: indirect specular radiance; without it pictures of
  /// glossy surfaces have an error of the irradiance alone.
  std::vector<ErrorValue> measureErrorsOf(const Image& indirect, const std::vector<std::string>& metrics, const Image* specular = nullptr);
  /// Of indirect irradiance against another image of it that was made elsewhere, without noise of its own to subtract, at the pixels and regions of the last
  /// frame; `reference`: what the errors call it. @throws Error(BadInput) for images of another size.
  std::vector<ErrorValue> measureErrorsBetween(const Image& indirect, const Image& other, const std::vector<std::string>& metrics, const char* reference);
  /// The reference's path tracer as a competitor, at the pixels of the last frame, along the paths that the technique models. Not longer than the session.
  std::unique_ptr<ProgressiveTracer> progressiveTracer(uint64_t seed);
  /// Pixels that see a surface: what errors are means over.
  uint64_t surfacePixels();
  unsigned hostThreads() const;             ///< that path tracing and host passes use
  Image errorMap(const std::string& metric, const std::string& reference);
  /// Renders so many frames as things stand, and says how much the indirect and the final picture's luminance varied over them: metric "flicker" against
  /// "itself", for the whole image and each region. @throws Error(BadInput) for fewer than two frames.
  std::vector<ErrorValue> measureFlicker(int frames, Progress* = nullptr);
  /// That the scene has what the step changes. @throws Error(BadInput) for an unknown key, a value out of range, or a scene without lights to edit.
  void checkStep(const Step&) const;
  /// Settles after the step (the mean of sixteen settled frames is what is converged to) and, from a reset, before it, then takes the step and renders until nothing changes
  /// any more, at most `mostFrames` frames. The step stays.
  /// @throws Error(BadInput) as checkStep.
  StepReport measureStep(const Step&, int mostFrames, Progress* = nullptr);
  Provenance provenance() const;
  /// Shows pictures in a window, for those who have one; it may outlive the session, and then does nothing.
  std::shared_ptr<Presenter> presenter() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hl
