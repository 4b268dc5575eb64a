// Experiments to JSON, and their JSON Schema.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/json_writer.h"
#include "engine/experiment/experiment.h"
#include "engine/experiment/parameter_json.h"
#include "engine/experiment/preset_names.h"
#include "engine/experiment/preset_parameters.h"
#include "engine/experiment/preset_schema.h"
#include "engine/metrics/metrics.h"
#include "engine/scene/animation.h"

namespace hl {
namespace {

using Json = nlohmann::ordered_json;

const ParamInfo& declaration(const Permutation& axes, const Preset& base, const std::string& key) {
  std::vector<std::string> techniques = {base.technique};
  for (const PermuteAxis& axis : axes)
    if (axis.key == "technique") techniques = axis.values;
  for (const std::string& technique : techniques)
    if (const ParamInfo* p = findParameter(parameterGroups(technique), key)) return *p;
  throw badInput(fmt::format("unknown parameter \"{}\" of technique {}", key, fmt::join(techniques, ", ")));
}

Json axisJson(const PermuteAxis& axis, const Permutation& axes, const Preset& base) {
  Json out = Json::array();
  for (const std::string& value : axis.values) {
    if (axis.key == "technique" || axis.key == "camera")
      out.push_back(value);
    else if (axis.key == "resolution")
      out.push_back(Json::array({std::stoi(value), std::stoi(value.substr(value.find('x') + 1))}));
    else if (axis.key == kStartAxis)
      out.push_back(Json::parse(value));
    else
      out.push_back(parameterJson(declaration(axes, base, axis.key), value));
  }
  return out;
}

Json whole(int64_t low, int64_t high, int64_t def, const char* description) {
  return {{"type", "integer"}, {"minimum", low}, {"maximum", high}, {"default", def}, {"description", description}};
}

Json listOf(Json items, const char* description) {
  return {{"type", "array"}, {"items", std::move(items)}, {"minItems", 1}, {"description", description}};
}

Json closed(Json properties, Json required) {
  return {{"type", "object"}, {"properties", std::move(properties)}, {"required", std::move(required)}, {"additionalProperties", false}};
}

}  // namespace

std::string experimentJson(const Experiment& e) {
  Json permute = Json::array();
  for (const Permutation& axes : e.permute) {
    Json object = Json::object();
    for (const PermuteAxis& axis : axes) object[axis.key] = axisJson(axis, axes, e.base);
    permute.push_back(std::move(object));
  }
  const auto compact = [](const Json& v) { return v.dump(-1, ' ', true, Json::error_handler_t::replace); };
  JsonWriter w;
  w.beginObject().member("version", kExperimentVersion).key("base").raw(presetJson(e.base));
  if (!permute.empty()) {
    w.key("permute").beginArray();
    for (const Json& object : permute) {
      w.beginObject();
      for (const auto& [key, values] : object.items()) w.key(key).raw(compact(values));
      w.endObject();
    }
    w.endArray();
  }
  w.key("seeds").raw(compact(Json(e.seeds))).key("metrics").raw(compact(Json(e.metrics))).key("references").raw(compact(Json(e.references)));
  w.key("targets").raw(compact(Json(e.targets))).key("target_error").raw(shortestText(static_cast<float>(e.targetError)));
  w.key("compare_with").beginObject();
  if (!e.compareWith.empty()) {
    Permutation named;
    for (const auto& [key, value] : e.compareWith) named.push_back({key, {value}});
    for (const PermuteAxis& axis : named) w.key(axis.key).raw(compact(axisJson(axis, named, e.base).front()));
  }
  w.endObject().key("stop").beginObject();
  if (e.stop.kind == StopRule::Kind::Settled) w.member("settled", true);
  if (e.stop.kind == StopRule::Kind::Frames) w.member("frames", static_cast<int64_t>(e.stop.amount));
  if (e.stop.kind == StopRule::Kind::Milliseconds) w.key("ms").raw(shortestText(static_cast<float>(e.stop.amount)));
  w.endObject().key("limit_ms").raw(shortestText(static_cast<float>(e.limitMs))).member("repeats", e.repeats).member("amortise_frames", e.amortiseFrames);
  w.member("path_tracer", e.pathTracer).member("images", e.images);
  return w.endObject().str() + "\n";
}

std::string experimentSchema(const std::string& presets) {
  const Experiment defaults;
  const Json number = {{"type", "number"}}, seed = {{"type", "integer"}, {"minimum", 0}, {"maximum", 0xffffffffLL}};
  const Json value = {{"type", {"number", "string", "boolean"}}};
  const Json side = {{"type", "integer"}, {"minimum", 1}, {"maximum", kMaxPresetSide}};
  const Json pair = {{"type", "array"}, {"items", side}, {"minItems", 2}, {"maxItems", 2}};
  const Json name = {{"type", "string"}};
  const Json second = {{"type", "number"}, {"minimum", 0}, {"maximum", kLongestAnimation}};
  Json range = closed({{"from", number}, {"to", number}, {"count", {{"type", "integer"}, {"minimum", 2}, {"maximum", kMaxAxisValues}}}, {"log", {{"type", "boolean"}, {"default", false}}}},
                      {"from", "to", "count"});
  range["description"] = "Steps between two numbers, ends included; whole parameters are rounded, and what is then equal counts once.";
  const Json names = {{"anyOf", {name, listOf(name, "Their names.")}}};
  Json product = {{"type", "object"},
                  {"properties", {{"technique", names}, {"camera", names}, {"resolution", {{"anyOf", {pair, listOf(pair, "[width, height] each.")}}}}, {kStartAxis, {{"anyOf", {second, listOf(second, "Where the scene's time starts [s].")}}}}}},
                  {"additionalProperties", {{"anyOf", {value, listOf(value, "The values that the parameter takes."), range}}}},
                  {"description", "All combinations of the values. Keys are dotted parameter keys, and technique, camera, resolution, animation.start. A parameter of one technique leaves the configurations of the others single."}};
  Json metrics = Json::array();
  for (const MetricInfo& m : metricInfos()) metrics.push_back(std::string(m.id));
  Json properties = {
      {"version", {{"const", kExperimentVersion}}},
      {"base", {{"anyOf", {{{"type", "string"}, {"minLength", 1}, {"description", "A preset's name; or its path, beside the experiment or in the program's folder, which ends in .json (or, of a bundle, .hlb)."}}, {{"$ref", presets}}}}}},
      {"permute", {{"anyOf", {product, listOf(product, "Their combinations are added up.")}}}},
      {"seeds", {{"anyOf", {seed, listOf(seed, "Each once."), closed({{"from", seed}, {"count", whole(1, kMaxAxisValues, 1, "How many.")}}, {"from", "count"})}}}},
      {"metrics", listOf({{"enum", metrics}}, "The first is that of the fronts. relmse and mse are measured in any case.")},
      {"references", listOf({{"enum", {"matched", "full"}}}, "What errors are against.")},
      {"targets", listOf({{"enum", {"image", "lightmap"}}}, "What errors are of; the lightmap's, of techniques that have one, are area-weighted over its valid texels and against the matched reference.")},
      {"compare_with", {{"type", "object"}, {"additionalProperties", value}, {"description", "Names one of the experiment's own runs, by values of what is varied: every run's indirect irradiance is compared with that of the run which differs from it in these alone (reference \"run\")."}}},
      {"target_error", {{"type", "number"}, {"minimum", 0}, {"default", 0}, {"description", "Of the first metric: the report names the cheapest configurations that stay within it; 0: none."}}},
      {"stop",
       {{"anyOf",
         {closed({{"settled", {{"const", true}}}}, {"settled"}), closed({{"frames", whole(1, 1'000'000, 1, "After the bake.")}}, {"frames"}),
          closed({{"ms", {{"type", "number"}, {"exclusiveMinimum", 0}, {"description", "Of preparation, work and frames."}}}}, {"ms"})}}}},
      {"limit_ms", {{"type", "number"}, {"minimum", 0}, {"default", 0}, {"description", "A run that takes longer is ended and counts as failed; 0: none."}}},
      {"repeats", whole(1, 1000, defaults.repeats, "Of every configuration and seed, for times.")},
      {"amortise_frames", whole(1, 1'000'000, defaults.amortiseFrames, "Over which the bake is spread in one of the fronts.")},
      {"path_tracer", {{"type", "boolean"}, {"default", defaults.pathTracer}, {"description", "The path tracer at equal time is among the competitors."}}},
      {"images", {{"type", "boolean"}, {"default", defaults.images}, {"description", "An EXR of each configuration."}}}};
  Json out = {{"title", "Halflight experiment"}};
  out.update(closed(std::move(properties), {"version", "base"}));
  return out.dump(2) + "\n";
}

std::string fileSchema() {
  Json preset = Json::parse(presetSchema());
  preset.erase("$schema");
  Json out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"title", "Halflight preset or experiment"},
              {"if", {{"required", {"base"}}}},
              {"then", {{"$ref", "#/$defs/experiment"}}},
              {"else", {{"$ref", "#/$defs/preset"}}},
              {"$defs", {{"preset", std::move(preset)}, {"experiment", Json::parse(experimentSchema("#/$defs/preset"))}}}};
  return out.dump(2) + "\n";
}

}  // namespace hl
