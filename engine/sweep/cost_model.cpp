#include "engine/sweep/cost_model.h"

#include <algorithm>
#include <cmath>

namespace hl {
namespace {

// Keeps slopes small that few samples say little about, in squared logarithms of time for a knob's whole range.
constexpr double kRidge = 0.1;
constexpr double kLeastMs = 1e-3;

bool isLog(const ParamInfo& p) { return p.scale == ParamScale::Log; }

/// Solves a x = b for a symmetric positive definite a (Gaussian elimination with pivots).
std::vector<double> solved(std::vector<std::vector<double>> a, std::vector<double> b) {
  const size_t n = b.size();
  for (size_t k = 0; k < n; ++k) {
    size_t pivot = k;
    for (size_t i = k + 1; i < n; ++i)
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    std::swap(a[k], a[pivot]), std::swap(b[k], b[pivot]);
    for (size_t i = k + 1; i < n; ++i) {
      const double f = a[i][k] / a[k][k];
      for (size_t j = k; j < n; ++j) a[i][j] -= f * a[k][j];
      b[i] -= f * b[k];
    }
  }
  for (size_t k = n; k-- > 0;) {
    for (size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return b;
}

}  // namespace

double unitOf(const ParamInfo& p, double v) {
  if (isLog(p)) return (std::log(std::max(v, p.softMin)) - std::log(p.softMin)) / (std::log(p.softMax) - std::log(p.softMin));
  return (v - p.softMin) / (p.softMax - p.softMin);
}

double fromUnit(const ParamInfo& p, double t) {
  t = std::clamp(t, 0.0, 1.0);
  return isLog(p) ? p.softMin * std::pow(p.softMax / p.softMin, t) : p.softMin + t * (p.softMax - p.softMin);
}

double numberOf(const Preset& preset, const ParamInfo& p) {
  const auto set = preset.parameters.find(p.key());
  const ParamValue v = set == preset.parameters.end() ? defaultValue(p) : parseParam(p, set->second);
  return std::holds_alternative<float>(v) ? static_cast<double>(std::get<float>(v)) : static_cast<double>(std::get<int32_t>(v));
}

std::vector<double> CostModel::features(const Preset& preset) const {
  std::vector<double> out = {1};
  for (const ParamInfo* p : knobs_) {
    const double v = numberOf(preset, *p);
    if (p->type == ParamType::Enum)
      for (size_t i = 1; i < p->values.size(); ++i) out.push_back(v == static_cast<double>(i) ? 1 : 0);
    else
      out.push_back(p->type == ParamType::Bool ? v : unitOf(*p, v));
  }
  return out;
}

void CostModel::add(const Preset& preset, double ms) {
  if (preset.technique != technique_) return;
  x_.push_back(features(preset));
  y_.push_back(std::log(std::max(ms, kLeastMs)));
  weights_.clear();
}

void CostModel::fit() const {
  const size_t n = x_.front().size();
  std::vector<std::vector<double>> a(n, std::vector<double>(n, 0));
  std::vector<double> b(n, 0);
  for (size_t s = 0; s < x_.size(); ++s)
    for (size_t i = 0; i < n; ++i) {
      b[i] += x_[s][i] * y_[s];
      for (size_t j = 0; j < n; ++j) a[i][j] += x_[s][i] * x_[s][j];
    }
  for (size_t i = 1; i < n; ++i) a[i][i] += kRidge;
  weights_ = solved(std::move(a), std::move(b));
}

double CostModel::predict(const Preset& preset) const {
  if (x_.empty()) return 0;
  if (weights_.empty()) fit();
  const std::vector<double> x = features(preset);
  double sum = 0;
  for (size_t i = 0; i < x.size(); ++i) sum += weights_[i] * x[i];
  return std::exp(sum);
}

}  // namespace hl
