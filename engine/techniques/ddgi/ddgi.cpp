// Dynamic diffuse global illumination (Majercik et al. 2019, 2021; the baseline of Ekberg 2022) as a technique.
#include <algorithm>
#include <memory>

#include "engine/core/error.h"
#include "engine/passes/pixel_image.h"
#include "engine/techniques/ddgi/lattice.h"
#include "engine/techniques/ddgi/probes.h"

namespace hl {
namespace {

constexpr const char* kProbesView = "probes";
constexpr const char* kStatesView = "probe_states";
constexpr const char* kDistancesView = "distances";

class Ddgi final : public Technique {
 public:
  ParamView params() override { return ddgiView(params_); }
  Transport transport() const override {
    Transport t;
    t.bounces = params_.multi_bounce ? kAllBounces : 1;
    return t;
  }

  void rebuild(Gpu& gpu, const SceneView& scene, Progress&) override {
    probes_.reset();
    result_ = shown_ = distances_ = {};
    device_ = &gpu.device;
    probes_ = std::make_unique<DdgiProbes>(gpu, scene, params_);
  }
  void reset() override {
    followed_ = false;
    frames_ = sinceChange_ = 0;
    if (probes_) probes_->restart(params_);
  }
  bool follows(Change) const override { return true; }
  /// A camera asks nothing of probes: frames before it moved count.
  uint32_t framesToSettle() const override {
    if (!probes_) return 0;
    const uint32_t wanted = settlingFrames(probes_->albedo(), params_, followed_);
    return sinceChange_ + (wanted > frames_ ? wanted - frames_ : 0);
  }

  IndirectLight record(FrameGraph& graph, const FrameInputs& in) override {
    if (in.geometryMoved) probes_->geometryChanged();
    if ((in.geometryMoved || in.lightsChanged) && frames_ > 0) followed_ = true, frames_ = 0;
    ++frames_;
    sinceChange_ = in.sinceChange + 1;
    probes_->record(graph, in.frame, in.seed);
    viewer_ = in.camera.position;
    result_ = pixelImage(*device_, result_, "ddgi: pixels", in.gbuffer);
    probes_->recordGather(graph, in.gbuffer, viewer_, result_);
    if (in.view == kProbesView || in.view == kStatesView) {
      shown_ = pixelImage(*device_, shown_, "ddgi: probes shown", in.gbuffer);
      recordShow(graph, in);
    }
    if (in.view == kDistancesView) recordShowDistances(graph);
    return {result_};
  }

  std::vector<DebugView> debugViews() const override {
    std::vector<DebugView> views;
    const auto add = [&](const char* id, const char* label, const GpuImage& image, bool irradiance) {
      DebugView v;
      v.id = id, v.label = label, v.image = image, v.irradiance = irradiance;
      views.push_back(v);
    };
    add(kProbesView, "Probes: irradiance", shown_, true);
    add(kStatesView, "Probes: active (green), relocated (blue), inside (red), without surfaces (grey)", shown_, false);
    add("irradiance_atlas", "Probes' maps of irradiance / pi", probes_ ? probes_->irradianceAtlas() : GpuImage(), true);
    add(kDistancesView, "Probes' maps of distance: mean (red), deviation (green); not asked (blue)", distances_, false);
    add("distance_atlas", "... as they are: mean of 1 / distance [1/m] (red), of its square (green)", probes_ ? probes_->distanceAtlas() : GpuImage(), true);
    return views;
  }

  std::vector<MemoryItem> memory() const override {
    if (!probes_) return {};
    std::vector<MemoryItem> items = probes_->memory();
    uint64_t pixels = 0;
    for (const GpuImage& image : {result_, shown_, distances_})
      if (image) pixels += uint64_t{16} * static_cast<uint64_t>(image.width()) * static_cast<uint64_t>(image.height());
    items.push_back({"irradiance at pixels", pixels});
    return items;
  }
  std::vector<std::pair<std::string, double>> counters() const override {
    if (!probes_) return {};
    return probes_->counters();
  }
  PickReport pick(const PickedPoint& point) override {
    if (!probes_ || point.triangle == kNone) return {};
    return probes_->pick(point, viewer_);
  }

 private:
  void recordShow(FrameGraph& graph, const FrameInputs& in) {
    const CameraBasis basis = cameraBasis(in.camera, static_cast<float>(in.gbuffer.width) / static_cast<float>(in.gbuffer.height));
    struct Constants {
      vec3 origin, forward, right, down;
    } constants{basis.origin, basis.forward, basis.right, basis.down};
    ComputePass pass = graph.compute("ddgi: show probes", "ddgi/show_probes.comp");
    probes_->bindLookup(pass);
    pass.bind("position", in.gbuffer.position, Access::Read)
        .bind("geometricNormal", in.gbuffer.geometricNormal, Access::Read)
        .bind("background", result_, Access::Read)
        .bind("result", shown_, Access::Write)
        .specialize("kStates", in.view == kStatesView ? 1 : 0)
        .push(constants)
        .dispatchThreads(static_cast<uint32_t>(in.gbuffer.width), static_cast<uint32_t>(in.gbuffer.height));
  }

  void recordShowDistances(FrameGraph& graph) {
    const GpuImage& atlas = probes_->distanceAtlas();
    if (!distances_) distances_ = device_->image("ddgi: distances shown", {atlas.width(), atlas.height(), Format::RGBA32F});
    ComputePass pass = graph.compute("ddgi: show distances", "ddgi/show_distances.comp");
    probes_->bindLookup(pass);
    pass.bind("result", distances_, Access::Write).dispatchThreads(static_cast<uint32_t>(atlas.width()), static_cast<uint32_t>(atlas.height()));
  }

  DdgiParams params_;
  Device* device_ = nullptr;
  std::unique_ptr<DdgiProbes> probes_;
  GpuImage result_, shown_, distances_;
  vec3 viewer_{0.0f};
  uint32_t frames_ = 0, sinceChange_ = 0;  ///< since the last reset or followed change of light or geometry; since that, or one of the camera
  bool followed_ = false;  ///< something changed since the last reset, and the probes carried on
};

}  // namespace

TechniqueInfo ddgiTechniqueInfo() {
  return {"ddgi", "Irradiance probes (DDGI)",
          "A grid of probes casts rays every frame and averages irradiance and distance over directions and time; pixels ask the eight probes round them.",
          []() -> std::unique_ptr<Technique> { return std::make_unique<Ddgi>(); }};
}

}  // namespace hl
