#pragma once
// A preset: everything needed to make a picture again (DESIGN.md section 9).
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/passes/display.h"
#include "engine/scene/scene.h"

namespace hl {

inline constexpr int kPresetVersion = 1;

/// Lights that were changed against the scene's file; written only then.
struct LightEdits {
  std::vector<PointLight> points;
  std::vector<SpotLight> spots;
  std::vector<DirectionalLight> directionals;
  vec3 sky{0.0f};
};

/// How the scene's time runs. Frame n of a run that plays is at start + n / rate seconds; one that does not play stays at `start`.
struct Playback {
  bool play = false;
  float start = 0;         ///< [s], from 0 on
  float rate = 30;         ///< frames a second of the scene's time
  std::string cameraPath;  ///< one of the scene's, which then holds the camera; "" for none
  bool operator==(const Playback&) const = default;
};

struct Preset {
  std::string scene = "cornell_box";
  std::string cameraName;            ///< a camera of the scene; "" the first
  std::optional<Camera> camera;      ///< set when it was moved: written in place of the name
  std::optional<LightEdits> lights;  ///< JSON key "lights": the whole set, in place of the scene's
  std::optional<std::vector<Region>> regions;  ///< of interest, in place of the scene's; no picture depends on them
  std::optional<std::vector<vec3>> probes;     ///< in place of the scene's own: for probes.placement manual
  Playback animation;
  int width = 640, height = 360;
  uint32_t seed = 1;
  std::string technique = "radiosity";
  std::map<std::string, std::string> parameters;  ///< by dotted key, as text; only those that differ from the default
  Display display;
  std::filesystem::path file;         ///< where it came from, not part of its identity
  std::vector<std::string> warnings;  ///< of loading: unknown keys of a newer version, migrations
};

/// @throws Error(BadInput): file, JSON path, value, what would be right. A newer version warns and loads what it knows.
Preset loadPreset(const std::filesystem::path&);
Preset presetFromJson(const std::string& text, const std::string& whereFrom);
/// `resolved`: every parameter with its value, not only those that differ.
std::string presetJson(const Preset&, bool resolved = false);
void savePreset(const Preset&, const std::filesystem::path&);
/// Of its canonical JSON, without display, regions and file: what the numbers depend on.
std::string presetHash(const Preset&);
struct PresetListing {
  std::string id, label;
  std::filesystem::path file;
};
std::vector<PresetListing> listPresets();

}  // namespace hl
