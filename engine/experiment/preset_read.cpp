// Presets from JSON: strict where the version is ours, tolerant with a warning where it is newer.
#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/experiment/json_reader.h"
#include "engine/experiment/parameter_json.h"
#include "engine/experiment/preset.h"
#include "engine/experiment/preset_migration.h"
#include "engine/experiment/preset_names.h"
#include "engine/experiment/preset_parameters.h"
#include "engine/metrics/metrics.h"
#include "engine/scene/animation.h"
#include "engine/techniques/technique.h"

namespace hl {
namespace {

/// Reads one document; knows whether unknown things are errors or warnings.
class PresetReader {
 public:
  PresetReader(Preset& preset, bool newer) : preset_(preset), newer_(newer) {}

  void read(const JsonReader& root) {
    known(root,
          {"version", "scene", "camera", "lights", "sky", "resolution", "seed", "technique", "parameters", "animation", "regions", "probes", "display"});
    preset_.scene = root.at("scene").text();
    if (preset_.scene.empty()) throw root.at("scene").refused("the name or path of a scene is wanted");
    if (root.has("camera")) readCamera(root.at("camera"));
    if (root.has("lights")) readLights(root);
    if (root.has("sky") && !root.has("lights"))
      throw root.at("sky").refused("it comes with \"lights\", which replace those of the scene ([] for none)");
    if (root.has("resolution")) readResolution(root.at("resolution"));
    if (root.has("seed")) preset_.seed = static_cast<uint32_t>(root.at("seed").whole(0, 0xffffffffLL));
    if (root.has("technique")) readTechnique(root.at("technique"));
    if (root.has("parameters")) readParameters(root.at("parameters"));
    if (root.has("animation")) readAnimation(root.at("animation"));
    if (root.has("regions")) readRegions(root.at("regions"));
    if (root.has("probes")) readProbes(root.at("probes"));
    if (root.has("display")) readDisplay(root.at("display"));
  }

 private:
  /// An unknown key is a spelling mistake in a preset of our version, and a thing we cannot know in a newer one.
  void known(const JsonReader& object, const std::vector<std::string>& keys) {
    for (const std::string& key : object.unknownKeys(keys)) {
      const std::string near = nearest(key, keys);
      const Error error = object.refused(fmt::format("unknown key \"{}\"; {}", key,
                                                     near.empty() ? fmt::format("there are {}", fmt::join(keys, ", "))
                                                                  : fmt::format("did you mean \"{}\"?", near)));
      if (!newer_) throw error;
      preset_.warnings.push_back(object.refused(fmt::format("unknown key \"{}\" is passed over", key)).what());
    }
  }

  void readCamera(const JsonReader& node) {
    if (node.isText()) {
      preset_.cameraName = node.text();
      return;
    }
    if (!node.isObject())
      throw node.refused(
          "the name of one of the scene's cameras, or an object with position and target, is wanted, not " +
          node.found());
    known(node, {"name", "position", "target", "up", "vertical_fov_degrees"});
    Camera camera;
    if (node.has("name")) camera.name = node.at("name").text();
    camera.position = node.at("position").vector();
    camera.target = node.at("target").vector();
    if (node.has("up")) camera.up = node.at("up").direction();
    if (node.has("vertical_fov_degrees")) camera.verticalFov = angle(node.at("vertical_fov_degrees"), 0.01f, 179.99f);
    if (!(glm::length(camera.target - camera.position) > 0))
      throw node.refused("position and target are the same point");
    preset_.camera = camera;
  }

  /// As in scene files.
  void readLights(const JsonReader& root) {
    LightEdits lights;
    for (const JsonReader& n : root.at("lights").elements("an array of lights")) {
      const std::string type = n.at("type").text();
      const std::string name = n.has("name") ? n.at("name").text() : type;
      if (type == "point") {
        known(n, {"type", "name", "position", "intensity"});
        lights.points.push_back({name, n.at("position").vector(), energy(n.at("intensity"))});
      } else if (type == "spot") {
        known(n, {"type", "name", "position", "direction", "intensity", "inner_degrees", "outer_degrees"});
        SpotLight light{name, n.at("position").vector(), unit(n.at("direction")), energy(n.at("intensity"))};
        if (n.has("inner_degrees")) light.innerAngle = angle(n.at("inner_degrees"), 0, 90);
        if (n.has("outer_degrees")) light.outerAngle = angle(n.at("outer_degrees"), 0, 90);
        if (!(light.innerAngle < light.outerAngle)) throw n.refused("inner_degrees must be below outer_degrees");
        lights.spots.push_back(light);
      } else if (type == "directional") {
        known(n, {"type", "name", "direction", "irradiance"});
        lights.directionals.push_back({name, unit(n.at("direction")), energy(n.at("irradiance"))});
      } else {
        throw n.at("type").refused("one of point, spot, directional is wanted, not " + n.at("type").found());
      }
    }
    if (root.has("sky")) lights.sky = energy(root.at("sky"));
    preset_.lights = lights;
  }

  /// As in scene files.
  void readRegions(const JsonReader& node) {
    std::vector<Region> regions;
    for (const JsonReader& n : node.elements("an array of regions")) {
      known(n, {"name", "x", "y", "width", "height"});
      Region r;
      r.name = n.at("name").text();
      for (const auto& [key, value] : {std::pair{"x", &r.x}, {"y", &r.y}, {"width", &r.width}, {"height", &r.height}})
        if (n.has(key)) *value = n.at(key).number(0, 1);
      regions.push_back(r);
    }
    try {
      checkRegions(regions);
    } catch (const Error& e) {
      throw node.refused(e.what());
    }
    preset_.regions = regions;
  }

  void readProbes(const JsonReader& node) {
    std::vector<vec3> probes;
    for (const JsonReader& n : node.elements("an array of places, [x, y, z] each")) probes.push_back(n.vector());
    try {
      checkProbes(probes);
    } catch (const Error& e) {
      throw node.refused(e.what());
    }
    preset_.probes = probes;
  }

  void readAnimation(const JsonReader& node) {
    node.wantObject();
    known(node, {"play", "start", "rate", "camera_path"});
    Playback& p = preset_.animation;
    if (node.has("play")) p.play = node.at("play").boolean();
    if (node.has("start")) p.start = node.at("start").number(0, kLongestAnimation);
    if (node.has("rate")) p.rate = node.at("rate").number(kLowestRate, kHighestRate);
    if (node.has("camera_path")) p.cameraPath = node.at("camera_path").text();
  }

  static float angle(const JsonReader& node, float low, float high) {
    node.number(low, high);
    return radiansOf(node.json().get<double>());
  }

  /// A direction of unit length already stays as it is, to the bit: what was saved is what is loaded.
  static vec3 unit(const JsonReader& node) {
    const vec3 v = node.direction();
    return std::abs(glm::dot(v, v) - 1.0f) < 1e-6f ? v : glm::normalize(v);
  }

  static vec3 energy(const JsonReader& node) {
    const vec3 v = node.vector();
    if (v.x < 0 || v.y < 0 || v.z < 0) throw node.refused("light cannot be negative");
    return v;
  }

  void readResolution(const JsonReader& node) {
    const std::vector<JsonReader> sides = node.elements("an array [width, height]");
    if (sides.size() != 2)
      throw node.refused(fmt::format("[width, height] is wanted, not an array of {}", sides.size()));
    preset_.width = static_cast<int>(sides[0].whole(1, kMaxPresetSide));
    preset_.height = static_cast<int>(sides[1].whole(1, kMaxPresetSide));
  }

  void readTechnique(const JsonReader& node) {
    preset_.technique = node.text();
    try {
      techniqueInfo(preset_.technique);
    } catch (const Error& e) {
      if (!newer_) throw node.refused(e.what());
      preset_.warnings.push_back(node.refused(fmt::format("{}; none is taken", e.what())).what());
      preset_.technique = "none";
    }
  }

  void readParameters(const JsonReader& node) {
    node.wantObject();
    const auto groups = parameterGroups(preset_.technique);
    for (const auto& member : node.json().items()) {
      try {
        const ParamInfo* info = findParameter(groups, member.key());
        if (!info) {
          const std::string near = nearestParameter(groups, member.key());
          throw node.refused(fmt::format("unknown parameter \"{}\" of technique {}{}", member.key(), preset_.technique,
                                         near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near)));
        }
        preset_.parameters[member.key()] = parameterText(node.at(member.key()), *info);
      } catch (const Error& e) {
        if (!newer_) throw;
        preset_.warnings.push_back(fmt::format("{}; passed over", e.what()));
      }
    }
  }

  void readDisplay(const JsonReader& node) {
    known(node, {"exposure", "tone_map", "view", "show_invalid", "error_metric"});
    Display& display = preset_.display;
    if (node.has("exposure")) display.exposure = node.at("exposure").number(-kMaxExposure, kMaxExposure);
    if (node.has("tone_map")) {
      const JsonReader name = node.at("tone_map");
      const auto found = std::find(std::begin(kToneMapNames), std::end(kToneMapNames), name.text());
      if (found == std::end(kToneMapNames))
        throw name.refused(fmt::format("one of {} is wanted, not {}", fmt::join(kToneMapNames, ", "), name.found()));
      display.toneMap = static_cast<ToneMap>(found - std::begin(kToneMapNames));
    }
    if (node.has("view")) display.view = node.at("view").text();
    if (node.has("show_invalid")) display.showInvalid = node.at("show_invalid").boolean();
    if (node.has("error_metric")) {
      const JsonReader metric = node.at("error_metric");
      try {
        display.errorMetric = metricInfo(metric.text()).id;
      } catch (const Error& e) {
        throw metric.refused(e.what());
      }
    }
  }

  Preset& preset_;
  bool newer_;
};

}  // namespace

Preset presetFromJson(const std::string& text, const std::string& whereFrom) {
  nlohmann::json document = parseStrictJson(text, whereFrom);
  const JsonReader head(document, whereFrom);
  const int64_t version = head.at("version").whole(1, 1'000'000);
  Preset preset;
  const bool newer = version > kPresetVersion;
  if (newer)
    preset.warnings.push_back(fmt::format("{}: version {} is newer than this program's ({}); what it knows is loaded",
                                          whereFrom, version, kPresetVersion));
  else
    document =
        migrated(std::move(document), static_cast<int>(version), kPresetVersion, presetMigrations(), preset.warnings);
  PresetReader(preset, newer).read(JsonReader(document, whereFrom));
  return preset;
}

Preset loadPreset(const std::filesystem::path& file) {
  Preset preset = presetFromJson(readFile(file), file.string());
  preset.file = file;
  return preset;
}

}  // namespace hl
