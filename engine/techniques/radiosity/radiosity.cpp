// Progressive radiosity on a lightmap (Kahl 2023, chapters 2.8, 4 and 5), as a technique: parameters, bake, and the lightmap at pixels.
#include <fmt/format.h>

#include "engine/core/error.h"
#include "engine/passes/pixel_image.h"
#include "engine/techniques/radiosity/bake.h"
#include "engine/techniques/radiosity/estimate.h"

namespace hl {
namespace {

constexpr const char* kTexelsView = "texels";

class Radiosity final : public Technique {
 public:
  Needs needs() const override {
    Needs n;
    n.lightmap = true;
    return n;
  }
  ParamView params() override { return radiosityView(params_); }
  Transport transport() const override {
    Transport t;
    t.bounces = params_.bounces;
    t.frontFacesOnly = true;
    t.receiver = ReceiverNormal::Geometric;
    return t;
  }

  void rebuild(Gpu& gpu, const SceneView& scene, Progress& progress) override {
    bake_.reset();
    result_ = texels_ = {};
    if (scene.atlas == nullptr) throw Error(ErrorKind::Run, "radiosity: the scene has no lightmap atlas");
    device_ = &gpu.device;
    atlas_ = scene.atlas;
    bake_ = std::make_unique<RadiosityBake>(gpu, scene, params_, progress);
  }

  RebuildEstimate rebuildEstimate(const Device&, const SceneView& scene, double lumels, Progress&) const override {
    return scene.atlas ? estimateBake(scene, params_, lumels) : RebuildEstimate{};
  }
  std::vector<WorkPart> workDone() const override { return bake_ ? bakeWork(bake_->workDone()) : std::vector<WorkPart>{}; }

  /// The lightmap lies on surfaces: it does not depend on who looks at them.
  bool follows(Change change) const override { return change == Change::Camera; }
  void reset() override {
    if (bake_) bake_->restart(params_);
  }
  WorkState work() const override { return bake_ ? bake_->work() : WorkState{}; }
  void recordWork(FrameGraph& graph) override {
    if (bake_) bake_->recordUnit(graph);
  }

  IndirectLight record(FrameGraph& graph, const FrameInputs& in) override {
    if (!bake_ || bake_->lumels() == 0) {
      graph.skip("radiosity: apply", "the lightmap has no valid texel");
      return {};
    }
    bake_->recordImages(graph);
    result_ = pixelImage(*device_, result_, "radiosity: irradiance", in.gbuffer);
    bake_->images().recordPixels(graph, "radiosity: apply", in.gbuffer, result_, params_.lookup == kLookupNearest, false);
    if (in.view == kTexelsView) {
      texels_ = pixelImage(*device_, texels_, "radiosity: texels", in.gbuffer);
      bake_->images().recordPixels(graph, "radiosity: show texels", in.gbuffer, texels_, true, true);
    }
    return {result_};
  }

  std::vector<DebugView> debugViews() const override {
    const GpuImage none;
    const LightmapImages* maps = bake_ && bake_->lumels() > 0 ? &bake_->images() : nullptr;
    std::vector<DebugView> views;
    const auto add = [&](const char* id, const char* label, const GpuImage& image, bool lightmap, bool irradiance) {
      DebugView v;
      v.id = id, v.label = label, v.image = image, v.lightmap = lightmap, v.irradiance = irradiance;
      views.push_back(v);
    };
    add(kTexelsView, "Lightmap texels on surfaces", texels_, false, true);
    add("lightmap", "Lightmap", maps ? maps->lightmap() : none, true, true);
    add("lightmap_direct", "Lightmap: direct light", bake_ ? bake_->directLightmap() : none, true, true);
    add("lightmap_validity", "Lightmap: valid, inside, overlapping", maps ? maps->validity() : none, true, false);
    add("lightmap_charts", "Lightmap: charts", maps ? maps->charts() : none, true, false);
    return views;
  }

  std::vector<MemoryItem> memory() const override {
    if (!bake_) return {};
    std::vector<MemoryItem> items = bake_->memory();
    uint64_t pixels = 0;
    for (const GpuImage& image : {result_, texels_})
      if (image) pixels += uint64_t{16} * static_cast<uint64_t>(image.width()) * static_cast<uint64_t>(image.height());
    items.push_back({"irradiance at pixels", pixels});
    return items;
  }

  std::vector<std::pair<std::string, double>> counters() const override {
    if (!bake_) return {};
    auto list = bake_->counters();
    if (result_) list.push_back({"pixels_without_texel", bake_->images().pixelsWithoutTexel()});
    return list;
  }

  PickReport pick(const PickedPoint& point) override {
    if (!bake_ || point.triangle == kNone || bake_->lumels() == 0) return {};
    const int side = atlas_->resolution;
    const ivec2 texel = glm::clamp(ivec2(point.lightmapUv * static_cast<float>(side)), ivec2(0), ivec2(side - 1));
    const size_t index = static_cast<size_t>(texel.y) * static_cast<size_t>(side) + static_cast<size_t>(texel.x);
    const uint32_t lumel = atlas_->lumelOfTexel[index];
    if (lumel != kNone) return bake_->pick(lumel);
    PickReport report;
    report.facts = {{"texel", fmt::format("({}, {})", texel.x, texel.y)},
                    {"state", atlas_->texelState[index] == TexelInside ? "inside other geometry" : "not covered"}};
    return report;
  }

  std::vector<vec3> lightmapIrradiance() override {
    if (!bake_ || bake_->lumels() == 0) return {};
    std::vector<vec4> values(bake_->lumels());
    device_->download(bake_->irradiance(), values.data(), values.size() * sizeof(vec4));
    std::vector<vec3> rgb;
    rgb.reserve(values.size());
    for (vec4 v : values) rgb.push_back(vec3(v.x, v.y, v.z));
    return rgb;
  }

 private:
  RadiosityParams params_;
  Device* device_ = nullptr;
  const Atlas* atlas_ = nullptr;
  std::unique_ptr<RadiosityBake> bake_;
  GpuImage result_, texels_;
};

}  // namespace

TechniqueInfo radiosityTechniqueInfo() {
  return {"radiosity", "Radiosity", "Bounces of diffuse light on a lightmap, gathered with rays from each texel.",
          []() -> std::unique_ptr<Technique> { return std::make_unique<Radiosity>(); }};
}

}  // namespace hl
