// Presets to JSON, their identity, and where they are kept.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/experiment/parameter_json.h"
#include "engine/experiment/preset.h"
#include "engine/experiment/preset_names.h"
#include "engine/experiment/preset_parameters.h"

namespace hl {

std::string shortestText(float v) {
  char text[48];
  return std::string(text, std::to_chars(text, text + sizeof text, v).ptr);
}

float radiansOf(double degrees) { return static_cast<float>(degrees * (3.14159265358979323846 / 180)); }

double degreesOf(float radians) {
  const double exact = radians * (180 / 3.14159265358979323846);
  for (int digits = 4; digits < 17; ++digits) {
    const double shorter = std::stod(fmt::format("{:.{}g}", exact, digits));
    if (radiansOf(shorter) == radians) return shorter;
  }
  return exact;
}

namespace {

using Json = nlohmann::ordered_json;

/// 0.1f as 0.1, not 0.10000000149011612: the same float is read back.
Json number(float v, const char* what) {
  if (!std::isfinite(v)) throw badInput(fmt::format("{} is {}: a preset cannot hold it", what, v));
  return Json::parse(shortestText(v));
}

Json vector(vec3 v, const char* what) { return Json::array({number(v.x, what), number(v.y, what), number(v.z, what)}); }

Json degrees(float radians, const char* what) {
  number(radians, what);  // refuses what is not finite
  return degreesOf(radians);
}

Json cameraJson(const Camera& camera) {
  Json out = Json::object();
  if (!camera.name.empty()) out["name"] = camera.name;
  out["position"] = vector(camera.position, "camera.position");
  out["target"] = vector(camera.target, "camera.target");
  out["up"] = vector(camera.up, "camera.up");
  out["vertical_fov_degrees"] = degrees(camera.verticalFov, "camera.vertical_fov_degrees");
  return out;
}

/// As scene files have them.
Json lightsJson(const LightEdits& lights) {
  Json out = Json::array();
  for (const PointLight& l : lights.points)
    out.push_back({{"type", "point"},
                   {"name", l.name},
                   {"position", vector(l.position, "lights: position")},
                   {"intensity", vector(l.intensity, "lights: intensity")}});
  for (const SpotLight& l : lights.spots)
    out.push_back({{"type", "spot"},
                   {"name", l.name},
                   {"position", vector(l.position, "lights: position")},
                   {"direction", vector(l.direction, "lights: direction")},
                   {"intensity", vector(l.intensity, "lights: intensity")},
                   {"inner_degrees", degrees(l.innerAngle, "lights: inner_degrees")},
                   {"outer_degrees", degrees(l.outerAngle, "lights: outer_degrees")}});
  for (const DirectionalLight& l : lights.directionals)
    out.push_back({{"type", "directional"},
                   {"name", l.name},
                   {"direction", vector(l.direction, "lights: direction")},
                   {"irradiance", vector(l.irradiance, "lights: irradiance")}});
  return out;
}

Json regionsJson(const std::vector<Region>& regions) {
  Json out = Json::array();
  for (const Region& r : regions)
    out.push_back({{"name", r.name},
                   {"x", number(r.x, "regions: x")},
                   {"y", number(r.y, "regions: y")},
                   {"width", number(r.width, "regions: width")},
                   {"height", number(r.height, "regions: height")}});
  return out;
}

Json animationJson(const Playback& p) {
  Json out = {{"play", p.play}, {"start", number(p.start, "animation.start")}, {"rate", number(p.rate, "animation.rate")}};
  if (!p.cameraPath.empty()) out["camera_path"] = p.cameraPath;
  return out;
}

Json parametersJson(const Preset& preset, bool resolved) {
  const auto groups = parameterGroups(preset.technique);
  const auto changed = canonicalParameters(preset.technique, preset.parameters);
  Json out = Json::object();
  for (const auto& [key, text] : changed)
    if (!findParameter(groups, key))
      throw badInput(fmt::format("unknown parameter \"{}\" of technique {}", key, preset.technique));
  for (const auto& group : groups)
    for (const ParamInfo& info : group) {
      const auto found = changed.find(info.key());
      if (found != changed.end())
        out[info.key()] = parameterJson(info, found->second);
      else if (resolved)
        out[info.key()] = parameterJson(info, formatParam(info, defaultValue(info)));
    }
  return out;
}

Json presetDocument(const Preset& preset, bool resolved) {
  Json out = {{"version", kPresetVersion}, {"scene", preset.scene}};
  if (preset.camera)
    out["camera"] = cameraJson(*preset.camera);
  else if (!preset.cameraName.empty())
    out["camera"] = preset.cameraName;
  if (preset.lights) {
    out["lights"] = lightsJson(*preset.lights);
    out["sky"] = vector(preset.lights->sky, "sky");
  }
  if (preset.probes) {
    out["probes"] = Json::array();
    for (const vec3 p : *preset.probes) out["probes"].push_back(vector(p, "probes"));
  }
  if (resolved || preset.animation != Playback{}) out["animation"] = animationJson(preset.animation);
  out["resolution"] = {preset.width, preset.height};
  out["seed"] = preset.seed;
  out["technique"] = preset.technique;
  out["parameters"] = parametersJson(preset, resolved);
  return out;
}

Json displayJson(const Display& display) {
  return {{"exposure", number(display.exposure, "display.exposure")},
          {"tone_map", kToneMapNames[static_cast<int>(display.toneMap)]},
          {"view", display.view},
          {"show_invalid", display.showInvalid},
          {"error_metric", display.errorMetric}};
}

/// ASCII alone, since the text also travels in image files.
std::string compact(const Json& value) {
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace), out;
  bool quoted = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\\' && quoted) {
      out += c;
      out += text[++i];
      continue;
    }
    if (c == '"') quoted = !quoted;
    out += c;
    if (!quoted && (c == ',' || c == ':')) out += ' ';
  }
  return out;
}

/// One line a key, a parameter or a light: what a person edits and a version control system compares.
std::string readable(const Json& document) {
  std::string out = "{\n";
  size_t left = document.size();
  for (const auto& [key, value] : document.items()) {
    const bool spread = (key == "parameters" || key == "lights" || key == "regions" || key == "probes") && !value.empty();
    out += fmt::format("  {}: ", compact(key));
    if (spread) {
      size_t inner = value.size();
      out += value.is_array() ? "[\n" : "{\n";
      for (const auto& [name, member] : value.items())
        out += fmt::format("    {}{}{}\n", value.is_array() ? "" : fmt::format("{}: ", compact(name)), compact(member),
                           --inner ? "," : "");
      out += value.is_array() ? "  ]" : "  }";
    } else {
      out += compact(value);
    }
    out += --left ? ",\n" : "\n";
  }
  return out + "}\n";
}

}  // namespace

std::string presetJson(const Preset& preset, bool resolved) {
  Json document = presetDocument(preset, resolved);
  if (preset.regions) document["regions"] = regionsJson(*preset.regions);
  document["display"] = displayJson(preset.display);
  return readable(document);
}

void savePreset(const Preset& preset, const std::filesystem::path& file) {
  writeFileAtomically(file, presetJson(preset));
}

std::string presetHash(const Preset& preset) { return hashOf(compact(presetDocument(preset, false))); }

std::vector<PresetListing> listPresets() {
  namespace fs = std::filesystem;
  std::vector<PresetListing> out;
  const fs::path folder = homeFolder() / "presets";
  if (!fs::is_directory(folder)) return out;
  for (auto at = fs::recursive_directory_iterator(folder); at != fs::recursive_directory_iterator(); ++at) {
    const fs::directory_entry& entry = *at;
    if (entry.is_directory() && entry.path().filename() == "experiments") at.disable_recursion_pending();  // listExperiments()
    if (entry.path().extension() != ".json") continue;
    PresetListing listing;
    listing.id = fs::relative(entry.path(), folder).replace_extension().generic_string();
    listing.file = entry.path();
    try {
      const Preset preset = loadPreset(entry.path());
      listing.label = fmt::format("{} on {}", preset.technique, preset.scene);
    } catch (const Error& e) {
      listing.label = fmt::format("cannot be read: {}", e.what());
    }
    out.push_back(listing);
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return out;
}

}  // namespace hl
