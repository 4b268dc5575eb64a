#include "engine/experiment/preset.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/experiment/preset_migration.h"
#include "engine/experiment/preset_schema.h"

namespace hl {
namespace {

template <class F>
std::string refusal(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::BadInput);
    return e.what();
  }
  ADD_FAILURE() << "was accepted";
  return {};
}

std::string refusalOf(const std::string& json) {
  return refusal([&] { presetFromJson(json, "p.json"); });
}

/// A whole preset with one more line.
std::string with(const std::string& line) {
  return R"({"version": 1, "scene": "cornell_box", "technique": "none")" + (line.empty() ? "" : ", " + line) + "}";
}

TEST(Preset, ReadsEveryPart) {
  const Preset p = presetFromJson(
      R"({"version": 1, "scene": "cornell_box", "camera": "front", "resolution": [320, 180], "seed": 4294967295,
          "technique": "none", "parameters": {"lightmap.resolution": 512, "direct.ray_offset": 0.0001},
          "display": {"exposure": -1.5, "view": "direct", "tone_map": "aces", "show_invalid": true, "error_metric": "flip"}})",
      "p.json");
  EXPECT_EQ(p.scene, "cornell_box");
  EXPECT_EQ(p.cameraName, "front");
  EXPECT_EQ(p.width, 320);
  EXPECT_EQ(p.height, 180);
  EXPECT_EQ(p.seed, 4294967295u);
  EXPECT_EQ(p.technique, "none");
  EXPECT_EQ(p.parameters.at("lightmap.resolution"), "512");
  EXPECT_EQ(p.parameters.at("direct.ray_offset"), "1e-04");
  EXPECT_EQ(p.display.exposure, -1.5f);
  EXPECT_EQ(p.display.toneMap, ToneMap::Aces);
  EXPECT_EQ(p.display.view, "direct");
  EXPECT_TRUE(p.display.showInvalid);
  EXPECT_EQ(p.display.errorMetric, "flip");
  EXPECT_TRUE(p.warnings.empty());
}

TEST(Preset, RoundTripsToTheBit) {
  Preset p;
  p.technique = "none";
  p.scene = "scenes/b\u00e4ume \"x\".json";
  Camera camera;
  camera.position = vec3(0.1f, 1.0f / 3.0f, -7e-9f), camera.target = vec3(1e6f, 2, 3), camera.verticalFov = 0.7853982f;
  p.camera = camera;
  LightEdits lights;
  lights.points.push_back({"lamp", vec3(0.3f), vec3(17, 12, 4)});
  lights.spots.push_back({"spot", vec3(1, 2, 3), glm::normalize(vec3(1, -2, 0.3f)), vec3(5), 0.2f, 0.4f});
  lights.directionals.push_back({"sun", glm::normalize(vec3(0.1f, -1, 0.2f)), vec3(3)});
  lights.sky = vec3(0.1f, 0.2f, 0.3f);
  p.lights = lights;
  p.seed = 9;
  p.parameters = {{"lightmap.resolution", "512"}, {"lightmap.uv_overlap_tolerance", "0.01"}};
  p.display.exposure = 0.1f;
  const Preset q = presetFromJson(presetJson(p), "p.json");
  EXPECT_EQ(presetJson(q), presetJson(p));
  EXPECT_EQ(q.scene, p.scene);
  ASSERT_TRUE(q.camera);
  EXPECT_EQ(q.camera->position, camera.position);
  EXPECT_EQ(q.camera->target, camera.target);
  EXPECT_EQ(q.camera->verticalFov, camera.verticalFov);
  ASSERT_TRUE(q.lights);
  EXPECT_EQ(q.lights->spots[0].direction, lights.spots[0].direction);
  EXPECT_EQ(q.lights->directionals[0].direction, lights.directionals[0].direction);
  EXPECT_EQ(q.lights->sky, lights.sky);
  EXPECT_EQ(q.parameters, p.parameters);
  EXPECT_EQ(q.display, p.display);
  EXPECT_EQ(presetHash(q), presetHash(p));
  for (const char c : presetJson(p)) EXPECT_TRUE(c > 0) << "image files carry ASCII alone";
}

TEST(Preset, AnglesRoundTripAsShortDegrees) {
  Preset p;
  p.technique = "none";
  p.camera = Camera();
  for (int i = 1; i < 2000; ++i) {
    p.camera->verticalFov = 0.0015f * static_cast<float>(i);
    EXPECT_EQ(presetFromJson(presetJson(p), "p.json").camera->verticalFov, p.camera->verticalFov);
  }
  p.camera->verticalFov = 0.78539816339f;
  EXPECT_NE(presetJson(p).find("\"vertical_fov_degrees\": 45.0}"), std::string::npos) << presetJson(p);
}

TEST(Preset, HashIsOfWhatTheNumbersDependOn) {
  Preset p;
  p.technique = "none";
  const std::string hash = presetHash(p);
  Preset shown = p;
  shown.display.exposure = 2, shown.display.view = "direct", shown.file = "elsewhere.json";
  EXPECT_EQ(presetHash(shown), hash);
  Preset spelt = p;
  spelt.parameters["lightmap.resolution"] = "256";  // the default, spelt out
  EXPECT_EQ(presetHash(spelt), hash);
  const auto differs = [&](auto change) {
    Preset q = p;
    change(q);
    return presetHash(q) != hash;
  };
  EXPECT_TRUE(differs([](Preset& q) { q.seed = 2; }));
  EXPECT_TRUE(differs([](Preset& q) { q.width = 641; }));
  EXPECT_TRUE(differs([](Preset& q) { q.scene = "other"; }));
  EXPECT_TRUE(differs([](Preset& q) { q.cameraName = "side"; }));
  EXPECT_TRUE(differs([](Preset& q) { q.camera = Camera(); }));
  EXPECT_TRUE(differs([](Preset& q) { q.lights = LightEdits(); }));
  EXPECT_TRUE(differs([](Preset& q) { q.parameters["lightmap.resolution"] = "257"; }));
}

TEST(Preset, ResolvedHoldsEveryParameter) {
  Preset p;
  p.technique = "none";
  p.parameters["lightmap.dilation"] = "3";
  const auto brief = nlohmann::json::parse(presetJson(p));
  EXPECT_EQ(brief["parameters"].size(), 1u);
  const auto all = nlohmann::json::parse(presetJson(p, true));
  EXPECT_EQ(all["parameters"]["lightmap.dilation"], 3);
  EXPECT_EQ(all["parameters"]["lightmap.resolution"], 256);
  EXPECT_EQ(all["parameters"]["lightmap.uv_overlap_tolerance"], 0.001);
  EXPECT_EQ(presetHash(presetFromJson(presetJson(p, true), "p.json")), presetHash(p));
}

TEST(Preset, RefusalsNameFilePathAndWhatWouldBeRight) {
  EXPECT_EQ(refusalOf(with(R"("resolutoin": [1, 1])")),
            "p.json: unknown key \"resolutoin\"; did you mean \"resolution\"?");
  EXPECT_EQ(refusalOf(with(R"("resolution": [0, 10])")), "p.json: resolution[0]: 0 is out of range [1, 8192]");
  EXPECT_EQ(refusalOf(with(R"("resolution": [10])")),
            "p.json: resolution: [width, height] is wanted, not an array of 1");
  EXPECT_EQ(refusalOf(with(R"("resolution": [10.5, 10])")),
            "p.json: resolution[0]: a whole number in [1, 8192] is wanted, not the number 10.5");
  EXPECT_NE(refusalOf(with(R"("display": {"error_metric": "flipp"})")).find("p.json: display.error_metric: unknown metric 'flipp'; did you mean 'flip'?"), std::string::npos);
  EXPECT_EQ(refusalOf(with(R"("seed": -1)")), "p.json: seed: -1 is out of range [0, 4294967295]");
  EXPECT_EQ(refusalOf(with(R"("seed": "1")")),
            "p.json: seed: a whole number in [0, 4294967295] is wanted, not the text \"1\"");
  EXPECT_EQ(refusalOf(R"({"version": 1, "scene": 3})"), "p.json: scene: a text is wanted, not the number 3");
  EXPECT_EQ(refusalOf(R"({"version": 1})"), "p.json: the key \"scene\" is missing");
  EXPECT_EQ(refusalOf(R"({"scene": "x"})"), "p.json: the key \"version\" is missing");
  EXPECT_EQ(refusalOf(R"({"version": "1", "scene": "x"})").substr(0, 16), "p.json: version:");
  EXPECT_EQ(refusalOf("[]"), "p.json: an object is wanted, not an array of 0");
  EXPECT_NE(refusalOf(with(R"("camera": 3)")).find("p.json: camera: "), std::string::npos);
  EXPECT_EQ(refusalOf(with(R"("camera": {"position": [0, 0, 0]})")), "p.json: camera: the key \"target\" is missing");
  EXPECT_EQ(refusalOf(with(R"("camera": {"position": [0, 0, "1"], "target": [0, 0, 1]})")),
            "p.json: camera.position[2]: a number is wanted, not the text \"1\"");
  EXPECT_EQ(refusalOf(with(R"("camera": {"position": [1, 2, 3], "target": [1, 2, 3]})")),
            "p.json: camera: position and target are the same point");
  EXPECT_EQ(refusalOf(with(R"("lights": [{"type": "point", "position": [0, 0, 0], "intensity": [1, -1, 0]}])")),
            "p.json: lights[0].intensity: light cannot be negative");
  EXPECT_EQ(refusalOf(with(R"("lights": [{"type": "lamp"}])")),
            "p.json: lights[0].type: one of point, spot, directional is wanted, not the text \"lamp\"");
  EXPECT_EQ(refusalOf(with(R"("sky": [1, 1, 1])")).substr(0, 12), "p.json: sky:");
  EXPECT_EQ(refusalOf(with(R"("display": {"tone_map": "filmic"})")),
            "p.json: display.tone_map: one of linear, aces, reinhard is wanted, not the text \"filmic\"");
  EXPECT_NE(refusalOf(R"({"version": 1, "scene": "x", "technique": "nome"})").find("p.json: technique: "),
            std::string::npos);
}

TEST(Preset, ParametersAreCheckedAgainstTheirDeclarations) {
  EXPECT_EQ(refusalOf(with(R"("parameters": {"lightmap.resolutoin": 256})")),
            "p.json: parameters: unknown parameter \"lightmap.resolutoin\" of technique none; did you mean "
            "\"lightmap.resolution\"?");
  EXPECT_EQ(refusalOf(with(R"("parameters": {"lightmap.resolution": 5000})")),
            "p.json: parameters.\"lightmap.resolution\": lightmap.resolution = 5000: out of range [32, 4096] texels");
  EXPECT_EQ(refusalOf(with(R"("parameters": {"lightmap.resolution": "256"})")),
            "p.json: parameters.\"lightmap.resolution\": a whole number in [32, 4096] texels is wanted, not the text "
            "\"256\"");
  EXPECT_NE(refusalOf(with(R"("parameters": {"direct.ray_offset": true})")).find("a number is wanted, not true"),
            std::string::npos);
  EXPECT_NE(refusalOf(with(R"("parameters": {"direct.ray_offset": 1e39})")).find("32-bit float"), std::string::npos);
  EXPECT_NE(refusalOf(with(R"("parameters": [])")).find("an object is wanted"), std::string::npos);
}

TEST(Preset, BrokenJsonNamesLineAndColumn) {
  EXPECT_EQ(refusalOf("{\n  \"version\": 1,\n  \"scene\": }").substr(0, 41),
            "p.json: line 3, column 12: not valid JSON");
  EXPECT_NE(refusalOf(with("\"seed\": NaN")).find("not valid JSON"), std::string::npos);
  EXPECT_NE(refusalOf(with("\"seed\": 1e999")).find("not valid JSON"), std::string::npos);
  EXPECT_NE(refusalOf("").find("p.json: line 1, column 1: not valid JSON"), std::string::npos);
  EXPECT_EQ(refusalOf(with("\"seed\": 1, \"seed\": 2")), "p.json: the key \"seed\" stands twice in one object");
  for (const std::string& text : {refusalOf("{\"a\": \n\n [\"\x01\"]}"), refusalOf("{\"\xff\": 1}")})
    EXPECT_EQ(text.find('\n'), std::string::npos) << "one line";
}

TEST(Preset, ANewerVersionWarnsAndLoadsWhatItKnows) {
  const Preset p = presetFromJson(
      R"({"version": 2, "scene": "cornell_box", "technique": "none", "weather": "rain", "seed": 5,
          "parameters": {"lightmap.resolution": 512, "lightmap.colour": "red", "lightmap.dilation": "much"}})",
      "p.json");
  EXPECT_EQ(p.seed, 5u);
  EXPECT_EQ(p.parameters, (std::map<std::string, std::string>{{"lightmap.resolution", "512"}}));
  EXPECT_EQ(p.warnings.size(), 4u) << "version, key, unknown parameter, unreadable value";
}

TEST(Preset, ValuesThatJsonCannotHoldAreNotWritten) {
  Preset p;
  p.technique = "none";
  p.display.exposure = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(refusal([&] { presetJson(p); }).find("display.exposure"), std::string::npos);
  p.display.exposure = 0;
  p.camera = Camera();
  p.camera->position.y = std::numeric_limits<float>::infinity();
  EXPECT_NE(refusal([&] { presetJson(p); }).find("camera.position"), std::string::npos);
}

TEST(Preset, MigrationsRunInOrder) {
  const std::vector<Migration> steps = {
      {2, "b", [](nlohmann::json& j) { j["trail"] = j["trail"].get<std::string>() + "b"; }},
      {1, "a", [](nlohmann::json& j) { j["trail"] = j["trail"].get<std::string>() + "a"; }}};
  std::vector<std::string> notes;
  const auto out = migrated({{"version", 1}, {"trail", ""}}, 1, 3, steps, notes);
  EXPECT_EQ(out["trail"], "ab");
  EXPECT_EQ(out["version"], 3);
  EXPECT_EQ(notes, (std::vector<std::string>{"version 1: a", "version 2: b"}));
  EXPECT_NE(refusal([&] { migrated({{"version", 3}}, 3, 4, steps, notes); }).find("version 3"), std::string::npos);
}

TEST(Preset, SavesAndLoadsFiles) {
  const auto file = std::filesystem::temp_directory_path() / "halflight_preset_test.json";
  Preset p;
  p.technique = "none";
  p.seed = 77;
  savePreset(p, file);
  const Preset q = loadPreset(file);
  EXPECT_EQ(q.seed, 77u);
  EXPECT_EQ(q.file, file);
  std::filesystem::remove(file);
  EXPECT_NE(refusal([&] { loadPreset(file); }).find(file.string()), std::string::npos);
}

TEST(Preset, ThoseOfTheProjectAllLoad) {
  const auto presets = listPresets();
  ASSERT_FALSE(presets.empty());
  bool defaultPreset = false;
  for (const PresetListing& listing : presets) {
    const Preset p = loadPreset(listing.file);
    EXPECT_TRUE(p.warnings.empty()) << listing.file;
    EXPECT_EQ(presetHash(presetFromJson(presetJson(p), "again")), presetHash(p)) << listing.file;
    defaultPreset |= listing.id == "cornell_radiosity";
  }
  EXPECT_TRUE(defaultPreset);
}

TEST(PresetSchema, HasEveryKeyThatAPresetHas) {
  const auto schema = nlohmann::json::parse(presetSchema());
  Preset p;
  p.technique = "none";
  p.camera = Camera();
  p.lights = LightEdits();
  const auto written = nlohmann::json::parse(presetJson(p, true));
  for (const auto& member : written.items()) {
    ASSERT_TRUE(schema["properties"].contains(member.key())) << member.key();
    if (member.key() != "parameters" && member.key() != "display") continue;
    for (const auto& inner : member.value().items())
      EXPECT_TRUE(schema["properties"][member.key()]["properties"].contains(inner.key())) << inner.key();
  }
  EXPECT_EQ(schema["properties"]["parameters"]["properties"]["lightmap.resolution"]["maximum"], 4096);
  EXPECT_EQ(schema["properties"]["technique"]["enum"][0], "none");
  EXPECT_EQ(schema["required"], (nlohmann::json{"version", "scene"}));
}

}  // namespace
}  // namespace hl
