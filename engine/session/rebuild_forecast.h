#pragma once
// What a rebuild would take, said before it is begun: the technique's counts, and the time that this device has taken for such work before.
#include <string>
#include <utility>
#include <vector>

#include "engine/techniques/rebuild_estimate.h"

namespace hl {

/// Where a forecast's speeds are from, the worst of its parts.
enum class ForecastBasis {
  Measured,    ///< the last work of this kind in this scene, with this tracer on this device
  OtherScene,  ///< in another scene
  Calibrated,  ///< never yet: some rays cast for it, and a rule of thumb for the rest
};

struct RebuildForecast {
  bool rebuilds = false;          ///< false: nothing begins anew that takes long
  std::vector<std::string> anew;  ///< what is made again, in order: "lightmap", "placement", and what the technique calls its own ("transport")
  std::string refused;            ///< why rebuilding would be refused, in its words; "" where it would not
  std::vector<std::string> warnings;  ///< what rebuilding would warn of, in its words: probes by hand inside geometry
  RebuildEstimate work;
  bool cancelled = false;         ///< before it could be said
  double seconds = -1;            ///< until it is done; -1: the technique says nothing beforehand
  ForecastBasis basis = ForecastBasis::Measured;
  std::vector<std::pair<std::string, double>> parts;  ///< seconds of each kind of work, and of "preparation" before it
};

/// "lightmap, placement, transport: about 12 s; 120 M rays, 27 MB, 234 MB before compression": what command line and window say. `refused` alone where it would be; `warnings` at the end.
std::string forecastText(const RebuildForecast&);

}  // namespace hl
