#include "engine/techniques/srp/runtime.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <glm/gtc/packing.hpp>

#include "engine/core/error.h"
#include "engine/techniques/srp/directional.h"
#include "engine/techniques/srp/precomputation.h"
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/spherical_harmonics.h"

namespace hl {
namespace {

uint32_t partsOf(const SrpParams& params) { return (static_cast<uint32_t>(params.probe_rays) + shared::kSrpPartSamples - 1) / shared::kSrpPartSamples; }

uint64_t partSumBytes(const SrpParams& params, uint64_t probes) { return probes * partsOf(params) * static_cast<uint64_t>(shared::shCount(params.sh_order)) * sizeof(vec4); }

}  // namespace

void SrpRuntime::check(const Device& device, const SrpParams& params, uint64_t probes) {
  if (const uint64_t sums = partSumBytes(params, probes); sums > device.maxStorageBufferBytes())
    throw Error(ErrorKind::TooLarge, fmt::format("srp: sums over the rays of {} probes need {} MiB, more than a buffer of this device holds; lower srp.probe_rays or srp.sh_order",
                                                 probes, sums >> 20));
}

SrpRuntime::SrpRuntime(Gpu& gpu, const SceneView& scene, const SrpParams& params, const ReceiverClusters& clusters, std::span<const ClusterTransport> transport,
                       const LightmapTables& tables, const ProbeSamples& samples)
    : device_(gpu.device), scene_(scene), params_(params), codes_(samples.codes()), basis_(samples.basis()) {
  lumels_ = clusters.receivers();
  probes_ = static_cast<uint32_t>(scene.probes->count());
  coefficientCount_ = static_cast<uint32_t>(shared::shCount(params.sh_order));
  const std::vector<shared::SurfacePoint> points = lumelPoints(*scene.atlas, scene.direct.ray_offset * scene.gpuScene.diagonal);
  points_ = device_.buffer("srp: lumels", std::span<const shared::SurfacePoint>(points));
  reflectance_ = device_.buffer("srp: reflectance", std::span<const vec4>(tables.reflectance));
  direct_ = device_.buffer("srp: direct", lumels_ * sizeof(vec4));
  irradiance_ = device_.buffer("srp: irradiance", lumels_ * sizeof(vec4));
  directionalTable_ = directionalBuffer(device_, params_);
  slopes_ = device_.buffer("srp: slopes of irradiance", (directional() ? uint64_t{kSlopes} * lumels_ : 1) * sizeof(vec4));
  noIrradiance_ = device_.buffer("srp: no irradiance", lumels_ * sizeof(vec4));
  radiance_ = device_.buffer("srp: radiance", lumels_ * sizeof(vec4), TexelFormat::RGBA32F);
  coefficients_ = device_.buffer("srp: radiance of probes", uint64_t{probes_} * coefficientCount_ * sizeof(vec4));
  parts_ = partsOf(params);
  partSums_ = device_.buffer("srp: sums over parts of probes' rays", partSumBytes(params, probes_));
  lumelOfReceiver_ = device_.buffer("srp: lumel of receiver", std::span<const uint32_t>(clusters.lumelOfReceiver));
  counters_ = device_.buffer("srp: counters", shared::kSrpCounters * sizeof(uint32_t));
  uploadPages(clusters, transport);
  uploadReads(transport);
  if (params.receivers != kReceiversRadiance || wide_ == 0) return;
  terms_ = rowsOf(params) - 1;
  incident_ = device_.buffer("srp: radiance at glossy receivers", incidentBytes(clusters, params));
}

void SrpRuntime::uploadReads(std::span<const ClusterTransport> transport) {
  std::vector<uint32_t> first{0};
  std::vector<shared::SrpRead> reads;
  for (const ClusterTransport& t : transport) {
    for (uint32_t n : t.readsOf) first.push_back(first.back() + n);
    reads.insert(reads.end(), t.reads.begin(), t.reads.end());
  }
  if (reads.size() * sizeof(shared::SrpRead) > device_.maxStorageBufferBytes())
    throw Error(ErrorKind::TooLarge, fmt::format("srp: {} MiB of surfaces that receivers read are more than a buffer of this device holds; lower srp.surface_reads",
                                                 reads.size() * sizeof(shared::SrpRead) >> 20));
  anyReads_ = !reads.empty();
  if (reads.empty()) reads.push_back({0, 0.0f});
  firstRead_ = device_.buffer("srp: reads of receivers", std::span<const uint32_t>(first));
  reads_ = device_.buffer("srp: surfaces read", std::span<const shared::SrpRead>(reads));
}

/// Matrices one after the other, in as few buffers as the device's largest allows.
void SrpRuntime::uploadPages(const ReceiverClusters& all, std::span<const ClusterTransport> transport) {
  const bool half = params_.storage == kStorageFloat16;
  const uint64_t numberBytes = half ? 2 : 4;
  const uint64_t largest = device_.maxStorageBufferBytes() / numberBytes;
  std::vector<shared::SrpCluster> clusters;
  std::vector<uint32_t> probes, words;
  std::vector<float> numbers;
  uint32_t vectors = 0;
  wide_ = 0;
  Page page;
  const auto finish = [&] {
    if (page.clusters == 0) return;
    if (half) {
      if (numbers.size() % 2 == 1) numbers.push_back(0.0f);
      words.resize(numbers.size() / 2);
      for (size_t i = 0; i < words.size(); ++i) words[i] = glm::packHalf1x16(numbers[2 * i]) | static_cast<uint32_t>(glm::packHalf1x16(numbers[2 * i + 1])) << 16;
      page.words = device_.buffer(fmt::format("srp: matrices {}", pages_.size()), std::span<const uint32_t>(words));
    } else {
      page.words = device_.buffer(fmt::format("srp: matrices {}", pages_.size()), std::span<const float>(numbers));
    }
    pages_.push_back(page);
    numbers.clear();
  };
  for (size_t i = 0; i < transport.size(); ++i) {
    const ClusterTransport& t = transport[i];
    const ReceiverCluster& c = all.clusters[i];
    const uint64_t size = t.basis.size() + t.weights.size();
    if (size > largest)
      throw Error(ErrorKind::TooLarge, fmt::format("srp: the matrices of a cluster of {} receivers are {} MiB, more than a buffer of this device holds; lower srp.cluster_size",
                                                   c.receivers, size * numberBytes >> 20));
    if (numbers.size() + size > largest) {
      finish();
      page = {};
      page.firstCluster = static_cast<uint32_t>(i);
    }
    shared::SrpCluster g{};
    g.firstReceiver = c.firstReceiver, g.receivers = c.receivers;
    g.firstProbe = static_cast<uint32_t>(probes.size()), g.probes = static_cast<uint32_t>(c.probes.size());
    g.rank = t.rank, g.firstVector = vectors;
    g.basis = static_cast<uint32_t>(numbers.size());
    numbers.insert(numbers.end(), t.basis.begin(), t.basis.end());
    g.weights = static_cast<uint32_t>(numbers.size());
    g.rows = t.allRows(), g.wide = t.wide, g.firstWide = wide_;
    wide_ += t.wide;
    for (uint32_t k = 0; k < t.rank; ++k)
      for (uint32_t r = 0; r < g.rows; ++r) numbers.push_back(t.weights[size_t{r} * t.rank + k]);
    probes.insert(probes.end(), c.probes.begin(), c.probes.end());
    vectors += t.rank;
    clusters.push_back(g);
    ++page.clusters;
    page.mostRank = std::max(page.mostRank, t.rank);
    page.mostReceivers = std::max(page.mostReceivers, c.receivers);
    page.mostWide = std::max(page.mostWide, c.wide);
  }
  finish();
  clusters_ = device_.buffer("srp: clusters", std::span<const shared::SrpCluster>(clusters));
  clusterProbes_ = device_.buffer("srp: probes of clusters", std::span<const uint32_t>(probes));
  vectors_ = device_.buffer("srp: light vectors", std::max(1u, vectors) * sizeof(vec4));
}

void SrpRuntime::restart(const SrpParams& params) {
  params_ = params;
  clearWanted_ = clearDirectWanted_ = true;
  directSample_ = frame_ = 0;
}

void SrpRuntime::lightsChanged() {
  clearDirectWanted_ = true;
  directSample_ = 0;
}

uint32_t SrpRuntime::directSamples() const {
  return scene_.directLight.exactAfterOneSample() ? 1 : static_cast<uint32_t>(scene_.direct.lumel_samples);
}

void SrpRuntime::record(FrameGraph& graph) {
  if (clearWanted_) {
    graph.clear("srp: clear irradiance", irradiance_);
    graph.clear("srp: clear irradiance", noIrradiance_);
    graph.clear("srp: clear probes", coefficients_);
  }
  clearWanted_ = false;
  recordDirect(graph);
  graph.compute("srp: lightmap update", "passes/lightmap_reflect.comp")
      .bind("reflectance", reflectance_, Access::Read)
      .bind("direct", direct_, Access::Read)
      .bind("irradiance", params_.multi_bounce ? irradiance_ : noIrradiance_, Access::Read)
      .bind("radiance", radiance_, Access::Write)
      .push(lumels_)
      .dispatchThreads(lumels_);
  recordProbes(graph);
  recordClusters(graph);
  ++frame_;
}

/// One sample of every light a frame, and the mean over frames, until there are enough.
void SrpRuntime::recordDirect(FrameGraph& graph) {
  if (clearDirectWanted_) graph.clear("srp: clear direct light", direct_);
  clearDirectWanted_ = false;
  if (directSample_ >= directSamples()) {
    for (const char* pass : {"srp: direct light: sample lights", "srp: direct light: shadow rays", "srp: direct light: accumulate"}) graph.skip(pass, "settled");
    return;
  }
  scene_.directLight.record(graph, "srp: direct light", points_, direct_, 0, lumels_, scene_.seed, directSample_);
  ++directSample_;
}

void SrpRuntime::recordProbes(FrameGraph& graph) {
  const auto stride = static_cast<uint32_t>(params_.update_frames);
  // All of them in the first frame: what was never updated is not old but dark.
  const bool all = frame_ == 0;
  const uint32_t first = all ? 0 : frame_ % stride, step = all ? 1 : stride;
  if (first >= probes_) {
    graph.skip("srp: project probes", "no probe's turn");
    graph.skip("srp: sum probes", "no probe's turn");
    return;
  }
  const shared::SrpTurn turn{first, step, (probes_ - first + step - 1) / step, parts_};
  graph.compute("srp: project probes", "srp/project_probes.comp")
      .bind("codes", codes_, Access::Read)
      .bind("basis", basis_, Access::Read)
      .bind("radiance", radiance_, Access::Read)
      .bind("partSums", partSums_, Access::Write)
      .uniform("srp", params_)
      .push(turn)
      .dispatch(turn.count, turn.parts);
  graph.compute("srp: sum probes", "srp/sum_probes.comp")
      .bind("partSums", partSums_, Access::Read)
      .bind("coefficients", coefficients_, Access::Write)
      .uniform("srp", params_)
      .push(turn)
      .dispatchThreads(turn.count * coefficientCount_);
}

void SrpRuntime::recordClusters(FrameGraph& graph) {
  const bool compressed = params_.compression != kCompressionNone;
  const uint32_t half = params_.storage == kStorageFloat16 ? 1 : 0;
  constexpr uint32_t kLanes = 64;
  graph.clear("srp: clear counters", counters_);
  for (const Page& page : pages_) {
    const shared::SrpPage batch{page.firstCluster, page.clusters, coefficientCount_, params_.clamp_negative != 0 ? 1u : 0u};
    if (page.mostRank > 0) {
      graph.compute("srp: project clusters", "srp/project_clusters.comp")
          .bind("clusters", clusters_, Access::Read)
          .bind("clusterProbes", clusterProbes_, Access::Read)
          .bind("coefficients", coefficients_, Access::Read)
          .bind("page", page.words, Access::Read)
          .bind("vectors", vectors_, Access::Write)
          .specialize("kHalf", half)
          .specialize("kCompressed", compressed ? 1 : 0)
          .push(batch)
          .dispatch(compressed ? page.mostRank : (page.mostRank + kLanes - 1) / kLanes, page.clusters);
    }
    graph.compute("srp: irradiance transport", "srp/transport.comp")
        .bind("clusters", clusters_, Access::Read)
        .bind("page", page.words, Access::Read)
        .bind("vectors", vectors_, Access::Read)
        .bind("lumelOfReceiver", lumelOfReceiver_, Access::Read)
        .bind("irradiance", irradiance_, Access::Write)
        .bind("counters", counters_, Access::ReadWrite)
        .bind("points", points_, Access::Read)
        .bind("directional", directionalTable_, Access::Read)
        .bind("slopes", slopes_, Access::Write)
        .bind("firstRead", firstRead_, Access::Read)
        .bind("reads", reads_, Access::Read)
        .bind("radiance", radiance_, Access::Read)
        .specialize("kHalf", half)
        .specialize("kDirectional", directional() ? 1 : 0)
        .specialize("kReads", anyReads_ ? 1 : 0)
        .push(batch)
        .dispatch((page.mostReceivers + kLanes - 1) / kLanes, page.clusters);
    if (terms_ == 0 || page.mostWide == 0) continue;
    graph.compute("srp: radiance transport", "srp/radiance_transport.comp")
        .bind("clusters", clusters_, Access::Read)
        .bind("page", page.words, Access::Read)
        .bind("vectors", vectors_, Access::Read)
        .bind("lumelOfReceiver", lumelOfReceiver_, Access::Read)
        .bind("incident", incident_, Access::Write)
        .bind("points", points_, Access::Read)
        .bind("firstRead", firstRead_, Access::Read)
        .bind("reads", reads_, Access::Read)
        .bind("radiance", radiance_, Access::Read)
        .specialize("kHalf", half)
        .specialize("kReads", anyReads_ ? 1 : 0)
        .push(batch)
        .dispatch((page.mostWide + kLanes - 1) / kLanes, page.clusters, terms_);
  }
}

uint64_t SrpRuntime::matrixBytes() const {
  uint64_t bytes = 0;
  for (const Page& p : pages_) bytes += p.words.size();
  return bytes;
}

uint64_t SrpRuntime::readBytes() const { return anyReads_ ? firstRead_.size() + reads_.size() : 0; }

std::vector<MemoryItem> SrpRuntime::memory() const {
  uint64_t lumels = 0, probes = 0;
  for (const Buffer* b : {&points_, &reflectance_, &direct_, &irradiance_, &slopes_, &noIrradiance_, &radiance_, &lumelOfReceiver_}) lumels += b->size();
  for (const Buffer* b : {&codes_, &basis_, &partSums_, &coefficients_}) probes += b->size();
  std::vector<MemoryItem> items = {{"transport matrices", matrixBytes()}, {"surfaces read", readBytes()}, {"clusters", clusters_.size() + clusterProbes_.size() + vectors_.size()}, {"probes", probes}, {"lumels", lumels}};
  if (incident_) items.push_back({"radiance at glossy receivers", incident_.size()});
  return items;
}

SrpRuntime::Counts SrpRuntime::counts() const {
  std::array<uint32_t, shared::kSrpCounters> counts{};
  if (frame_ > 0) device_.download(counters_, counts.data(), sizeof counts);
  return {counts[shared::kSrpNegative], counts[shared::kSrpNonFinite]};
}

}  // namespace hl
