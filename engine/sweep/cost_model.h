#pragma once
// What a technique's settings will cost, judged from those that were timed: the logarithm of the time as a linear function of the knobs, each on its own
// scale. (Times are mostly products: texels x rays x bounces.) Only for choosing what to try next; what counts is measured.
#include <map>
#include <string>
#include <vector>

#include "engine/experiment/preset.h"
#include "engine/params/param.h"

namespace hl {

class CostModel {
 public:
  CostModel(std::string technique, std::vector<const ParamInfo*> knobs) : technique_(std::move(technique)), knobs_(std::move(knobs)) {}
  void add(const Preset&, double ms);
  /// Ridge regression over what was added; 0 before anything was.
  double predict(const Preset&) const;

 private:
  std::vector<double> features(const Preset&) const;
  void fit() const;

  std::string technique_;
  std::vector<const ParamInfo*> knobs_;
  std::vector<std::vector<double>> x_;
  std::vector<double> y_;
  mutable std::vector<double> weights_;
};

/// Where a value lies in its knob's soft range, 0 to 1, on its scale.
double unitOf(const ParamInfo&, double value);
double fromUnit(const ParamInfo&, double unit);
/// As a number: a bool's 0 or 1, an enum's place.
double numberOf(const Preset&, const ParamInfo&);

}  // namespace hl
