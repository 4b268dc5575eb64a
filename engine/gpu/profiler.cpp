#include "engine/gpu/profiler.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hl {
namespace {

/// The value below which `fraction` of the samples lie, between the two nearest ones.
double quantile(const std::vector<double>& sorted, double fraction) {
  if (sorted.empty()) return 0;
  const double at = fraction * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<size_t>(std::floor(at));
  const size_t high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (at - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

PassStatistics statistics(const std::string& name, const char* where, const std::deque<double>& samples) {
  PassStatistics s;
  s.name = name;
  s.where = where;
  if (samples.empty()) return s;
  std::vector<double> sorted(samples.begin(), samples.end());
  std::sort(sorted.begin(), sorted.end());
  s.medianMs = quantile(sorted, 0.5);
  s.p5Ms = quantile(sorted, 0.05);
  s.p95Ms = quantile(sorted, 0.95);
  s.meanMs = std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(sorted.size());
  s.lastMs = samples.back();
  return s;
}

}  // namespace

double BatchTimings::unaccounted() const {
  double sum = 0;
  for (const PassTiming& p : passes) sum += p.ms;
  return wallMs > 0 ? 1 - sum / wallMs : 0;
}

void Profiler::add(const BatchTimings& batch) {
  ++frames_;
  // A name that occurs more than once in a batch is one pass with the sum of their times.
  const std::vector<PassTiming> before = std::move(order_);
  order_.clear();
  const auto find = [&](const std::string& name) { return std::find_if(order_.begin(), order_.end(), [&](const PassTiming& t) { return t.name == name; }); };
  for (const PassTiming& timing : batch.passes) {
    const auto known = find(timing.name);
    if (known == order_.end()) {
      order_.push_back(timing);
    } else {
      known->ms += timing.ms;
      known->creationMs += timing.creationMs;
      if (timing.skipped.empty()) known->skipped.clear();
    }
  }
  // What runs in some frames only keeps its place among the others.
  for (size_t i = 0; i < before.size(); ++i) {
    if (find(before[i].name) != order_.end() || inWindow(before[i].name).ran == 0) continue;
    auto at = order_.begin();
    for (size_t k = i; k-- > 0;)
      if (const auto ahead = find(before[k].name); ahead != order_.end()) {
        at = ahead + 1;
        break;
      }
    order_.insert(at, {before[i].name, before[i].host, 0, 0, "not in the latest frame"});
  }
  bool warmUp = false;
  for (const PassTiming& timing : order_) {
    if (!timing.skipped.empty()) continue;
    // The first run compiles, and a new pipeline does so again.
    const bool first = seen_[timing.name]++ == 0 || timing.creationMs > 0;
    warmUp = warmUp || first;
    if (first) {
      warm_[timing.name] = frames_ + 1;
      continue;
    }
    auto& samples = history_[timing.name];
    auto& ran = ran_[timing.name];
    samples.push_back(timing.ms), ran.push_back(frames_);
    if (samples.size() > window_) samples.pop_front(), ran.pop_front();
  }
  if (warmUp) return;
  wall_.push_back(batch.wallMs);
  if (wall_.size() > window_) wall_.pop_front();
  unaccounted_.push_back(batch.unaccounted());
  if (unaccounted_.size() > window_) unaccounted_.pop_front();
}

void Profiler::forgetTimes() {
  history_.clear();
  ran_.clear();
  wall_.clear();
  unaccounted_.clear();
  for (auto& [pass, first] : warm_) first = frames_ + 1;
}

void Profiler::clear() {
  frames_ = 0;
  order_.clear();
  history_.clear();
  ran_.clear();
  warm_.clear();
  seen_.clear();
  wall_.clear();
  unaccounted_.clear();
}

Profiler::InWindow Profiler::inWindow(const std::string& pass) const {
  const auto ran = ran_.find(pass);
  if (ran == ran_.end()) return {};
  const uint64_t begin = std::max(warm_.at(pass), frames_ >= window_ ? frames_ - window_ + 1 : 1);
  if (frames_ < begin) return {};
  InWindow w;
  w.frames = frames_ - begin + 1;
  const std::deque<double>& ms = history_.at(pass);
  for (size_t i = ran->second.size(); i-- > 0 && ran->second[i] >= begin;) ++w.ran, w.ms += ms[i];
  return w;
}

std::vector<PassStatistics> Profiler::passes() const {
  std::vector<PassStatistics> all;
  for (const PassTiming& timing : order_) {
    const auto samples = history_.find(timing.name);
    PassStatistics s = statistics(timing.name, timing.host ? "host" : "gpu",
                                  samples == history_.end() ? std::deque<double>() : samples->second);
    s.skipped = timing.skipped;
    const InWindow w = inWindow(timing.name);
    s.share = w.frames > 0 ? static_cast<double>(w.ran) / static_cast<double>(w.frames) : 0;
    s.frameMs = w.frames > 0 ? w.ms / static_cast<double>(w.frames) : 0;
    all.push_back(std::move(s));
  }
  return all;
}

double Profiler::unaccounted() const { return statistics("", "", unaccounted_).medianMs; }

PassStatistics Profiler::frame() const { return statistics("frame", "gpu", wall_); }

}  // namespace hl
