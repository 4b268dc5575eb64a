#include "engine/techniques/srp/precomputation.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/techniques/srp/directional.h"
#include "engine/techniques/srp/glossy.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/spherical_harmonics.h"

namespace hl {
namespace {

/// Multiplications of a unit of what probes see, in harmonics: again some 50 ms on two cores.
constexpr uint64_t kUnitSharesOnCpu = 1u << 23, kUnitSharesOnGpu = 1u << 30;
/// Counts with the results: whoever changes what is computed raises it.
constexpr uint32_t kVersion = 7;

/// Where what no probe tells is not read elsewhere, whatever a probe tells is better than nothing.
float blurLimit(const SrpParams& params) { return params.sample_weight == kSampleWeightSurface ? params.blur_limit : 0; }

}  // namespace

float Precomputation::rayOffset(const SceneView& scene) { return scene.direct.ray_offset * scene.gpuScene.diagonal; }

MemoryLimits memoryLimits(const Device& device, const SceneView& scene) { return {device.maxStorageBufferBytes(), device.isCpu(), scene.pool.threads()}; }

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
  if (sharesWanted()) unitsTotal_ += (scene.probes->count() + probesAUnit() - 1) / probesAUnit();
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
  compressor_ = std::make_shared<Compressor>(params_, scene_.seed, decompositions_, std::move(store), std::move(finished));
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
  const MemoryLimits limits = memoryLimits(device_, scene);
  checkFrameMemory(clusters_, params_, limits);
  const WorkingMemory m = planWorkingMemory(clusters_, params_, scene.probes->count(), limits);
  unitQuestions_ = m.questions;
  decompositions_ = m.decompositions;

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
  near_ = device_.buffer("srp: probes of receivers", sizeof(shared::SrpNear) * m.near);
  rays_ = device_.buffer("srp: rays", sizeof(shared::Ray) * m.questions, TexelFormat::RGBA32F);
  hits_ = device_.buffer("srp: hits", sizeof(shared::Hit) * m.questions);
  scales_ = device_.buffer("srp: scales", sizeof(float) * m.questions);
  questions_ = device_.buffer("srp: questions", sizeof(shared::Ray) * m.questions, TexelFormat::RGBA32F);
  shares_ = device_.buffer("srp: shares", sizeof(float) * m.questions);
  blocked_ = device_.buffer("srp: blocked", sizeof(uint32_t) * m.questions);
  directional_ = directionalBuffer(device_, params_);
  surfaces_ = device_.buffer("srp: surfaces that probes see", sizeof(float) * m.surfaces);
  matrix_ = device_.buffer("srp: transport of a cluster", sizeof(float) * m.matrix);
  valid_ = device_.buffer("srp: valid samples", sizeof(float) * m.receivers);
  tallies_ = device_.buffer("srp: tallies of samples", sizeof(shared::SrpTally) * m.receivers);
  strata_ = device_.buffer("srp: surfaces to read", sizeof(shared::SrpStratum) * m.strata);
  moments_ = device_.buffer("srp: sums of factors", sizeof(float) * m.moments);
  answered_ = device_.buffer("srp: samples of surfaces", sizeof(float) * m.receivers);
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
  if (sharesWanted()) state.label = "share of surfaces that probes see";
  else if (!state.settled()) state.label = fmt::format("transport: cluster {} of {}", std::min(cluster_ + 1, clusters_.clusters.size()), clusters_.clusters.size());
  return state;
}

void Precomputation::beginCluster(FrameGraph& graph) {
  const ReceiverCluster& c = clusters_.clusters[cluster_];
  device_.upload(near_, c.near.data(), c.near.size() * sizeof(shared::SrpNear));
  graph.clear("srp: clear transport", matrix_);
  graph.clear("srp: clear valid samples", valid_);
  graph.clear("srp: clear tallies of samples", tallies_);
  if (params_.receivers == kReceiversRadiance) graph.clear("srp: clear sums of factors", moments_);
  if (reads_ > 0) graph.clear("srp: clear surfaces to read", strata_), graph.clear("srp: clear samples of surfaces", answered_);
}

/// Not where the disk has all clusters.
bool Precomputation::sharesWanted() const { return params_.surface_share && cluster_ < clusters_.clusters.size() && probesShared_ < scene_.probes->count(); }

uint32_t Precomputation::probesAUnit() const {
  const uint64_t sums = uint64_t{samples_->samples()} * coefficients_;
  return static_cast<uint32_t>(std::max<uint64_t>(1, (device_.isCpu() ? kUnitSharesOnCpu : kUnitSharesOnGpu) / sums));
}

void Precomputation::recordSurfaceShare(FrameGraph& graph) {
  const uint32_t count = std::min(probesAUnit(), static_cast<uint32_t>(scene_.probes->count()) - probesShared_);
  struct Constants {
    uint32_t first, probes, samples, coefficients;
  } constants{probesShared_, count, samples_->samples(), coefficients_};
  graph.compute("srp: share of surfaces", "srp/surface_share.comp")
      .bind("codes", samples_->codes(), Access::Read)
      .bind("basis", samples_->basis(), Access::Read)
      .bind("surfaces", surfaces_, Access::Write)
      .push(constants)
      .dispatchThreads(count * coefficients_);
  probesShared_ += count;
  ++unitsDone_;
}

void Precomputation::recordUnit(FrameGraph& graph) {
  if (work().settled()) return;
  if (cluster_ == clusters_.clusters.size()) {
    graph.host("srp: compress").run([compressor = compressor_](HostAccess&) { compressor->drain(); });
    ++unitsDone_;
    return;
  }
  const ReceiverCluster& c = clusters_.clusters[cluster_];
  if (sharesWanted()) return recordSurfaceShare(graph);
  if (!params_.surface_share && sample_ == 0 && cluster_ == fromDisk_) graph.skip("srp: share of surfaces", "srp.surface_share is off");
  if (sample_ == 0) beginCluster(graph);
  const uint32_t samples = std::min(samplesPerUnit(c), static_cast<uint32_t>(params_.receiver_rays) - sample_);
  const uint32_t rays = c.receivers * samples, questions = rays * c.slots;
  shared::SrpUnit unit = unitOf(scene_, params_);
  unit.firstReceiver = c.firstReceiver, unit.receivers = c.receivers;
  unit.firstSample = sample_, unit.samples = samples;
  unit.slots = c.slots, unit.columns = static_cast<uint32_t>(c.probes.size()) * coefficients_;
  unit.rows = params_.receivers == kReceiversDirectional ? rows_ : 1;
  unit.wide = params_.receivers == kReceiversRadiance ? c.wide : 0;
  unit.reads = reads_;

  recordQuestions(graph, scene_, unit, {points_, rays_, hits_, near_, probes_, triangles_, questions_, shares_, blocked_, scales_});
  graph.compute("srp: weigh answers", "srp/weigh_answers.comp")
      .bind("hits", hits_, Access::Read)
      .bind("near", near_, Access::Read)
      .bind("questions", questions_, Access::Read)
      .bind("surfaces", surfaces_, Access::Read)
      .bind("shares", shares_, Access::ReadWrite)
      .bind("scales", scales_, Access::ReadWrite)
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
      .bind("matrix", matrix_, Access::ReadWrite)
      .bind("valid", valid_, Access::ReadWrite)
      .bind("tallies", tallies_, Access::ReadWrite)
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

shared::SrpUnit Precomputation::unitOf(const SceneView& scene, const SrpParams& params) {
  shared::SrpUnit unit{};
  unit.seed = scene.seed, unit.environment = params.environment_rays != 0 ? 1 : 0;
  unit.order = params.sh_order, unit.offset = rayOffset(scene), unit.rows = 1;
  unit.everySample = params.sample_weight == kSampleWeightValid ? 0 : 1;
  unit.solidAngle = params.probe_share == kShareSolidAngle ? 1 : 0;
  unit.blurLimit = blurLimit(params), unit.surfaceShare = params.surface_share ? 1 : 0;
  unit.allSamples = static_cast<uint32_t>(params.receiver_rays), unit.resolution = static_cast<uint32_t>(scene.atlas->resolution);
  return unit;
}

void Precomputation::recordQuestions(FrameGraph& graph, const SceneView& scene, const shared::SrpUnit& unit, const Questions& b) {
  const uint32_t rays = unit.receivers * unit.samples, questions = rays * unit.slots;
  graph.compute("srp: make rays", "srp/make_rays.comp").bind("points", b.points, Access::Read).bind("rays", b.rays, Access::Write).push(unit).dispatchThreads(rays);
  scene.tracer.record(graph, "srp: cast rays", b.rays, b.hits, rays, Query::Closest);
  graph.compute("srp: ask probes", "srp/ask_probes.comp")
      .bind("rays", b.rays, Access::Read)
      .bind("hits", b.hits, Access::Read)
      .bind("near", b.near, Access::Read)
      .bind("probes", b.probes, Access::Read)
      .bind("triangles", b.triangles, Access::Read)
      .bind("questions", b.questions, Access::Write)
      .bind("shares", b.shares, Access::Write)
      .push(unit)
      .dispatchThreads(questions);
  scene.tracer.record(graph, "srp: mutual visibility", b.questions, b.blocked, questions, Query::Any);
  graph.compute("srp: weigh", "srp/weigh.comp")
      .bind("rays", b.rays, Access::Read)
      .bind("hits", b.hits, Access::Read)
      .bind("blocked", b.blocked, Access::Read)
      .bind("triangles", b.triangles, Access::Read)
      .bind("shares", b.shares, Access::ReadWrite)
      .bind("scales", b.scales, Access::Write)
      .push(unit)
      .dispatchThreads(rays);
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
      .read(tallies_)
      .read(strata_)
      .read(answered_)
      .read(moments_)
      .run([compressor = compressor_, matrix = matrix_, valid = valid_, tallies = tallies_, strata = strata_, answered = answered_, moments = moments_, radiance = params_.receivers == kReceiversRadiance, receivers = c.receivers, wide = c.wide, matrixRows = allRows(c, params_), rows = rows_,
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
        for (const shared::SrpTally& t : memory.span<shared::SrpTally>(tallies).first(receivers)) sums.coarse += t.coarse, sums.scarce += t.scarce;
        if (radiance) {
          const std::span<float> factors = memory.span<float>(moments).first(size_t{wide} * (rows - 1));
          sums.moments.assign(factors.begin(), factors.end());
        }
        compressor->add(std::move(sums));
      });
}

void Precomputation::release() {
  for (ReceiverCluster& c : clusters_.clusters) c.near = {};
  forWorkingBuffers(*this, [](Buffer& b) { b = {}; });
  triangles_ = {};
}

uint64_t Precomputation::workingBytes() const {
  uint64_t bytes = 0;
  forWorkingBuffers(*this, [&](const Buffer& b) { bytes += b ? b.size() : 0; });
  return bytes;
}

uint64_t Precomputation::hostBytes() const {
  uint64_t bytes = 4 * clusters_.lumelOfReceiver.size();
  for (const ClusterTransport& t : transport()) bytes += 4 * (t.basis.size() + t.weights.size() + t.valid.size() + t.readsOf.size()) + sizeof(shared::SrpRead) * t.reads.size();
  for (const ReceiverCluster& c : clusters_.clusters) bytes += sizeof(shared::SrpNear) * c.near.size() + 4 * c.probes.size();
  return bytes;
}

}  // namespace hl
