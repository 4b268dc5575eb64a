#include "engine/experiment/preset_schema.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/experiment/preset.h"
#include "engine/experiment/preset_names.h"
#include "engine/params/groups.h"
#include "engine/metrics/metrics.h"
#include "engine/scene/animation.h"
#include "engine/techniques/technique.h"

namespace hl {
namespace {

using Json = nlohmann::ordered_json;

Json vectorSchema(const char* description) {
  return {{"type", "array"},
          {"items", {{"type", "number"}}},
          {"minItems", 3},
          {"maxItems", 3},
          {"description", description}};
}

Json objectSchema(Json properties, Json required = Json::array()) {
  Json out = {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
  if (!required.empty()) out["required"] = std::move(required);
  return out;
}

/// A float parameter's limit as it was declared: 0.001, not the nearest float's digits.
Json limit(const ParamInfo& p, double v) {
  if (p.type == ParamType::Int) return static_cast<int64_t>(v);
  return Json::parse(shortestText(static_cast<float>(v)));
}

Json parameterSchema(const ParamInfo& p) {
  Json out = Json::object();
  const ParamValue def = defaultValue(p);
  switch (p.type) {
    case ParamType::Bool:
      out = {{"type", "boolean"}, {"default", std::get<int32_t>(def) != 0}};
      break;
    case ParamType::Int:
      out = {{"type", "integer"}, {"default", std::get<int32_t>(def)}};
      break;
    case ParamType::Float:
      out = {{"type", "number"}, {"default", limit(p, p.def)}};
      break;
    case ParamType::Enum: {
      Json names = Json::array();
      for (const EnumValue& v : p.values) names.push_back(v.name);
      out = {{"enum", names}, {"default", formatParam(p, def)}};
      break;
    }
  }
  if (p.type == ParamType::Int || p.type == ParamType::Float)
    out["minimum"] = limit(p, p.min), out["maximum"] = limit(p, p.max);
  std::string text(p.help);
  if (!p.unit.empty()) text += fmt::format(" [{}]", p.unit);
  for (const EnumValue& v : p.values) text += fmt::format("\n{}: {}", v.name, v.help);
  out["description"] = text;
  return out;
}

Json regionsSchema() {
  const Json share = {{"type", "number"}, {"minimum", 0}, {"maximum", 1}};
  return {{"type", "array"},
          {"description", "Regions of interest, in place of the scene's: rectangles in shares of the picture, from its top left corner."},
          {"items", objectSchema({{"name", {{"type", "string"}}}, {"x", share}, {"y", share}, {"width", share}, {"height", share}}, {"name"})}};
}

Json lightsSchema() {
  const Json name = {{"type", "string"}};
  const Json position = vectorSchema("World position [m].");
  const Json intensity = vectorSchema("RGB [W/sr].");
  const Json angle = {{"type", "number"}, {"minimum", 0}, {"maximum", 90}, {"description", "Half-angle of the cone."}};
  const auto type = [](const char* id) { return Json{{"const", id}}; };
  Json point = objectSchema({{"type", type("point")}, {"name", name}, {"position", position}, {"intensity", intensity}},
                            {"type", "position", "intensity"});
  Json spot = objectSchema({{"type", type("spot")},
                            {"name", name},
                            {"position", position},
                            {"direction", vectorSchema("Away from the light.")},
                            {"intensity", intensity},
                            {"inner_degrees", angle},
                            {"outer_degrees", angle}},
                           {"type", "position", "direction", "intensity"});
  Json directional = objectSchema({{"type", type("directional")},
                                   {"name", name},
                                   {"direction", vectorSchema("The way the light travels.")},
                                   {"irradiance", vectorSchema("RGB [W/m^2] on a surface that faces it.")}},
                                  {"type", "direction", "irradiance"});
  return {{"type", "array"},
          {"items", {{"anyOf", {std::move(point), std::move(spot), std::move(directional)}}}},
          {"description", "The whole set of lights, in place of the scene's."}};
}

Json cameraSchema() {
  const Json fov = {{"type", "number"}, {"minimum", 0.01}, {"maximum", 179.99}};
  const Json named = {{"type", "string"}, {"description", "A camera of the scene; left out or empty: its first."}};
  Json free = objectSchema({{"name", {{"type", "string"}}},
                            {"position", vectorSchema("[m]")},
                            {"target", vectorSchema("[m]")},
                            {"up", vectorSchema("Roughly upwards.")},
                            {"vertical_fov_degrees", fov}},
                           {"position", "target"});
  return {{"anyOf", {named, std::move(free)}}};
}

Json integerSchema(int64_t low, int64_t high, int64_t def) {
  return {{"type", "integer"}, {"minimum", low}, {"maximum", high}, {"default", def}};
}

}  // namespace

std::string presetSchema() {
  const Preset defaults;
  Json parameters = Json::object(), techniques = Json::array(), metrics = Json::array();
  for (const MetricInfo& metric : metricInfos()) metrics.push_back(metric.id);
  const auto add = [&](std::span<const ParamInfo> infos) {
    for (const ParamInfo& p : infos) parameters[p.key()] = parameterSchema(p);
  };
  for (const TechniqueInfo& technique : techniqueInfos()) {
    techniques.push_back(technique.id);
    add(technique.create()->params().infos());
  }
  for (const auto& shared : sharedParamGroups()) add(shared);

  const Json side = {{"type", "integer"}, {"minimum", 1}, {"maximum", kMaxPresetSide}};
  Json properties = {
      {"version", {{"const", kPresetVersion}}},
      {"scene",
       {{"type", "string"}, {"minLength", 1}, {"description", "A scene's name, or the path of a scene or mesh file."}}},
      {"camera", cameraSchema()},
      {"lights", lightsSchema()},
      {"animation",
       objectSchema({{"play", {{"type", "boolean"}, {"default", false}, {"description", "Frame n is at start + n / rate seconds; else all are at start."}}},
                     {"start", {{"type", "number"}, {"minimum", 0}, {"maximum", kLongestAnimation}, {"default", 0}, {"description", "[s]"}}},
                     {"rate", {{"type", "number"}, {"minimum", kLowestRate}, {"maximum", kHighestRate}, {"default", defaults.animation.rate}, {"description", "Frames a second of the scene's time."}}},
                     {"camera_path", {{"type", "string"}, {"description", "One of the scene's recorded flights, in place of the camera."}}}})},
      {"regions", regionsSchema()},
      {"probes", {{"type", "array"}, {"items", vectorSchema("[x, y, z] in metres.")}, {"description", "In place of the scene's own, for probes.placement manual."}}},
      {"sky", vectorSchema("Radiance [W/(sr m^2)] from where nothing is hit; comes with lights.")},
      {"resolution",
       {{"type", "array"},
        {"items", side},
        {"minItems", 2},
        {"maxItems", 2},
        {"description", "[width, height] in pixels."}}},
      {"seed", integerSchema(0, 0xffffffffLL, defaults.seed)},
      {"technique", {{"enum", techniques}, {"default", defaults.technique}}},
      {"parameters", objectSchema(parameters)},
      {"display", objectSchema({{"exposure",
                                 {{"type", "number"},
                                  {"minimum", -kMaxExposure},
                                  {"maximum", kMaxExposure},
                                  {"default", 0},
                                  {"description", "Stops."}}},
                                {"tone_map", {{"enum", kToneMapNames}, {"default", kToneMapNames[0]}}},
                                {"view", {{"type", "string"}, {"default", defaults.display.view}}},
                                {"show_invalid", {{"type", "boolean"}, {"default", false}}},
                                {"error_metric", {{"enum", metrics}, {"default", defaults.display.errorMetric}, {"description", "Whose map the error views show."}}}})}};
  Json schema = objectSchema(std::move(properties), {"version", "scene"});
  Json out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Halflight preset"}};
  out.update(schema);
  return out.dump(2) + "\n";
}

}  // namespace hl
