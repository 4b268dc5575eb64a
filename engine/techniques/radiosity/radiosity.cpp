// Progressive radiosity on a lightmap (Kahl 2023, chapters 2.8, 4 and 5), as a technique: parameters, bake, and the lightmap at pixels.
#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/techniques/radiosity/bake.h"
#include "engine/techniques/radiosity/unit.h"

namespace hl {
namespace {

constexpr const char* kTexelsView = "texels";

uint32_t chartColour(uint32_t chart) {
  const uint32_t h = (chart + 1) * 2654435761u;
  return 0xff000000u | (0x404040u + (h & 0x7f7f7fu));
}

/// RGBA8, one a texel: what the validity view shows.
uint32_t stateColour(uint8_t state) {
  switch (state) {
    case TexelValid: return 0xff50b050u;
    case TexelInside: return 0xff3030d0u;
    case TexelOverlap: return 0xff20b0e0u;
    default: return 0xff202020u;
  }
}

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
    chartOfTriangle_ = device_->buffer("radiosity: chart of triangle", std::span<const uint32_t>(atlas_->charts));
    pixelCounters_ = device_->buffer("radiosity: pixel counters", sizeof(uint32_t));
    uploadAtlasViews();
  }

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
    result_ = sized(result_, "radiosity: irradiance", in.gbuffer);
    graph.clear("radiosity: clear pixel counters", pixelCounters_);
    recordApply(graph, "radiosity: apply", in.gbuffer, result_, params_.lookup == kLookupNearest, false);
    if (in.view == kTexelsView) {
      texels_ = sized(texels_, "radiosity: texels", in.gbuffer);
      recordApply(graph, "radiosity: show texels", in.gbuffer, texels_, true, true);
    }
    return {result_};
  }

  std::vector<DebugView> debugViews() const override {
    const GpuImage none;
    std::vector<DebugView> views;
    const auto add = [&](const char* id, const char* label, const GpuImage& image, bool lightmap, bool irradiance) {
      DebugView v;
      v.id = id, v.label = label, v.image = image, v.lightmap = lightmap, v.irradiance = irradiance;
      views.push_back(v);
    };
    add(kTexelsView, "Lightmap texels on surfaces", texels_, false, true);
    add("lightmap", "Lightmap", bake_ ? bake_->lightmap() : none, true, true);
    add("lightmap_direct", "Lightmap: direct light", bake_ ? bake_->directLightmap() : none, true, true);
    add("lightmap_validity", "Lightmap: valid, inside, overlapping", validity_, true, false);
    add("lightmap_charts", "Lightmap: charts", charts_, true, false);
    return views;
  }

  std::vector<MemoryItem> memory() const override {
    if (!bake_) return {};
    std::vector<MemoryItem> items = bake_->memory();
    uint64_t pixels = 0;
    for (const GpuImage& image : {result_, texels_})
      if (image) pixels += uint64_t{16} * static_cast<uint64_t>(image.width()) * static_cast<uint64_t>(image.height());
    items.push_back({"irradiance at pixels", pixels});
    items.push_back({"atlas views", uint64_t{8} * atlas_->texelState.size()});
    return items;
  }

  std::vector<std::pair<std::string, double>> counters() const override {
    if (!bake_) return {};
    auto list = bake_->counters();
    if (result_) {
      uint32_t pixels = 0;
      device_->download(pixelCounters_, &pixels, sizeof pixels);
      list.push_back({"pixels_without_texel", pixels});
    }
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
  GpuImage sized(const GpuImage& image, const char* name, const GBuffer& g) const {
    if (image && image.width() == g.width && image.height() == g.height) return image;
    return device_->image(name, {g.width, g.height, Format::RGBA32F});
  }

  void uploadAtlasViews() {
    const ImageDesc desc{atlas_->resolution, atlas_->resolution, Format::RGBA8};
    std::vector<uint32_t> colours(atlas_->texelState.size());
    for (size_t i = 0; i < colours.size(); ++i) colours[i] = stateColour(atlas_->texelState[i]);
    validity_ = device_->image("radiosity: validity", desc);
    device_->upload(validity_, 0, colours.data(), 4 * colours.size());
    std::fill(colours.begin(), colours.end(), 0xff202020u);
    for (const Lumel& l : atlas_->lumels) colours[l.texel] = chartColour(atlas_->charts[l.triangle]);
    charts_ = device_->image("radiosity: charts", desc);
    device_->upload(charts_, 0, colours.data(), 4 * colours.size());
  }

  void recordApply(FrameGraph& graph, const char* pass, const GBuffer& g, const GpuImage& to, bool nearestTexel, bool checker) const {
    graph.compute(pass, "radiosity/apply.comp")
        .bind("position", g.position, Access::Read)
        .bind("normal", g.normal, Access::Read)
        .bind("geometricNormal", g.geometricNormal, Access::Read)
        .bind("ids", g.ids, Access::Read)
        .bind("chartOfTriangle", chartOfTriangle_, Access::Read)
        .bind("chartOfTexel", bake_->chartOfTexel(), Access::Read)
        .bind("lightmap", bake_->lightmap(), Access::Read)
        .bind("result", to, Access::Write)
        .bind("pixelCounters", pixelCounters_, Access::ReadWrite)
        .specialize("kNearest", nearestTexel)
        .specialize("kChecker", checker)
        .dispatchThreads(static_cast<uint32_t>(g.width), static_cast<uint32_t>(g.height));
  }

  RadiosityParams params_;
  Device* device_ = nullptr;
  const Atlas* atlas_ = nullptr;
  std::unique_ptr<RadiosityBake> bake_;
  Buffer chartOfTriangle_, pixelCounters_;
  GpuImage result_, texels_, validity_, charts_;
};

}  // namespace

TechniqueInfo radiosityTechniqueInfo() {
  return {"radiosity", "Radiosity", "Bounces of diffuse light on a lightmap, gathered with rays from each texel.",
          []() -> std::unique_ptr<Technique> { return std::make_unique<Radiosity>(); }};
}

}  // namespace hl
