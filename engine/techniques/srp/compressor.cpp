#include "engine/techniques/srp/compressor.h"

#include <chrono>
#include <string>

#include "engine/core/log.h"
#include "engine/core/math.h"
#include "engine/techniques/srp/cpca.h"
#include "engine/techniques/srp/hemisphere_basis.h"

namespace hl {
namespace {

/// Samples are not spread as evenly as the integral is: their mean factors are not what they ought to be, and light that is the same everywhere would have a shape. Each row takes
/// of irradiance's what sets that right (a control variate), so that constant radiance comes out as it is.
void keepConstantRadiance(const ClusterSums& sums, std::vector<float>& alpha, const SrpParams& params) {
  const size_t terms = sums.rows - 1, columns = sums.columns;
  for (size_t r = 0; r < sums.wide && !sums.moments.empty(); ++r) {
    const float samples = params.sample_weight == kSampleWeightValid ? sums.valid[r] : static_cast<float>(params.receiver_rays);
    if (!(samples > 0)) continue;
    for (size_t j = 0; j < terms; ++j) {
      const float missing = shared::hemisphereMeanFactor(static_cast<int>(j)) - sums.moments[r * terms + j] / samples;
      const float* irradiance = alpha.data() + r * columns;
      float* row = alpha.data() + (sums.receivers + j * sums.wide + r) * columns;
      for (size_t i = 0; i < columns; ++i) row[i] += missing * irradiance[i];
    }
  }
}

}  // namespace

ClusterTransport compressCluster(ClusterSums sums, const SrpParams& params, uint32_t seed) {
  const auto all = static_cast<float>(params.receiver_rays);
  ClusterTransport t;
  t.receivers = sums.receivers, t.wide = sums.wide, t.rows = sums.rows, t.columns = sums.columns;
  t.coarse = sums.coarse, t.scarce = sums.scarce;
  std::vector<float>& alpha = sums.matrix;
  const uint32_t rows = t.allRows();
  const size_t strata = sums.receivers > 0 ? sums.strata.size() / sums.receivers : 0;
  for (size_t r = 0; r < sums.receivers; ++r) {
    t.valid.push_back(sums.valid[r] / all);
    const float samples = params.sample_weight == kSampleWeightAll ? all : sums.valid[r] + (strata > 0 ? sums.answered[r] : 0.0f);
    const float scale = samples > 0 ? kPi / samples : 0.0f;
    if (strata > 0) {
      const size_t before = t.reads.size();
      for (size_t s = 0; s < strata; ++s) {
        const shared::SrpStratum& read = sums.strata[r * strata + s];
        if (read.count > 0) t.reads.push_back({read.lumel, scale * static_cast<float>(read.count)});
      }
      t.readsOf.push_back(static_cast<uint32_t>(t.reads.size() - before));
    }
    for (size_t k = 0; k < (r < sums.wide ? sums.rows : 1); ++k) {
      const size_t row = k == 0 ? r : sums.receivers + (k - 1) * sums.wide + r;
      for (size_t i = 0; i < sums.columns; ++i) alpha[row * sums.columns + i] *= scale;
    }
  }
  keepConstantRadiance(sums, alpha, params);
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
  if (params.pca_keep_constant) settings.keep = constantLights(alpha, rows, sums.columns, sums.coefficients);
  Components p = principalComponents(alpha, rows, sums.columns, settings);
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
    logWarning(std::string("srp: the last transport was not kept: ") + e.what());
  }
}

/// The first in work becomes the last that is finished. One that failed leaves a gap, and nothing is added after it: each cluster is known by its place.
void Compressor::takeFirst() {
  if (failed_) std::rethrow_exception(failed_);
  std::future<ClusterTransport> first = std::move(inWork_.front());
  inWork_.pop_front();
  try {
    finished_.push_back(first.get());
  } catch (...) {
    failed_ = std::current_exception();
    inWork_.clear();  // waits for them
    throw;
  }
  if (!store_) return;
  try {
    store_->append(finished_.size() - 1, finished_.back());
  } catch (const std::exception& e) {
    // The disk is for the next time; this time goes on without.
    logWarning(std::string("srp: transport is not kept on disk: ") + e.what());
    store_.reset();
  }
}

void Compressor::add(ClusterSums sums) {
  if (failed_) std::rethrow_exception(failed_);
  const auto work = [params = params_, seed = seed_](ClusterSums s) { return compressCluster(std::move(s), params, seed); };
  if (most_ == 0) {
    std::promise<ClusterTransport> done;
    done.set_value(work(std::move(sums)));
    inWork_.push_back(done.get_future());
    return takeFirst();
  }
  const auto ready = [&] { return inWork_.front().wait_for(std::chrono::seconds(0)) == std::future_status::ready; };
  while (!inWork_.empty() && (inWork_.size() >= most_ || ready())) takeFirst();
  inWork_.push_back(std::async(std::launch::async, work, std::move(sums)));
}

void Compressor::drain() {
  while (!inWork_.empty()) takeFirst();
}

}  // namespace hl
