// The path tracer's runs as files.
#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/sweep/sweep.h"

namespace hl {

std::string tracerRunJson(const TracerRun& r) {
  JsonWriter w;
  w.beginObject().member("key", r.key).member("problem", r.problem).member("transport", r.transport).member("seed", r.seed);
  w.member("where", "host").member("threads", r.threads).key("points").beginArray();
  for (const TracerPoint& point : r.points) {
    w.beginObject().member("paths", point.paths).member("ms", point.ms).key("errors").beginArray();
    for (const ErrorValue& e : point.errors) writeError(w, e);
    w.endArray().endObject();
  }
  return w.endArray().endObject().str() + "\n";
}

TracerRun readTracerRun(const std::string& text, const std::string& whereFrom) {
  try {
    const nlohmann::json d = nlohmann::json::parse(text);
    TracerRun r;
    r.key = d.at("key"), r.problem = d.at("problem"), r.transport = d.at("transport"), r.seed = d.at("seed"), r.threads = d.at("threads");
    for (const auto& point : d.at("points")) {
      TracerPoint out{point.at("paths"), point.at("ms"), {}};
      out.errors = readErrors(point.at("errors").dump());
      r.points.push_back(std::move(out));
    }
    return r;
  } catch (const nlohmann::json::exception& e) {
    throw badInput(fmt::format("{}: no record of the path tracer: {}", whereFrom, e.what()));
  }
}

}  // namespace hl
