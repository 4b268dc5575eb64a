#include "engine/techniques/srp/compressor.h"

#include <chrono>
#include <string>

#include "engine/core/log.h"
#include "engine/core/math.h"
#include "engine/techniques/srp/cpca.h"

namespace hl {

ClusterTransport compressCluster(ClusterSums sums, const SrpParams& params, uint32_t seed) {
  const auto all = static_cast<float>(params.receiver_rays);
  ClusterTransport t;
  t.receivers = sums.receivers, t.columns = sums.columns;
  std::vector<float>& alpha = sums.matrix;
  for (size_t r = 0; r < sums.receivers; ++r) {
    t.valid.push_back(sums.valid[r] / all);
    const float samples = params.sample_weight == kSampleWeightAll ? all : sums.valid[r];
    const float scale = samples > 0 ? kPi / samples : 0.0f;
    for (size_t i = 0; i < sums.columns; ++i) alpha[r * sums.columns + i] *= scale;
  }
  if (params.compression == kCompressionNone) {
    for (float a : alpha) t.total += static_cast<double>(a) * static_cast<double>(a);
    t.rank = sums.columns;
    t.weights = std::move(alpha);
    return t;
  }
  ComponentSettings settings;
  settings.most = static_cast<uint32_t>(params.pca_vectors);
  settings.tolerance = static_cast<double>(params.pca_tolerance);
  settings.seed = seed;
  if (params.pca_keep_constant) settings.keep = constantLights(alpha, sums.receivers, sums.columns, sums.coefficients);
  Components p = principalComponents(alpha, sums.receivers, sums.columns, settings);
  t.rank = p.rank;
  t.basis = std::move(p.basis);
  t.weights = std::move(p.weights);
  t.total = p.total, t.discarded = p.discarded;
  return t;
}

Compressor::Compressor(const SrpParams& params, uint32_t seed, size_t most, std::shared_ptr<TransportStore> store, std::vector<ClusterTransport> finished)
    : params_(params), seed_(seed), most_(most), store_(std::move(store)), finished_(std::move(finished)) {}

/// Work was stopped: what is begun is waited for in any case, and so is kept.
Compressor::~Compressor() {
  try {
    drain();
  } catch (const std::exception& e) {
    logWarning(std::string("srp: transport that was done could not be kept: ") + e.what());
    for (auto& f : inWork_) f.wait();
  }
}

void Compressor::takeFirst() {
  ClusterTransport t = inWork_.front().get();
  inWork_.pop_front();
  if (store_) store_->append(t);
  finished_.push_back(std::move(t));
}

void Compressor::add(ClusterSums sums) {
  const auto ready = [&] { return inWork_.front().wait_for(std::chrono::seconds(0)) == std::future_status::ready; };
  while (!inWork_.empty() && (inWork_.size() >= most_ || ready())) takeFirst();
  inWork_.push_back(std::async(std::launch::async, [sums = std::move(sums), params = params_, seed = seed_]() mutable { return compressCluster(std::move(sums), params, seed); }));
}

void Compressor::drain() {
  while (!inWork_.empty()) takeFirst();
}

}  // namespace hl
