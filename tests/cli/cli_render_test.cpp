// What needs a device: renders, references, the doctor, bad scenes, and a device that is not there.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/core/image_io.h"
#include "tests/cli/cli_process.h"

namespace hl::test {
namespace {

using nlohmann::json;

const std::vector<std::string> kTiny = {"--resolution", "48x27",
                                        "--set",        "lightmap.resolution=32",
                                        "--set",        "radiosity.samples=16",
                                        "--set",        "radiosity.bounces=2",
                                        "--set",        "direct.samples=4",
                                        "--set",        "direct.lumel_samples=4",
                                        "--set",        "reference.samples=4",
                                        "--set",        "reference.direct_samples=4"};

std::vector<std::string> tiny(std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), kTiny.begin(), kTiny.end());
  return arguments;
}

/// One line on stderr that contains every part, nothing on stdout.
void expectFailure(const CliResult& r, int code, const std::vector<std::string>& parts) {
  EXPECT_EQ(r.code, code) << r.err;
  EXPECT_EQ(r.out, "");
  EXPECT_EQ(r.err.find('\n'), r.err.size() - 1) << "one line: " << r.err;
  EXPECT_EQ(r.err.rfind("halflight-cli: ", 0), 0u) << r.err;
  for (const std::string& part : parts) EXPECT_NE(r.err.find(part), std::string::npos) << part << " in: " << r.err;
}

/// Precomputation is said before it begins; what it refuses is said once, and is bad usage where a parameter is at fault.
TEST(CliRender, SaysWhatPrecomputationTakesAndWhatItRefuses) {
  std::vector<std::string> srp = {"render", "cornell_box", "--technique", "srp", "--resolution", "32x24", "--set", "direct.samples=4", "--set", "lightmap.resolution=32",
                                  "--set", "probes.spacing=0.5", "--set", "srp.receiver_rays=64", "--frames", "1"};
  srp.insert(srp.begin(), "--verbose");
  const CliResult r = runCli(srp);
  EXPECT_EQ(r.code, 0) << r.err;
  for (const char* part : {"halflight-cli: precomputation: ", " rays, ", "before compression"}) EXPECT_NE(r.err.find(part), std::string::npos) << r.err;

  srp.erase(srp.begin());
  for (const char* setting : {"srp.sh_order=8", "srp.probe_rays=64"}) srp.insert(srp.end(), {"--set", setting});
  expectFailure(runCli(srp), 2, {"srp.probe_rays: 64 rays"});
}

/// The same frames each time, at moments that the frame's number alone decides; a cut and a door that opens have an end.
TEST(CliRender, PlaysAScene) {
  const std::vector<std::string> play = {"render", "two_rooms", "--technique", "none", "--resolution", "32x24", "--set", "direct.samples=4",
                                         "--play", "--time",    "0.5",         "--rate", "4",          "--frames", "4", "--camera-path", "through", "--json"};
  const CliResult first = runCli(play), second = runCli(play);
  ASSERT_EQ(first.code, 0) << first.err;
  const json a = json::parse(first.out), b = json::parse(second.out);
  EXPECT_NEAR(a.at("time_s").get<double>(), 1.25, 1e-6);
  EXPECT_EQ(a.at("preset").at("animation").at("camera_path"), "through");
  EXPECT_EQ(a.at("image"), b.at("image"));
  EXPECT_FALSE(a.at("settled").get<bool>());
  bool posed = false;
  for (const json& p : a.at("passes")) posed |= p.at("name") == "scene: pose vertices" && p.at("skipped").is_null();
  EXPECT_TRUE(posed);

  std::vector<std::string> endless = play;
  endless.erase(std::find(endless.begin(), endless.end(), "--frames"), std::find(endless.begin(), endless.end(), "--camera-path"));
  expectFailure(runCli(endless), 2, {"never settles", "frames"});
  expectFailure(runCli({"render", "two_rooms", "--technique", "none", "--camera-path", "thruogh"}), 2, {"camera path 'thruogh'", "through"});
  expectFailure(runCli(tiny({"render", "cornell_box", "--step", "time=1"})), 2, {"nothing in the scene 'cornell_box' is animated"});

  for (const char* step : {"time=2", "camera=dark"}) {
    const CliResult r = runCli({"render", "two_rooms", "--camera", "lit", "--technique", "radiosity", "--resolution", "32x24", "--set", "direct.samples=4", "--set",
                                "lightmap.resolution=48", "--set", "radiosity.samples=16", "--set", "radiosity.bounces=2", "--step", step, "--json"});
    ASSERT_EQ(r.code, 0) << r.err;
    const json s = json::parse(r.out).at("step");
    EXPECT_EQ(s.at("edit"), step);
    EXPECT_GT(s.at("size").get<double>(), 0);
    EXPECT_GE(s.at("frames_to_1_percent").get<double>(), s.at("frames_to_5_percent").get<double>());
    EXPECT_TRUE(s.at("settled").get<bool>());
    if (std::string(step) == "camera=dark") {
      EXPECT_EQ(s.at("frames_to_1_percent"), 1) << "a lightmap does not care who looks";
    }
  }
}

TEST(CliRender, ATimeThatWasNotMeasuredIsNoZero) {
  const std::vector<std::string> one = {"render", "cornell_box", "--technique", "none", "--resolution", "32x24", "--frames", "1"};
  std::vector<std::string> asJson = one;
  asJson.push_back("--json");
  const CliResult r = runCli(asJson), text = runCli(one);
  ASSERT_EQ(r.code, 0) << r.err;
  const json d = json::parse(r.out);
  EXPECT_TRUE(d.at("frame_ms").at("median").is_null()) << d.at("frame_ms");
  for (const json& p : d.at("passes")) EXPECT_TRUE(p.at("median_ms").is_null() || p.at("median_ms") > 0) << p;
  EXPECT_NE(text.out.find("frame not measured"), std::string::npos) << text.out;
}

TEST(CliRender, PrintsTheDocumentOfTheDesign) {
  const TemporaryFolder folder;
  const CliResult r = runCli(tiny({"render", "cornell_box", "--json", "--metrics", "relmse,bias", "--errors-of",
                                   "image,lightmap", "--out", folder / "out"}));
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.err, "");
  const json d = json::parse(r.out);
  EXPECT_EQ(d.at("technique"), "radiosity");
  EXPECT_EQ(d.at("preset").at("parameters").at("lightmap.resolution"), 32);
  EXPECT_EQ(d.at("preset").at("parameters").at("direct.ray_offset"), 1e-5) << "every value, not only those that differ";
  EXPECT_GE(d.at("frames").get<int>(), 1);
  EXPECT_TRUE(d.at("settled").get<bool>());
  for (const char* key : {"median", "p5", "p95"}) EXPECT_GT(d.at("frame_ms").at(key).get<double>(), 0) << key;
  ASSERT_FALSE(d.at("passes").empty());
  for (const json& p : d.at("passes")) {
    for (const char* key : {"name", "where", "median_ms", "p5_ms", "p95_ms", "skipped"})
      EXPECT_TRUE(p.contains(key)) << p;
    EXPECT_TRUE(p.at("skipped").is_null() || p.at("skipped").is_string());
  }
  ASSERT_FALSE(d.at("memory").empty());
  EXPECT_GT(d.at("memory").back().at("bytes").get<double>(), 0);
  EXPECT_TRUE(d.at("counters").contains("nan_inf"));
  bool matched = false, full = false, lightmap = false;
  for (const json& e : d.at("errors")) {
    for (const char* key : {"reference", "target", "component", "metric", "value", "noise_floor", "roi"})
      EXPECT_TRUE(e.contains(key)) << e;
    matched |= e.at("reference") == "matched" && e.at("target") == "image";
    full |= e.at("reference") == "full";
    lightmap |= e.at("target") == "lightmap";
  }
  EXPECT_TRUE(matched && full && lightmap);
  EXPECT_TRUE(d.at("convergence").is_array());
  for (const char* key :
       {"commit", "dirty", "preset_hash", "scene_hash", "seed", "device", "driver", "api", "tracer", "timing"})
    EXPECT_TRUE(d.at("provenance").contains(key)) << key;

  EXPECT_EQ(json::parse(contentOf(folder / "out/result.json")).at("image"), d.at("image"));
  for (const std::string file : d.at("files"))
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "out" / file)) << file;
  const Image final = readImage(folder / "out/final.exr");
  EXPECT_EQ(final.width, 48);
  double sum = 0;
  for (const float v : final.data) sum += v;
  EXPECT_GT(sum, 0) << "a picture, not a black frame";
  EXPECT_EQ(json::parse(final.metadata.at("halflight.provenance")), d.at("provenance"));
}

TEST(CliRender, TheSameTwiceAndFromItsOwnScreenshot) {
  const TemporaryFolder folder;
  const auto render = [](std::vector<std::string> arguments) {
    const CliResult r = runCli(arguments);
    EXPECT_EQ(r.code, 0) << r.err;
    return r.code == 0 ? json::parse(r.out) : json();
  };
  const json first = render(tiny({"render", "cornell_radiosity", "--json", "--seed", "7", "--out", folder / "a"}));
  const json second = render(tiny({"render", "cornell_radiosity", "--json", "--seed", "7"}));
  const json again = render({"render", folder / "a/picture.png", "--json"});
  const json other = render(tiny({"render", "cornell_radiosity", "--json", "--seed", "8"}));
  EXPECT_EQ(first.at("image"), second.at("image"));
  EXPECT_EQ(first.at("image"), again.at("image"));
  EXPECT_EQ(first.at("provenance").at("preset_hash"), again.at("provenance").at("preset_hash"));
  EXPECT_NE(first.at("image").at("hash"), other.at("image").at("hash")) << "another seed, another noise";
}

TEST(CliRender, FramesAreCountedAndTheSummaryIsReadable) {
  const CliResult r = runCli(tiny({"render", "cornell_box", "--technique", "none", "--frames", "3"}));
  // The technique's own parameters mean nothing to another.
  EXPECT_EQ(r.code, 2) << r.out;
  const CliResult plain =
      runCli({"render", "cornell_box", "--technique", "none", "--frames", "3", "--resolution", "32x18"});
  ASSERT_EQ(plain.code, 0) << plain.err;
  EXPECT_NE(plain.out.find("3 frames"), std::string::npos) << plain.out;
  EXPECT_NE(plain.out.find("composite"), std::string::npos) << plain.out;
  EXPECT_EQ(plain.err, "");
}

TEST(CliRender, ThePictureShowsTheViewThatIsWanted) {
  const TemporaryFolder folder;
  const auto picture = [&](const std::string& view, const char* name) {
    const CliResult r = runCli({"render", "cornell_box", "--technique", "none", "--frames", "1", "--resolution",
                                "32x18", "--view", view, "--out", folder / name});
    EXPECT_EQ(r.code, 0) << r.err;
    return readImage(folder.path() / name / "picture.png");
  };
  EXPECT_NE(picture("albedo", "a").data, picture("normal", "b").data);
  expectFailure(runCli({"render", "cornell_box", "--view", "albed"}), 2, {"albed", "albedo"});
}

TEST(CliRender, CtrlCKeepsWhatIsDone) {
  const CliResult r =
      runCli({"render", "cornell_box", "--json", "--resolution", "64x36", "--set", "lightmap.resolution=1024", "--set",
              "radiosity.samples=4096", "--set", "radiosity.residual=0", "--set", "radiosity.bounces=64"},
             {}, 8);
  EXPECT_EQ(r.code, 130) << r.err;
  EXPECT_NE(r.err.find("cancelled"), std::string::npos) << r.err;
  EXPECT_EQ(r.err.find("Vulkan: "), std::string::npos) << "a message of the validation layers: " << r.err;
  EXPECT_TRUE(json::parse(r.out).at("cancelled").get<bool>());
}

TEST(CliReference, WritesTheTruthAndItsNoise) {
  const TemporaryFolder folder;
  const CliResult r = runCli({"reference", "cornell_box", "--spp", "8", "--bounces", "2", "--diffuse-only",
                              "--resolution", "32x18", "--json", "--out", folder / "r.exr"});
  ASSERT_EQ(r.code, 0) << r.err;
  const json d = json::parse(r.out);
  EXPECT_EQ(d.at("samples"), 8);
  EXPECT_EQ(d.at("bounces"), 2);
  ASSERT_EQ(d.at("images").size(), 3u);
  for (const json& i : d.at("images")) EXPECT_TRUE(std::filesystem::exists(i.at("file").get<std::string>())) << i;
  EXPECT_GT(d.at("images")[1].at("rms_noise").get<double>(), 0);
  const CliResult bad =
      runCli({"reference", "cornell_box", "--spp", "2", "--resolution", "8x8", "--out", folder / "r.png"});
  expectFailure(bad, 2, {"r.png", ".exr or .pfm"});
}

TEST(CliDoctor, MeasuresTheTracers) {
  const CliResult r = runCli({"doctor", "cornell_box", "--json"});
  ASSERT_EQ(r.code, 0) << r.err;
  const json d = json::parse(r.out);
  for (const char* key : {"name", "type", "driver", "api"}) EXPECT_TRUE(d.at("device").at(key).is_string()) << key;
  EXPECT_TRUE(d.at("features").is_object());
  EXPECT_GT(d.at("copy_gbps").get<double>(), 0);
  EXPECT_TRUE(d.at("missing").is_array());
  ASSERT_GE(d.at("tracers").size(), 2u);
  for (const json& t : d.at("tracers")) {
    if (!t.at("available").get<bool>()) {
      EXPECT_NE(t.at("reason"), "") << t;
      continue;
    }
    EXPECT_GT(t.at("mrays_closest").get<double>(), 0) << t;
    EXPECT_GT(t.at("mrays_any").get<double>(), 0) << t;
  }
}

TEST(CliDevice, WithoutOneTheExitCodeIsThree) {
  const std::vector<std::string> noDriver = {"VK_ICD_FILENAMES=/nonexistent.json", "VK_DRIVER_FILES=/nonexistent.json"};
  expectFailure(runCli({"render", "cornell_box"}, noDriver), 3, {"Vulkan"});
  expectFailure(runCli({"list", "devices"}, noDriver), 3, {"Vulkan"});
  const CliResult doctor = runCli({"doctor", "--json"}, noDriver);
  EXPECT_EQ(doctor.code, 3);
  const json d = json::parse(doctor.out);
  EXPECT_TRUE(d.at("device").is_null());
  EXPECT_FALSE(d.at("missing").empty());
  const CliResult devices = runCli({"list", "devices", "--json"});
  ASSERT_EQ(devices.code, 0) << devices.err;
  EXPECT_FALSE(json::parse(devices.out).empty());
  expectFailure(runCli({"render", "cornell_box", "--device", "no such device"}), 2, {"no such device"});
  expectFailure(runCli({"render", "cornell_box", "--tracer", "embre"}), 2, {"embre"});
}

// The layer is told, by its own variable, to complain of what is not wrong (best practices): a run that would pass
// fails.
TEST(CliValidation, AMessageFailsTheRun) {
  const std::vector<std::string> run = {"render", "cornell_box",  "--technique", "none",  "--frames",
                                        "1",      "--resolution", "16x9",        "--json"};
  const std::string complain = "VK_LAYER_ENABLES=VK_VALIDATION_FEATURE_ENABLE_BEST_PRACTICES_EXT";
  const CliResult fails = runCli(run, {"HALFLIGHT_VALIDATION=1", complain});
  EXPECT_EQ(fails.code, 1);
  EXPECT_NE(fails.err.find("BestPractices"), std::string::npos) << fails.err;
  EXPECT_EQ(runCli(run, {"HALFLIGHT_VALIDATION=0", complain}).code, 0);
  const CliResult passes = runCli(run, {"HALFLIGHT_VALIDATION=1"});
  EXPECT_EQ(passes.code, 0) << passes.err;
  std::vector<std::string> asked = run;
  asked.emplace_back("--validation");
  EXPECT_EQ(runCli(asked, {"HALFLIGHT_VALIDATION=0", complain}).code, 1)
      << "the option stands whatever the variable says";
  EXPECT_EQ(runCli(run, {"HALFLIGHT_VALIDATION=perhaps"}).code, 2);
}

class CliBadScene : public ::testing::Test {
 protected:
  void mesh(const std::string& text, const std::vector<std::string>& parts, const char* name = "m.obj") {
    writeText(folder / name, text);
    refused(name, parts);
  }
  void refused(const std::string& name, std::vector<std::string> parts) {
    expectFailure(runCli({"render", folder / name, "--resolution", "16x9"}), 2, parts);
  }
  TemporaryFolder folder;
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
};

TEST_F(CliBadScene, MissingMesh) {
  refused("none.obj", {"none.obj"});
  writeText(folder / "s.json", R"({"version": 1, "mesh": "none.obj"})");
  refused("s.json", {"none.obj"});
  expectFailure(runCli({"render", "no_such_scene"}), 2, {"no_such_scene"});
}

TEST_F(CliBadScene, TruncatedMesh) {
  mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2", {"m.obj"});
  mesh("glTF\x02", {"m.glb"}, "m.glb");
  mesh(R"({"asset": {"version": "2.0"}, "meshes": [)", {"m.gltf"}, "m.gltf");
}

TEST_F(CliBadScene, VerticesAndIndices) {
  mesh("v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", {"m.obj"});
  mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n", {"m.obj", "7"});
  mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\n", {"m.obj", "triangle"});
}

TEST_F(CliBadScene, ATextureThatIsNoImage) {
  writeText(folder / "t.png", "no image at all");
  writeText(folder / "m.mtl", "newmtl a\nKd 1 1 1\nmap_Kd t.png\n");
  mesh("mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n", {"t.png"});
}

TEST_F(CliBadScene, SceneFiles) {
  const auto scene = [&](const std::string& rest, const std::vector<std::string>& parts) {
    writeText(folder / "m.obj", triangle);
    writeText(folder / "s.json", R"({"version": 1, "mesh": "m.obj", )" + rest + "}");
    refused("s.json", parts);
  };
  scene(R"("sky": "blue")", {"s.json", "sky"});
  scene(R"("skye": 1)", {"s.json", "skye", "sky"});
  scene(R"("sky": -1)", {"s.json", "sky", "-1"});
  scene(R"("sky": )", {"s.json", "JSON"});
}

TEST_F(CliBadScene, OddOnesRender) {
  const auto renders = [&](const std::string& name) {
    const CliResult r =
        runCli({"render", folder / name, "--resolution", "16x9", "--set", "lightmap.resolution=32", "--json"});
    EXPECT_EQ(r.code, 0) << name << ": " << r.err;
    if (r.code != 0) return;
    EXPECT_EQ(json::parse(r.out).at("counters").at("nan_inf"), 0) << name;
  };
  writeText(folder / "m.obj", triangle);
  renders("m.obj");
  writeText(folder / "dark.json", R"({"version": 1, "mesh": "m.obj", "lights": []})");
  renders("dark.json");
  writeText(folder / "empty.json", R"({"version": 1, "sky": 1, "shapes": []})");
  renders("empty.json");
}

}  // namespace
}  // namespace hl::test
