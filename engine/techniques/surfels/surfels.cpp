// Surfel global illumination (Ekberg 2022, chapters 3 and 4), as a technique: parameters, cache and views.
#include "engine/passes/pixel_image.h"
#include "engine/techniques/surfels/cache.h"
#include "engine/techniques/surfels/views.h"

namespace hl {
namespace {

struct View {
  const char* id;
  const char* label;
  uint32_t what;
  bool irradiance;
};
constexpr View kViews[] = {
    {"surfels_id", "Surfels by number", shared::kViewId, false},
    {"surfels_normal", "Surfels: normal", shared::kViewNormal, false},
    {"surfels_age", "Surfels: age", shared::kViewAge, false},
    {"surfels_inconsistency", "Surfels: inconsistency", shared::kViewInconsistency, false},
    {"surfels_rays", "Surfels: rays cast", shared::kViewRays, false},
    {"surfels_radiance", "Surfels: irradiance", shared::kViewRadiance, true},
    {"surfels_coverage", "Surfel coverage", shared::kViewCoverage, false},
    {"surfels_grid", "Surfels in grid cells", shared::kViewGrid, false},
};

class Surfels final : public Technique {
 public:
  ParamView params() override { return surfelsView(params_); }
  Transport transport() const override {
    Transport t;
    t.bounces = kAllBounces;
    t.receiver = ReceiverNormal::Geometric;
    return t;
  }

  void rebuild(Gpu& gpu, const SceneView& scene, Progress&) override {
    cache_.reset();
    result_ = view_ = {};
    device_ = &gpu.device;
    cache_ = std::make_unique<SurfelCache>(gpu, scene, params_);
  }
  void reset() override {
    if (cache_) cache_->restart();
  }
  /// Surfels lie on surfaces and go with them; light and shadow they find out by themselves.
  bool follows(Change) const override { return true; }
  uint32_t framesToSettle() const override { return static_cast<uint32_t>(params_.settle_frames); }

  IndirectLight record(FrameGraph& graph, const FrameInputs& in) override {
    if (!cache_) return {};
    result_ = pixelImage(*device_, result_, "surfels: irradiance", in.gbuffer);
    cache_->record(graph, in, params_, result_);
    for (const View& v : kViews)
      if (in.view == v.id) {
        view_ = pixelImage(*device_, view_, "surfels: view", in.gbuffer);
        cache_->recordView(graph, in, params_, result_, view_, v.what);
      }
    IndirectLight light;
    light.irradiance = result_;
    return light;
  }

  std::vector<DebugView> debugViews() const override {
    std::vector<DebugView> views;
    for (const View& v : kViews) {
      DebugView d;
      d.id = v.id, d.label = v.label, d.image = view_, d.irradiance = v.irradiance;
      views.push_back(d);
    }
    return views;
  }

  std::vector<MemoryItem> memory() const override {
    if (!cache_) return {};
    std::vector<MemoryItem> items = cache_->memory();
    uint64_t pixels = 0;
    for (const GpuImage& image : {result_, view_})
      if (image) pixels += uint64_t{16} * static_cast<uint64_t>(image.width()) * static_cast<uint64_t>(image.height());
    items.push_back({"irradiance at pixels", pixels});
    return items;
  }
  std::vector<std::pair<std::string, double>> counters() const override { return cache_ ? cache_->counters() : std::vector<std::pair<std::string, double>>{}; }
  PickReport pick(const PickedPoint& point) override { return cache_ ? cache_->pick(point, params_) : PickReport{}; }

 private:
  SurfelsParams params_;
  Device* device_ = nullptr;
  std::unique_ptr<SurfelCache> cache_;
  GpuImage result_, view_;
};

}  // namespace

TechniqueInfo surfelsTechniqueInfo() {
  return {"surfels", "Surfel GI", "Discs placed where the camera looks keep the light that a few rays a frame bring, and hand it on to pixels and to each other.",
          []() -> std::unique_ptr<Technique> { return std::make_unique<Surfels>(); }};
}

}  // namespace hl
