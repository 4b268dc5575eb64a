#pragma once
// What a rebuild takes, known before it is begun: counts, from parameters and from how many receivers and probes there are. Time is the session's to tell
// (engine/session/work_rates.h), which knows how fast this device did such work before.
#include <cstdint>
#include <string>
#include <vector>

namespace hl {

/// One kind of work: how much of it there is, counted by the technique beforehand and again as it is done.
struct WorkPart {
  enum class Kind { Rays, Sums };
  std::string name;                 ///< "rays", "decompositions"
  Kind kind = Kind::Rays;           ///< what `amount` counts: rays, or multiplications with an addition
  double amount = 0;
  std::vector<std::string> passes;  ///< that do it, in units of work; by what their names begin with
};

struct RebuildEstimate {
  std::vector<WorkPart> parts;      ///< empty: the technique precomputes nothing
  double rays = 0;                  ///< cast, in all
  double bytes = 0;                 ///< of what is precomputed, as it is kept on the device
  double bytesBefore = 0;           ///< ... before compression; 0 where nothing is compressed
  double bytesOfFrames = 0;         ///< held by frames for it besides, and known beforehand: radiance at glossy receivers
  double bytesMore = 0;             ///< kept besides at most, by what is found on the way
  std::string name = "precomputation";  ///< what is precomputed, as a person would call it: "transport"
  bool atMost = false;              ///< work may end earlier: an iteration that converges
};

}  // namespace hl
