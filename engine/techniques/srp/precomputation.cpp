#include "engine/techniques/srp/precomputation.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/techniques/srp/directional.h"
#include "engine/techniques/srp/glossy.h"
#include "engine/techniques/srp/hemisphere_basis.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/spherical_harmonics.h"

namespace hl {
namespace {

/// Rays of a unit: some 50 ms of them on two cores; on a GPU a unit that is too small is all submission.
constexpr uint64_t kUnitRaysOnCpu = 1u << 16, kUnitRaysOnGpu = 1u << 22;
/// Counts with the results: whoever changes what is computed raises it.
constexpr uint32_t kVersion = 7;

/// Where what no probe tells is not read elsewhere, whatever a probe tells is better than nothing.
float blurLimit(const SrpParams& params) { return params.sample_weight == kSampleWeightSurface ? params.blur_limit : 0; }

/// What every device takes as groups along y.
constexpr size_t kMostClusters = 65535;

constexpr uint64_t kBytesARay = sizeof(shared::Ray) + sizeof(shared::Hit) + sizeof(float);
constexpr uint64_t kBytesAQuestion = sizeof(shared::Ray) + sizeof(uint32_t) + sizeof(float);

float rayOffset(const SceneView& scene) { return scene.direct.ray_offset * scene.gpuScene.diagonal; }

}  // namespace

uint32_t readsOf(const SrpParams& params) {
  return params.sample_weight == kSampleWeightSurface ? static_cast<uint32_t>(std::min(params.surface_reads, params.receiver_rays)) : 0;
}

uint32_t rowsOf(const SrpParams& params) {
  if (params.receivers == kReceiversRadiance) return 1 + static_cast<uint32_t>(shared::hemisphereTerms(params.glossy_order));
  return params.receivers == kReceiversDirectional ? shared::kSrpDirectionalRows : 1;
}

uint32_t allRows(const ReceiverCluster& c, const SrpParams& params) { return c.receivers + (rowsOf(params) - 1) * c.wide; }

Precomputation::Precomputation(Gpu& gpu, const SceneView& scene, const SrpParams& params, const Buffer& triangles, const Buffer& lumelOfTexel, const ProbeSamples* samples,
                               Progress& progress)
    : device_(gpu.device), scene_(scene), params_(params), triangles_(triangles), lumelOfTexel_(lumelOfTexel), samples_(samples) {
  reads_ = readsOf(params);
  coefficients_ = static_cast<uint32_t>(shared::shCount(params.sh_order));
  rows_ = rowsOf(params);
  offset_ = rayOffset(scene);
  progress.begin("receivers and their probes", 1);
  clusters_ = clustersOf(scene, params, progress);
  progress.advance();
  allocate(scene);
  takeUp(params.cache ? std::make_shared<TransportStore>(key(device_, scene, params_)) : nullptr);
  for (const ReceiverCluster& c : clusters_.clusters) unitsTotal_ += unitsOf(c);
  ++unitsTotal_;
  for (size_t i = 0; i < cluster_; ++i) unitsDone_ += unitsOf(clusters_.clusters[i]);
}

/// What the disk has of it.
void Precomputation::takeUp(std::shared_ptr<TransportStore> store) {
  std::vector<ClusterTransport> finished;
  if (store) finished = store->read(clusters_.clusters.size());
  for (size_t i = 0; i < finished.size(); ++i) {
    const ReceiverCluster& c = clusters_.clusters[i];
    if (finished[i].receivers == c.receivers && finished[i].wide == c.wide && finished[i].rows == rows_ && finished[i].columns == c.probes.size() * coefficients_) continue;
    throw Error(ErrorKind::Run, store->file().string() + ": does not fit what it was made for; delete it");
  }
  fromDisk_ = cluster_ = finished.size();
  compressor_ = std::make_shared<Compressor>(params_, scene_.seed, compressions_, std::move(store), std::move(finished));
}

ReceiverClusters Precomputation::clustersOf(const SceneView& scene, const SrpParams& params, Progress& progress) {
  const vec3 extent = scene.scene.bounds.max - scene.scene.bounds.min;
  return makeClusters(*scene.atlas, scene.probes->positions, params, std::max(extent.x, std::max(extent.y, extent.z)), static_cast<uint32_t>(shared::shCount(params.sh_order)),
                      wideLumels(scene, params), progress);
}

std::string Precomputation::key(const Device& device, const SceneView& scene, const SrpParams& params) {
  Hasher h;
  h.value(kVersion).text(device.info().name).text(device.info().driver).text(scene.tracer.id()).value(scene.seed).value(rayOffset(scene));
  h.array(scene.scene.positions).array(scene.scene.indices).array(scene.scene.materialIds);
  for (const Material& m : scene.scene.materials) {
    h.value(m.twoSided).value(m.alphaCutoff);
    if (m.alphaCutoff > 0 && m.albedoTexture != kNone) h.array(scene.scene.textures[m.albedoTexture].rgba).array(scene.scene.uvs);
  }
  h.array(scene.probes->positions);
  h.value<uint64_t>(scene.atlas->lumels.size());
  for (const Lumel& l : scene.atlas->lumels) h.value(l.position).value(l.normal);
  h.value(params.sh_order).value(params.receiver_rays).value(params.receivers).value(params.support).value(params.radius).value(params.k);
  h.value(params.compression).value(params.pca_vectors).value(params.pca_tolerance).value(params.pca_keep_constant).value(params.clustering).value(params.cluster_size).value(params.least_clusters);
  if (params.receivers == kReceiversRadiance) h.value(params.glossy_order).array(wideLumels(scene, params));
  h.value(params.environment_rays).value(params.sample_weight).value(readsOf(params)).value(params.probe_share).value(blurLimit(params));
  h.value(params.surface_share).value(params.surface_share ? params.probe_rays : 0);
  return h.hex();
}

void Precomputation::allocate(const SceneView& scene) {
  if (clusters_.clusters.size() > kMostClusters)
    throw Error(ErrorKind::TooLarge, fmt::format("srp: {} clusters are more than {}; raise srp.cluster_size", clusters_.clusters.size(), kMostClusters));
  const uint64_t budget = static_cast<uint64_t>(params_.precompute_memory_mb) << 20;
  uint64_t matrix = 1, near = 1, receivers = 1, leastQuestions = 1, slots = 1;
  for (const ReceiverCluster& c : clusters_.clusters) {
    matrix = std::max<uint64_t>(matrix, uint64_t{allRows(c, params_)} * c.probes.size() * coefficients_);
    near = std::max<uint64_t>(near, c.near.size());
    receivers = std::max<uint64_t>(receivers, c.receivers);
    slots = std::max<uint64_t>(slots, c.slots);
    leastQuestions = std::max<uint64_t>(leastQuestions, uint64_t{c.receivers} * c.slots);
  }
  // Each question belongs to a ray, of which there are fewer the more slots a receiver has; a unit takes at least one sample of each receiver.
  const uint64_t questionBytes = kBytesAQuestion + kBytesARay;
  // A decomposition holds its matrix in single precision and, for a while, three times in double; one is in work at least.
  const uint64_t decomposition = params_.compression == kCompressionNone ? 8 * matrix : 28 * matrix;
  const uint64_t strata = std::max<uint64_t>(1, receivers * reads_);
  const uint64_t fixed = 4 * matrix + decomposition + sizeof(shared::SrpNear) * near + 8 * receivers + sizeof(shared::SrpStratum) * strata;
  const uint64_t largest = device_.maxStorageBufferBytes();
  const uint64_t least = fixed + leastQuestions * questionBytes;
  if (least > budget)
    throw Error(ErrorKind::BadInput, fmt::format("srp: a cluster of {} receivers needs {} MiB to be computed in, and srp.precompute_memory_mb is {}; lower srp.cluster_size",
                                                 receivers, (least >> 20) + 1, params_.precompute_memory_mb));
  if (4 * matrix > largest || leastQuestions * sizeof(shared::Ray) > largest)
    throw Error(ErrorKind::TooLarge, fmt::format("srp: a cluster's {} MiB are more than a buffer of this device holds ({}); lower srp.cluster_size",
                                                 (std::max(4 * matrix, leastQuestions * sizeof(shared::Ray)) >> 20) + 1, largest >> 20));
  const uint64_t wanted = std::min(device_.isCpu() ? kUnitRaysOnCpu : kUnitRaysOnGpu, largest / sizeof(shared::Ray));
  unitQuestions_ = std::max(leastQuestions, std::min(wanted, (budget - fixed) / questionBytes));
  const uint64_t left = budget - fixed - unitQuestions_ * questionBytes;
  // On a CPU device its rays and ours would only be in each other's way, and in that of the frames between.
  compressions_ = device_.isCpu() ? 0 : static_cast<size_t>(std::clamp<uint64_t>(1 + left / decomposition, 1, scene.pool.threads()));

  std::vector<shared::SurfacePoint> points = lumelPoints(*scene.atlas, offset_), sorted;
  sorted.reserve(points.size());
  for (uint32_t lumel : clusters_.lumelOfReceiver) {
    sorted.push_back(points[lumel]);
    sorted.back().flags = lumel;
  }
  points_ = device_.buffer("srp: receivers", std::span<const shared::SurfacePoint>(sorted));
  std::vector<vec4> probes;
  for (vec3 p : scene.probes->positions) probes.push_back(vec4(p, 0.0f));
  probes_ = device_.buffer("srp: probes", std::span<const vec4>(probes));
  near_ = device_.buffer("srp: probes of receivers", sizeof(shared::SrpNear) * near);
  rays_ = device_.buffer("srp: rays", sizeof(shared::Ray) * unitQuestions_, TexelFormat::RGBA32F);
  hits_ = device_.buffer("srp: hits", sizeof(shared::Hit) * unitQuestions_);
  scales_ = device_.buffer("srp: scales", sizeof(float) * unitQuestions_);
  questions_ = device_.buffer("srp: questions", sizeof(shared::Ray) * unitQuestions_, TexelFormat::RGBA32F);
  shares_ = device_.buffer("srp: shares", sizeof(float) * unitQuestions_);
  blocked_ = device_.buffer("srp: blocked", sizeof(uint32_t) * unitQuestions_);
  directional_ = directionalBuffer(device_, params_);
  surfaces_ = device_.buffer("srp: surfaces that probes see", sizeof(float) * (params_.surface_share ? scene.probes->count() * coefficients_ : 1));
  matrix_ = device_.buffer("srp: transport of a cluster", 4 * matrix);
  valid_ = device_.buffer("srp: valid samples", 4 * receivers);
  strata_ = device_.buffer("srp: surfaces to read", sizeof(shared::SrpStratum) * strata);
  uint64_t wide = 1;
  if (params_.receivers == kReceiversRadiance)
    for (const ReceiverCluster& c : clusters_.clusters) wide = std::max<uint64_t>(wide, uint64_t{c.wide} * (rows_ - 1));
  moments_ = device_.buffer("srp: sums of factors", 4 * wide);
  answered_ = device_.buffer("srp: samples of surfaces", 4 * receivers);
}

uint32_t Precomputation::samplesPerUnit(const ReceiverCluster& c) const {
  const uint64_t samples = unitQuestions_ / (uint64_t{c.receivers} * c.slots);
  return static_cast<uint32_t>(std::clamp<uint64_t>(samples, 1, static_cast<uint64_t>(params_.receiver_rays)));
}

uint64_t Precomputation::unitsOf(const ReceiverCluster& c) const {
  const uint32_t samples = samplesPerUnit(c);
  return (static_cast<uint32_t>(params_.receiver_rays) + samples - 1) / samples;
}

WorkState Precomputation::work() const {
  WorkState state;
  state.done = unitsDone_;
  state.total = unitsTotal_;
  if (!state.settled()) state.label = fmt::format("transport: cluster {} of {}", std::min(cluster_ + 1, clusters_.clusters.size()), clusters_.clusters.size());
  return state;
}

void Precomputation::beginCluster(FrameGraph& graph) {
  const ReceiverCluster& c = clusters_.clusters[cluster_];
  device_.upload(near_, c.near.data(), c.near.size() * sizeof(shared::SrpNear));
  graph.clear("srp: clear transport", matrix_);
  graph.clear("srp: clear valid samples", valid_);
  if (params_.receivers == kReceiversRadiance) graph.clear("srp: clear sums of factors", moments_);
  if (reads_ > 0) graph.clear("srp: clear surfaces to read", strata_), graph.clear("srp: clear samples of surfaces", answered_);
}

void Precomputation::recordSurfaceShare(FrameGraph& graph) {
  surfacesKnown_ = true;
  if (!params_.surface_share) return graph.skip("srp: share of surfaces", "srp.surface_share is off");
  struct Constants {
    uint32_t probes, samples, coefficients;
  } constants{static_cast<uint32_t>(scene_.probes->count()), samples_->samples(), coefficients_};
  graph.compute("srp: share of surfaces", "srp/surface_share.comp")
      .bind("codes", samples_->codes(), Access::Read)
      .bind("basis", samples_->basis(), Access::Read)
      .bind("surfaces", surfaces_, Access::Write)
      .push(constants)
      .dispatchThreads(constants.probes * constants.coefficients);
}

void Precomputation::recordUnit(FrameGraph& graph) {
  if (work().settled()) return;
  if (cluster_ == clusters_.clusters.size()) {
    graph.host("srp: compress").run([compressor = compressor_](HostAccess&) { compressor->drain(); });
    ++unitsDone_;
    return;
  }
  const ReceiverCluster& c = clusters_.clusters[cluster_];
  if (!surfacesKnown_) recordSurfaceShare(graph);
  if (sample_ == 0) beginCluster(graph);
  const uint32_t samples = std::min(samplesPerUnit(c), static_cast<uint32_t>(params_.receiver_rays) - sample_);
  const uint32_t rays = c.receivers * samples, questions = rays * c.slots;
  shared::SrpUnit unit{};
  unit.firstReceiver = c.firstReceiver, unit.receivers = c.receivers;
  unit.firstSample = sample_, unit.samples = samples;
  unit.slots = c.slots, unit.columns = static_cast<uint32_t>(c.probes.size()) * coefficients_;
  unit.seed = scene_.seed, unit.environment = params_.environment_rays != 0 ? 1 : 0;
  unit.order = params_.sh_order, unit.offset = offset_, unit.rows = params_.receivers == kReceiversDirectional ? rows_ : 1;
  unit.everySample = params_.sample_weight == kSampleWeightValid ? 0 : 1;
  unit.solidAngle = params_.probe_share == kShareSolidAngle ? 1 : 0;
  unit.wide = params_.receivers == kReceiversRadiance ? c.wide : 0;
  unit.blurLimit = blurLimit(params_), unit.surfaceShare = params_.surface_share ? 1 : 0;
  unit.reads = reads_, unit.allSamples = static_cast<uint32_t>(params_.receiver_rays), unit.resolution = static_cast<uint32_t>(scene_.atlas->resolution);

  graph.compute("srp: make rays", "srp/make_rays.comp").bind("points", points_, Access::Read).bind("rays", rays_, Access::Write).push(unit).dispatchThreads(rays);
  scene_.tracer.record(graph, "srp: cast rays", rays_, hits_, rays, Query::Closest);
  graph.compute("srp: ask probes", "srp/ask_probes.comp")
      .bind("rays", rays_, Access::Read)
      .bind("hits", hits_, Access::Read)
      .bind("near", near_, Access::Read)
      .bind("probes", probes_, Access::Read)
      .bind("triangles", triangles_, Access::Read)
      .bind("questions", questions_, Access::Write)
      .bind("shares", shares_, Access::Write)
      .push(unit)
      .dispatchThreads(questions);
  scene_.tracer.record(graph, "srp: mutual visibility", questions_, blocked_, questions, Query::Any);
  graph.compute("srp: weigh", "srp/weigh.comp")
      .bind("rays", rays_, Access::Read)
      .bind("hits", hits_, Access::Read)
      .bind("blocked", blocked_, Access::Read)
      .bind("triangles", triangles_, Access::Read)
      .bind("shares", shares_, Access::ReadWrite)
      .bind("scales", scales_, Access::Write)
      .push(unit)
      .dispatchThreads(rays);
  graph.compute("srp: accumulate", "srp/accumulate.comp")
      .bind("rays", rays_, Access::Read)
      .bind("points", points_, Access::Read)
      .bind("directional", directional_, Access::Read)
      .bind("hits", hits_, Access::Read)
      .bind("near", near_, Access::Read)
      .bind("questions", questions_, Access::Read)
      .bind("shares", shares_, Access::Read)
      .bind("scales", scales_, Access::Read)
      .bind("surfaces", surfaces_, Access::Read)
      .bind("matrix", matrix_, Access::ReadWrite)
      .bind("valid", valid_, Access::ReadWrite)
      .push(unit)
      .dispatchThreads(c.receivers * c.slots);
  recordRadiance(graph, unit);
  if (reads_ > 0) {
    graph.compute("srp: read surfaces", "srp/read_surfaces.comp")
        .bind("hits", hits_, Access::Read)
        .bind("points", points_, Access::Read)
        .bind("triangles", triangles_, Access::Read)
        .bind("lumelOfTexel", lumelOfTexel_, Access::Read)
        .bind("scales", scales_, Access::Read)
        .bind("strata", strata_, Access::ReadWrite)
        .bind("answered", answered_, Access::ReadWrite)
        .push(unit)
        .dispatchThreads(c.receivers);
  } else {
    graph.skip("srp: read surfaces", "srp.sample_weight is not surface");
  }
  sample_ += samples;
  raysCast_ += rays + questions;
  ++unitsDone_;
  if (sample_ < static_cast<uint32_t>(params_.receiver_rays)) {
    graph.skip("srp: compress", "the cluster's rays are not all cast");
    return;
  }
  recordCompression(graph);
  sample_ = 0;
  ++cluster_;
}

void Precomputation::recordRadiance(FrameGraph& graph, const shared::SrpUnit& unit) {
  if (unit.wide == 0) return graph.skip("srp: accumulate radiance", "no receiver of the cluster is glossy");
  graph.compute("srp: accumulate radiance", "srp/accumulate_radiance.comp")
      .bind("rays", rays_, Access::Read)
      .bind("points", points_, Access::Read)
      .bind("hits", hits_, Access::Read)
      .bind("near", near_, Access::Read)
      .bind("questions", questions_, Access::Read)
      .bind("shares", shares_, Access::Read)
      .bind("scales", scales_, Access::Read)
      .bind("surfaces", surfaces_, Access::Read)
      .bind("matrix", matrix_, Access::ReadWrite)
      .bind("moments", moments_, Access::ReadWrite)
      .push(unit)
      .dispatch((unit.wide * unit.slots + 63) / 64, rows_ - 1);
}

void Precomputation::recordCompression(FrameGraph& graph) {
  const ReceiverCluster& c = clusters_.clusters[cluster_];
  graph.host("srp: compress")
      .read(matrix_)
      .read(valid_)
      .read(strata_)
      .read(answered_)
      .read(moments_)
      .run([compressor = compressor_, matrix = matrix_, valid = valid_, strata = strata_, answered = answered_, moments = moments_, radiance = params_.receivers == kReceiversRadiance, receivers = c.receivers, wide = c.wide, matrixRows = allRows(c, params_), rows = rows_,
            columns = static_cast<uint32_t>(c.probes.size()) * coefficients_, coefficients = coefficients_, reads = reads_](HostAccess& memory) {
        ClusterSums sums;
        if (reads > 0) {
          const std::span<shared::SrpStratum> all = memory.span<shared::SrpStratum>(strata).first(size_t{receivers} * reads);
          const std::span<float> known = memory.span<float>(answered).first(receivers);
          sums.strata.assign(all.begin(), all.end());
          sums.answered.assign(known.begin(), known.end());
        }
        sums.receivers = receivers, sums.wide = wide, sums.rows = rows, sums.columns = columns, sums.coefficients = coefficients;
        const std::span<float> values = memory.span<float>(matrix).first(size_t{matrixRows} * columns), counts = memory.span<float>(valid).first(receivers);
        sums.matrix.assign(values.begin(), values.end());
        sums.valid.assign(counts.begin(), counts.end());
        if (radiance) {
          const std::span<float> factors = memory.span<float>(moments).first(size_t{wide} * (rows - 1));
          sums.moments.assign(factors.begin(), factors.end());
        }
        compressor->add(std::move(sums));
      });
}

void Precomputation::release() {
  for (ReceiverCluster& c : clusters_.clusters) c.near = {};
  near_ = rays_ = hits_ = questions_ = blocked_ = scales_ = matrix_ = valid_ = points_ = shares_ = strata_ = answered_ = directional_ = surfaces_ = moments_ = {};
}

uint64_t Precomputation::workingBytes() const {
  uint64_t bytes = 0;
  for (const Buffer* b : {&points_, &near_, &rays_, &hits_, &questions_, &blocked_, &scales_, &matrix_, &valid_, &shares_, &strata_, &answered_, &moments_}) bytes += *b ? b->size() : 0;
  return bytes;
}

uint64_t Precomputation::hostBytes() const {
  uint64_t bytes = 0;
  for (const ClusterTransport& t : transport()) bytes += 4 * (t.basis.size() + t.weights.size() + t.valid.size() + t.readsOf.size()) + sizeof(shared::SrpRead) * t.reads.size();
  for (const ReceiverCluster& c : clusters_.clusters) bytes += sizeof(shared::SrpNear) * c.near.size() + 4 * c.probes.size();
  return bytes;
}

}  // namespace hl
