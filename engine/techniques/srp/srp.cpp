// Sparse radiance probes (Bennett 2019, chapters 4 and 5), as a technique: parameters, work, views.
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "engine/core/error.h"
#include "engine/passes/lightmap_images.h"
#include "engine/passes/pixel_image.h"
#include "engine/techniques/srp/estimate.h"
#include "engine/techniques/srp/glossy.h"
#include "engine/techniques/srp/pick.h"
#include "engine/techniques/srp/precomputation.h"
#include "engine/techniques/srp/probe_samples.h"
#include "engine/techniques/srp/runtime.h"
#include "shaders/shared/spherical_harmonics.h"

namespace hl {
namespace {

constexpr const char* kTexelsView = "texels";
/// Light of further bounces that may be missing when the picture counts as settled, as a share; and the most frames to wait for it.
constexpr double kSettledResidual = 1e-3;
constexpr uint32_t kMostSettlingFrames = 4096;

uint32_t clusterColour(uint32_t cluster) { return 0xff000000u | (0x404040u + ((cluster + 1) * 2654435761u & 0x7f7f7fu)); }

/// What light keeps of itself from bounce to bounce where it keeps most: the largest channel, of the brightest surfaces that are more than a tenth of all.
double settlingAlbedo(const Atlas& atlas) {
  std::vector<std::pair<double, double>> areas;  // albedo, area
  double total = 0;
  for (const Lumel& l : atlas.lumels) {
    areas.push_back({static_cast<double>(std::max(l.albedo.x, std::max(l.albedo.y, l.albedo.z))), static_cast<double>(l.area)});
    total += static_cast<double>(l.area);
  }
  std::sort(areas.begin(), areas.end(), std::greater<>());
  double above = 0;
  for (const auto& [albedo, area] : areas)
    if ((above += area) >= 0.1 * total) return albedo;
  return 0;
}

class Srp final : public Technique {
 public:
  Needs needs() const override {
    Needs n;
    n.lightmap = n.probes = true;
    return n;
  }
  ParamView params() override { return srpView(params_); }
  Transport transport() const override {
    Transport t;
    t.bounces = params_.multi_bounce ? kAllBounces : 1;
    t.frontFacesOnly = true;
    t.glossyLastBounce = params_.receivers == kReceiversRadiance;
    t.receiver = directional() ? ReceiverNormal::MappedAtReceiver : ReceiverNormal::Geometric;
    return t;
  }

  void rebuild(Gpu& gpu, const SceneView& scene, Progress& progress) override {
    drop();
    if (scene.atlas == nullptr || scene.probes == nullptr) throw Error(ErrorKind::Run, "srp: the scene has no lightmap atlas or no probes");
    if (scene.atlas->lumels.empty() || scene.probes->count() == 0) return;
    if (2 * scene.scene.triangles() > gpu.device.maxTexelBufferElements())
      throw Error(ErrorKind::TooLarge, "srp: " + std::to_string(scene.scene.triangles()) + " triangles are more than this device's texel buffers hold (" +
                                         std::to_string(gpu.device.maxTexelBufferElements() / 2) + ")");
    checkSettings();
    SrpRuntime::check(gpu.device, params_, scene.probes->count());
    gpu_.emplace(gpu);
    view_.emplace(scene);
    tables_ = makeLightmapTables(scene.scene, *scene.atlas, scene.lightmap.dilation, progress);
    Buffer triangles = gpu.device.buffer("srp: triangles", tables_.triangles.size() * sizeof(vec4), TexelFormat::RGBA32F);
    gpu.device.upload(triangles, tables_.triangles.data(), tables_.triangles.size() * sizeof(vec4));
    images_ = std::make_unique<LightmapImages>(gpu.device, "srp", *scene.atlas, tables_, scene.lightmap.dilation);
    samples_ = std::make_unique<ProbeSamples>(gpu, scene, static_cast<uint32_t>(params_.probe_rays), params_.sh_order, triangles, images_->lumelOfTexel());
    precomputation_ = std::make_unique<Precomputation>(gpu, scene, params_, triangles, images_->lumelOfTexel(), samples_.get(), progress);
    albedo_ = settlingAlbedo(*scene.atlas);
    tables_.triangles = {};
  }
  RebuildEstimate rebuildEstimate(const Device& device, const SceneView& scene, double lumels, Progress& progress) const override {
    if (scene.atlas == nullptr || scene.probes == nullptr) return {};
    checkSettings();
    SrpRuntime::check(device, params_, scene.probes->count());
    return estimateTransport(device, scene, params_, lumels, progress);
  }
  std::vector<WorkPart> workDone() const override {
    if (!precomputation_) return {};
    const auto [first, last] = precomputation_->computed();
    std::vector<WorkPart> work = transportWork(precomputation_->clusters(), first, last, params_, static_cast<uint32_t>(shared::shCount(params_.sh_order)));
    const double share = samples_->units() > 0 ? static_cast<double>(samples_->done()) / static_cast<double>(samples_->units()) : 0;
    work.push_back(probeRayWork(share * static_cast<double>(view_->probes->count()) * params_.probe_rays));
    work.push_back(surfaceShareWork(precomputation_->probesShared(), params_, static_cast<uint32_t>(shared::shCount(params_.sh_order))));
    return work;
  }
  void reset() override {
    frames_ = sinceChange_ = 0;
    if (runtime_) runtime_->restart(params_);
  }
  /// The transport is that of geometry alone: light may change as it will, and a camera has no part in it.
  bool follows(Change change) const override { return change != Change::Geometry; }
  uint32_t framesToSettle() const override {
    if (!runtime_) return 0;
    const double bounces = params_.multi_bounce && albedo_ > 0 ? std::ceil(std::log(kSettledResidual) / std::log(std::min(albedo_, 0.999))) : 1;
    const double wanted = runtime_->directSamples() + std::max(1.0, bounces) * static_cast<double>(params_.update_frames);
    const auto frames = static_cast<uint32_t>(std::min<double>(wanted, kMostSettlingFrames));
    return sinceChange_ + (frames > frames_ ? frames - frames_ : 0);
  }

  /// What probes see, then transport cluster by cluster, then the matrices go to the device.
  WorkState work() const override {
    WorkState state;
    if (!precomputation_) return state;
    const WorkState transport = precomputation_->work();
    state.done = samples_->done() + transport.done + (runtime_ ? 1 : 0);
    state.total = samples_->units() + transport.total + 1;
    state.label = samples_->done() < samples_->units() ? "what probes see" : (transport.settled() ? "matrices" : transport.label);
    return state;
  }
  void recordWork(FrameGraph& graph) override {
    if (!precomputation_ || runtime_) return;
    if (samples_->done() < samples_->units()) return samples_->recordUnit(graph);
    samples_->release();
    if (!precomputation_->work().settled()) return precomputation_->recordUnit(graph);
    precomputation_->release();
    runtime_ = std::make_unique<SrpRuntime>(*gpu_, *view_, params_, precomputation_->clusters(), precomputation_->transport(), tables_, *samples_);
    runtime_->restart(params_);
    reflection_ = std::make_unique<Reflection>(gpu_->device, *view_, precomputation_->clusters(), tables_);
    uploadViews();
  }

  IndirectLight record(FrameGraph& graph, const FrameInputs& in) override {
    if (!precomputation_) {
      graph.skip("srp: irradiance transport", "there is no valid texel, or no probe");
      return {};
    }
    if (!runtime_) {
      graph.skip("srp: irradiance transport", "transport is being precomputed");
      return {};
    }
    if (in.lightsChanged && frames_ > 0) runtime_->lightsChanged(), frames_ = 0;
    ++frames_;
    sinceChange_ = in.sinceChange + 1;
    runtime_->setParams(params_);
    if (params_.least_valid != shownLeastValid_) uploadValidity();
    runtime_->record(graph);
    images_->record(graph, runtime_->irradiance());
    result_ = pixelImage(gpu_->device, result_, "srp: irradiance at pixels", in.gbuffer);
    if (directional()) images_->recordLinear(graph, runtime_->slopes());
    images_->recordPixels(graph, "srp: apply", in.gbuffer, result_, false, false, directional(), params_.clamp_negative != 0);
    if (in.view == kTexelsView) {
      texels_ = pixelImage(gpu_->device, texels_, "srp: texels", in.gbuffer);
      images_->recordPixels(graph, "srp: show texels", in.gbuffer, texels_, true, true);
    }
    if (in.view == "lightmap_direct") images_->recordMeans(graph, "direct lightmap", runtime_->direct(), directImage_);
    return {result_, recordReflection(graph, in)};
  }

  std::vector<DebugView> debugViews() const override {
    const GpuImage none;
    std::vector<DebugView> views;
    const auto add = [&](const char* id, const char* label, const GpuImage& image, bool lightmap, bool irradiance) {
      DebugView v;
      v.id = id, v.label = label, v.image = image, v.lightmap = lightmap, v.irradiance = irradiance;
      views.push_back(v);
    };
    add(kTexelsView, "Receivers on surfaces", texels_, false, true);
    add("lightmap", "Lightmap", runtime_ ? images_->lightmap() : none, true, true);
    add("lightmap_direct", "Lightmap: direct light", directImage_, true, true);
    add("lightmap_validity", "Lightmap: valid, inside, overlapping", images_ ? images_->validity() : none, true, false);
    add("receiver_clusters", "Lightmap: clusters", clusterView_, true, false);
    add("receiver_validity", "Lightmap: share of a receiver's rays that some probe sees too (red: too few)", validView_, true, false);
    return views;
  }

  std::vector<MemoryItem> memory() const override {
    std::vector<MemoryItem> items;
    if (!precomputation_) return items;
    if (runtime_) items = runtime_->memory();
    items.push_back({"working memory of precomputation", precomputation_->workingBytes()});
    items.push_back({"working memory of probes' rays", samples_->workingBytes()});
    if (precomputation_->triangles()) items.push_back({"triangles for precomputation", precomputation_->triangles().size()});
    items.push_back({"transport on the host", precomputation_->hostBytes()});
    for (auto& [name, bytes] : images_->memory()) items.push_back({name, bytes});
    if (reflection_ && reflection_->any()) items.push_back({"texels of glossy surfaces", reflection_->bytes()});
    const auto bytesOf = [](const GpuImage& image) { return image ? uint64_t{16} * static_cast<uint64_t>(image.width()) * static_cast<uint64_t>(image.height()) : 0; };
    items.push_back({"irradiance at pixels", bytesOf(result_) + bytesOf(texels_) + bytesOf(directImage_)});
    if (specular_) items.push_back({"reflected radiance at pixels", bytesOf(specular_)});
    return items;
  }

  /// The matrices, and what goes into them and comes out.
  std::vector<MemoryItem> bytesMoved() const override {
    if (!runtime_) return {};
    const Summary& s = summary();
    const double number = params_.storage == kStorageFloat16 ? 2 : 4, vectors = sizeof(vec4) * s.vectors, receivers = precomputation_->clusters().receivers();
    const double weights = s.weights - s.radianceWeights;
    std::vector<MemoryItem> moved = {
            {"srp: project clusters", static_cast<uint64_t>(s.basis * number + vectors)},
            {"srp: irradiance transport", static_cast<uint64_t>(weights * number + vectors + receivers * (sizeof(vec4) + sizeof(uint32_t)) + s.reads * (sizeof(shared::SrpRead) + sizeof(vec4)))}};
    if (runtime_->incident()) moved.push_back({"srp: radiance transport", static_cast<uint64_t>(s.radianceWeights * number + vectors + static_cast<double>(runtime_->incident().size()))});
    return moved;
  }

  std::vector<std::pair<std::string, double>> counters() const override {
    if (!precomputation_) return {};
    const ReceiverClusters& clusters = precomputation_->clusters();
    const Summary& s = summary();
    const double number = params_.storage == kStorageFloat16 ? 2 : 4;
    std::vector<std::pair<std::string, double>> list = {
        {"receivers", clusters.receivers()},
        {"probes", static_cast<double>(view_->probes->count())},
        {"clusters", static_cast<double>(clusters.clusters.size())},
        {"clusters_from_disk", static_cast<double>(precomputation_->clustersFromDisk())},
        {"rays_cast", static_cast<double>(precomputation_->raysCast())},
        {"invalid_receivers", s.invalid},
        {"valid_samples", clusters.receivers() > 0 ? s.valid / clusters.receivers() : 0},
        {"lumels_read", clusters.receivers() > 0 ? s.reads / clusters.receivers() : 0},
        {"blur_limited_samples", s.samples > 0 ? s.coarse / s.samples : 0},
        {"scarce_surface_samples", s.samples > 0 ? s.scarce / s.samples : 0},
        {"most_columns", s.mostColumns},
        {"light_vectors", s.vectors},
        {"uncompressed_bytes", s.numbers * number},
        {"cpca_relative_error", s.total > 0 ? std::sqrt(s.discarded / s.total) : 0},
    };
    const ProbeSamples::Counts& seen = samples_->counts();
    list.push_back({"probe_rays_into_the_open", static_cast<double>(seen.misses)});
    list.push_back({"probe_rays_to_back_faces", static_cast<double>(seen.backFaces)});
    list.push_back({"probe_rays_without_texel", static_cast<double>(seen.withoutTexel)});
    if (!runtime_) return list;
    list.push_back({"stored_bytes", static_cast<double>(runtime_->matrixBytes() + runtime_->readBytes())});
    list.push_back({"compression_ratio", runtime_->matrixBytes() > 0 ? s.numbers * number / static_cast<double>(runtime_->matrixBytes()) : 0});
    const SrpRuntime::Counts counts = runtime_->counts();
    list.push_back({"negative_receivers", counts.negative});
    list.push_back({"lightmap_nan_inf", counts.nonFinite});
    list.push_back({"pixels_without_texel", images_->pixelsWithoutTexel()});
    if (!runtime_->incident()) return list;
    const Reflection::Counts reflected = reflection_->counts();
    list.push_back({"glossy_receivers", s.wide});
    list.push_back({"negative_reflections", reflected.negative});
    list.push_back({"reflections_nan_inf", reflected.nonFinite});
    list.push_back({"reflections_without_texel", reflected.withoutTexel});
    return list;
  }

  PickReport pick(const PickedPoint& point) override {
    if (!runtime_ || point.triangle == kNone) return {};
    return pickReceiver(*view_, *gpu_, precomputation_->clusters(), precomputation_->transport(), *runtime_, params_, point);
  }

  std::vector<vec3> lightmapIrradiance() override {
    if (!runtime_) return {};
    std::vector<vec4> values(view_->atlas->lumels.size());
    gpu_->device.download(runtime_->irradiance(), values.data(), values.size() * sizeof(vec4));
    std::vector<vec3> rgb;
    rgb.reserve(values.size());
    for (vec4 v : values) rgb.push_back(vec3(v.x, v.y, v.z));
    return rgb;
  }

 private:
  /// What makes no sense together.
  void checkSettings() const {
    if (params_.probe_rays < shared::shCount(params_.sh_order))
      throw Error(ErrorKind::BadInput, "srp.probe_rays: " + std::to_string(params_.probe_rays) + " rays can't tell the " + std::to_string(shared::shCount(params_.sh_order)) +
                                         " coefficients of order " + std::to_string(params_.sh_order) + " apart; more rays, or a lower srp.sh_order");
  }

  /// Sums over the transport that is there. Asked for in every frame, so kept until there is more of it.
  struct Summary {
    size_t clusters = 0;
    float leastValid = 0;
    double numbers = 0, total = 0, discarded = 0, invalid = 0, valid = 0, vectors = 0, mostColumns = 0, reads = 0, samples = 0, coarse = 0, scarce = 0, basis = 0, weights = 0, wide = 0, radianceWeights = 0;  ///< numbers: of the matrices, uncompressed
  };
  const Summary& summary() const {
    const std::vector<ClusterTransport>& transport = precomputation_->transport();
    if (summary_.clusters == transport.size() && summary_.leastValid == params_.least_valid) return summary_;
    Summary s;
    s.clusters = transport.size(), s.leastValid = params_.least_valid;
    for (const ClusterTransport& t : transport) {
      s.numbers += static_cast<double>(t.allRows()) * static_cast<double>(t.columns);
      s.wide += t.wide;
      if (params_.receivers == kReceiversRadiance) s.radianceWeights += static_cast<double>(t.wide) * (t.rows - 1) * t.rank;
      s.reads += static_cast<double>(t.reads.size());
      s.samples += static_cast<double>(t.receivers) * params_.receiver_rays, s.coarse += t.coarse, s.scarce += t.scarce;
      s.total += t.total, s.discarded += t.discarded;
      s.basis += static_cast<double>(t.basis.size()), s.weights += static_cast<double>(t.weights.size());
      s.vectors += t.rank, s.mostColumns = std::max(s.mostColumns, static_cast<double>(t.columns));
      for (float v : t.valid) s.invalid += v < params_.least_valid, s.valid += static_cast<double>(v);
    }
    return summary_ = s;
  }

  GpuImage recordReflection(FrameGraph& graph, const FrameInputs& in) {
    if (params_.receivers != kReceiversRadiance) return {};
    if (!reflection_->any() || !in.gbuffer.specular) {
      graph.skip("srp: reflect", "no receiver is on a glossy surface");
      return {};
    }
    specular_ = pixelImage(gpu_->device, specular_, "srp: reflected radiance at pixels", in.gbuffer);
    reflection_->record(graph, in.gbuffer, in.camera, *images_, runtime_->incident(), params_, specular_);
    return specular_;
  }

  bool directional() const { return params_.receivers == kReceiversDirectional; }

  void drop() {
    summary_ = {};
    reflection_.reset();
    runtime_.reset();
    precomputation_.reset();
    samples_.reset();
    images_.reset();
    result_ = specular_ = texels_ = directImage_ = clusterView_ = validView_ = {};
    frames_ = sinceChange_ = 0;
  }

  /// Colours of texels by receiver, `colour(cluster, receiver of it)`; those without one are dark grey.
  template <class Colour>
  void uploadTexels(const GpuImage& image, const Colour& colour) {
    const Atlas& atlas = *view_->atlas;
    const ReceiverClusters& clusters = precomputation_->clusters();
    std::vector<uint32_t> texels(atlas.texelState.size(), 0xff202020u);
    for (uint32_t i = 0; i < clusters.clusters.size(); ++i) {
      const ReceiverCluster& c = clusters.clusters[i];
      for (uint32_t r = 0; r < c.receivers; ++r) texels[atlas.lumels[clusters.lumelOfReceiver[c.firstReceiver + r]].texel] = colour(i, r);
    }
    gpu_->device.upload(image, 0, texels.data(), 4 * texels.size());
  }

  void uploadViews() {
    const ImageDesc desc{view_->atlas->resolution, view_->atlas->resolution, Format::RGBA8};
    clusterView_ = gpu_->device.image("srp: clusters", desc);
    uploadTexels(clusterView_, [](uint32_t cluster, uint32_t) { return clusterColour(cluster); });
    validView_ = gpu_->device.image("srp: valid samples", desc);
    uploadValidity();
    directImage_ = images_->image("direct lightmap");
  }

  /// Again where `least_valid` has changed.
  void uploadValidity() {
    shownLeastValid_ = params_.least_valid;
    uploadTexels(validView_, [&](uint32_t cluster, uint32_t receiver) {
      const float valid = precomputation_->transport()[cluster].valid[receiver];
      const auto level = static_cast<uint32_t>(std::lround(255 * std::clamp(valid, 0.0f, 1.0f)));
      return valid < params_.least_valid ? 0xff0000c0u : 0xff000000u | level << 16 | level << 8 | level;
    });
  }

  SrpParams params_;
  std::optional<Gpu> gpu_;
  std::optional<SceneView> view_;
  LightmapTables tables_;
  std::unique_ptr<LightmapImages> images_;
  std::unique_ptr<ProbeSamples> samples_;
  std::unique_ptr<Precomputation> precomputation_;
  std::unique_ptr<SrpRuntime> runtime_;
  std::unique_ptr<Reflection> reflection_;
  GpuImage result_, specular_, texels_, directImage_, clusterView_, validView_;
  mutable Summary summary_;
  double albedo_ = 0;
  float shownLeastValid_ = -1;             ///< in the view
  uint32_t frames_ = 0, sinceChange_ = 0;  ///< since the last reset or change of light; since that, or a change of camera
};

}  // namespace

TechniqueInfo srpTechniqueInfo() {
  return {"srp", "Sparse radiance probes",
          "Few probes hold radiance in spherical harmonics; transport to every texel of a lightmap is precomputed and compressed. Light moves freely, geometry stands.",
          []() -> std::unique_ptr<Technique> { return std::make_unique<Srp>(); }};
}

}  // namespace hl
