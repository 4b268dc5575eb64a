#pragma once
// Speed against error: which points are worth having, and what a curve through them says in between.
#include <optional>
#include <span>
#include <vector>

namespace hl {

/// One competitor: what it costs (time, memory) and how wrong it is (less is better), with the half-widths of their intervals.
struct CostPoint {
  double cost = 0, error = 0, halfWidth = 0, costHalfWidth = 0;
};

enum class FrontPlace {
  On,      ///< no other point is as good in both and better in one
  Within,  ///< some is, but within the error bars it may as well be worse, or dearer
  Off,
};
/// Points that are not finite are Off.
std::vector<FrontPlace> paretoFront(std::span<const CostPoint>);

/// What can be had at a cost or less: points by growing cost, each with less error than the one before. Points without a positive error or cost have no
/// place on a logarithmic plot; their error is taken as the top of their interval where that is positive, else they are left out.
std::vector<CostPoint> lowerEnvelope(std::span<const CostPoint>);

/// Along an envelope, straight in both logarithms. None below its first cost; beyond its last, the last error.
std::optional<double> errorAtCost(std::span<const CostPoint> envelope, double cost);
/// The cost at which the envelope comes down to `error`: its first cost where that is below already, none where it never does.
std::optional<double> costOfError(std::span<const CostPoint> envelope, double error);

}  // namespace hl
