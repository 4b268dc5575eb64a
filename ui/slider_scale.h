#pragma once
// Where a parameter's value lies on its slider: the soft range, linear or logarithmic, in whole steps.
#include "engine/params/param.h"

namespace hl::ui {

class SliderScale {
 public:
  explicit SliderScale(const ParamInfo&);
  int steps() const { return steps_; }       ///< slider positions are 0 to steps()
  int position(double value) const;          ///< values outside the soft range sit at its ends
  double value(int position) const;          ///< rounded to three significant digits, or to a whole number for integers
  /// One notch up or down from any value, as a field's arrows take it; inside the hard range.
  double stepped(double value, int notches) const;

 private:
  double low_, high_, min_, max_;
  bool log_, whole_;
  int steps_;
};

}  // namespace hl::ui
