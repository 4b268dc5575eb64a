#include "engine/experiment/experiment.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/experiment/preset_schema.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

const std::string kBase = R"({"version": 1, "scene": "cornell_box", "technique": "radiosity", "parameters": {"radiosity.samples": 32, "lightmap.dilation": 1}})";

std::string with(const std::string& rest) { return R"({"version": 1, "base": )" + kBase + (rest.empty() ? "" : ", " + rest) + "}"; }

Experiment read(const std::string& rest) { return experimentFromJson(with(rest), "e.json"); }

std::string refusal(const std::string& text) {
  try {
    experimentFromJson(text, "e.json");
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::BadInput);
    EXPECT_EQ(std::string(e.what()).rfind("e.json", 0), 0u) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "was accepted: " << text;
  return {};
}

void expectRefusal(const std::string& rest, const std::string& part) {
  const std::string message = refusal(with(rest));
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

using Values = std::vector<std::string>;

TEST(Experiment, DefaultsAreOneRunOfTheBase) {
  const Experiment e = read("");
  const auto c = configurationsOf(e);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_EQ(presetHash(c[0].preset), presetHash(e.base));
  EXPECT_EQ(c[0].label(), "radiosity");
  EXPECT_EQ(e.seeds, std::vector<uint32_t>{1});
  EXPECT_EQ(e.stop.kind, StopRule::Kind::Settled);
  EXPECT_EQ(e.metrics, Values{"relmse"});
  EXPECT_EQ(e.references, (Values{"matched", "full"}));
}

TEST(Experiment, ListsAndRangesMakeAllCombinations) {
  const Experiment e = read(R"("permute": {"radiosity.samples": {"from": 1, "to": 100, "count": 3, "log": true}, "radiosity.residual": {"from": 0, "to": 0.5, "count": 3},
      "resolution": [[64, 48], [32, 24]], "camera": "front"}, "seeds": {"from": 5, "count": 3}, "repeats": 2)");
  ASSERT_EQ(e.permute.size(), 1u);
  std::map<std::string, Values> axes;
  for (const PermuteAxis& a : e.permute[0]) axes[a.key] = a.values;
  EXPECT_EQ(axes["radiosity.samples"], (Values{"1", "10", "100"}));
  EXPECT_EQ(axes["radiosity.residual"], (Values{"0", "0.25", "0.5"}));
  EXPECT_EQ(axes["resolution"], (Values{"64x48", "32x24"}));
  EXPECT_EQ(axes["camera"], (Values{"front"}));
  EXPECT_EQ(e.seeds, (std::vector<uint32_t>{5, 6, 7}));
  const auto all = configurationsOf(e);
  ASSERT_EQ(all.size(), 18u);
  bool found = false;
  for (const Configuration& c : all)
    found |= c.preset.parameters.at("radiosity.samples") == "10" && c.preset.parameters.at("radiosity.residual") == "0.25" && c.preset.width == 32 &&
             c.preset.height == 24 && c.preset.cameraName == "front" && c.preset.parameters.at("lightmap.dilation") == "1";
  EXPECT_TRUE(found);
}

TEST(Experiment, TheTimeAtWhichARunStartsIsVaried) {
  const Experiment e = experimentFromJson(R"({"version": 1, "base": {"version": 1, "scene": "sponza", "technique": "none", "animation": {"play": true, "rate": 12, "camera_path": "flight"}},
      "permute": {"animation.start": [0, 14.1]}})", "e.json");
  for (const Experiment& x : {e, experimentFromJson(experimentJson(e), "again.json")}) {
    const auto c = configurationsOf(x);
    ASSERT_EQ(c.size(), 2u);
    EXPECT_EQ(c[0].preset.animation.start, 0);
    EXPECT_EQ(c[1].preset.animation.start, 14.1f);
    EXPECT_EQ(c[1].label(), "animation.start 14.1");
    EXPECT_TRUE(c[1].preset.animation.play);
    EXPECT_NE(presetHash(c[0].preset), presetHash(c[1].preset));
  }
  expectRefusal(R"("permute": {"animation.start": [-1]})", "out of range");
  expectRefusal(R"("permute": {"animation.stort": [1]})", "did you mean \"animation.start\"?");
}

TEST(Experiment, WholeNumbersAreRoundedAndCountOnce) {
  const Experiment e = read(R"("permute": {"radiosity.bounces": {"from": 1, "to": 4, "count": 9, "log": true}, "lightmap.dilation": [0, 1, 0]})");
  for (const PermuteAxis& a : e.permute[0]) {
    const Values wanted = a.key == "radiosity.bounces" ? Values{"1", "2", "3", "4"} : Values{"0", "1"};
    EXPECT_EQ(a.values, wanted) << a.key;
  }
  // The default spelt out is the same configuration as the default left out.
  const Experiment twice = read(R"("permute": [{"radiosity.samples": [32, 64]}, {"radiosity.samples": [64, 128]}])");
  EXPECT_EQ(configurationsOf(twice).size(), 3u);
}

TEST(Experiment, ATechniquesOwnAxesLeaveTheOthersSingle) {
  const auto c = configurationsOf(read(R"("permute": {"technique": ["none", "radiosity"], "radiosity.samples": [16, 64], "direct.samples": [4, 8]})"));
  ASSERT_EQ(c.size(), 6u) << "two of none, four of radiosity";
  size_t none = 0;
  for (const Configuration& x : c) {
    if (x.preset.technique != "none") continue;
    ++none;
    EXPECT_EQ(x.preset.parameters.count("radiosity.samples"), 0u) << "another technique's parameters go";
    EXPECT_EQ(x.preset.parameters.at("lightmap.dilation"), "1") << "shared ones stay";
    EXPECT_EQ(x.label().find("radiosity"), std::string::npos);
  }
  EXPECT_EQ(none, 2u);
  EXPECT_EQ(configurationsOf(read(R"("permute": [{"technique": "none"}, {"radiosity.samples": [16, 64]}])")).size(), 3u);
}

TEST(Experiment, RoundTrips) {
  const Experiment e = read(R"("permute": [{"technique": ["none"]}, {"radiosity.samples": [16, 64], "radiosity.residual": [0.1], "radiosity.lookup": ["nearest"], "radiosity.unweighted": [true],
      "resolution": [64, 48], "camera": ["a", "b"]}], "seeds": [3, 1], "metrics": ["bias", "relmse"], "references": ["full"], "targets": ["lightmap", "image"], "target_error": 0.05, "stop": {"ms": 12.5}, "repeats": 3, "limit_ms": 2500,
      "amortise_frames": 10, "path_tracer": false, "images": true)");
  const std::string text = experimentJson(e);
  const Experiment again = experimentFromJson(text, "again.json");
  EXPECT_EQ(experimentJson(again), text);
  EXPECT_EQ(again.stop, e.stop);
  EXPECT_EQ(again.seeds, e.seeds);
  EXPECT_FALSE(again.pathTracer);
  EXPECT_TRUE(again.images);
  EXPECT_EQ(again.repeats, 3);
  EXPECT_EQ(again.limitMs, 2500);
  EXPECT_EQ(again.amortiseFrames, 10);
  const auto a = configurationsOf(e), b = configurationsOf(again);
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(presetHash(a[i].preset), presetHash(b[i].preset));
}

TEST(Experiment, MistakesAreNamed) {
  expectRefusal(R"("permute": {"radiosity.sample": [1]})", "did you mean \"radiosity.samples\"?");
  expectRefusal(R"("permute": {"technique": ["none"], "radiosity.samples": [1]})", "technique none");
  expectRefusal(R"("permute": {"technique": ["radiosty"]})", "radiosity");
  expectRefusal(R"("permute": {"radiosity.samples": [0]})", "out of range [1, 4096]");
  expectRefusal(R"("permute": {"radiosity.samples": [1.5]})", "permute.\"radiosity.samples\"[0]: a whole number");
  expectRefusal(R"("permute": {"radiosity.samples": []})", "at least one value");
  expectRefusal(R"("permute": {"radiosity.samples": {"from": 1, "to": 9}})", "count");
  expectRefusal(R"("permute": {"radiosity.samples": {"from": 9, "to": 1, "count": 2}})", "less than");
  expectRefusal(R"("permute": {"radiosity.samples": {"from": 1, "to": 9000, "count": 2}})", "out of range");
  expectRefusal(R"("permute": {"radiosity.residual": {"from": 0, "to": 1, "count": 3, "log": true}})", "above 0");
  expectRefusal(R"("permute": {"radiosity.samples": {"from": 1, "to": 9, "count": 3, "steps": 2}})", "steps");
  expectRefusal(R"("permute": {"radiosity.lookup": {"from": 0, "to": 1, "count": 2}})", "has no range");
  expectRefusal(R"("permute": {"seed": [1, 2]})", "under \"seeds\"");
  expectRefusal(R"("permute": {"resolution": [[0, 4]]})", "out of range");
  expectRefusal(R"("permute": [])", "at least one object");
  expectRefusal(R"("permte": {})", "did you mean \"permute\"?");
  expectRefusal(R"("seeds": [1, 1])", "stands twice");
  expectRefusal(R"("seeds": [-1])", "out of range");
  expectRefusal(R"("seeds": {"from": 4294967295, "count": 2})", "above 4294967295");
  expectRefusal(R"("metrics": ["relmsee"])", "did you mean relmse?");
  expectRefusal(R"("references": ["half"])", "matched");
  expectRefusal(R"("targets": ["atlas"])", "lightmap");
  expectRefusal(R"("target_error": -1)", "target_error");
  expectRefusal(R"("stop": {})", "one of settled, frames and ms");
  expectRefusal(R"("stop": {"settled": true, "frames": 3})", "one of settled, frames and ms");
  expectRefusal(R"("stop": {"settled": false})", "true is wanted");
  expectRefusal(R"("stop": {"ms": 0})", "more than 0");
  expectRefusal(R"("stop": {"frames": 0})", "out of range");
  expectRefusal(R"("repeats": 0)", "out of range");
  EXPECT_NE(refusal(R"({"version": 2, "base": "x"})").find("newer"), std::string::npos);
  EXPECT_NE(refusal(kBase).find("this is a preset"), std::string::npos);
  EXPECT_NE(refusal(R"({"version": 1})").find("\"base\" is missing"), std::string::npos);
  EXPECT_NE(refusal(R"({"version": 1, "base": "cornell_radiosty"})").find("did you mean \"cornell_radiosity\"?"), std::string::npos);
  EXPECT_NE(refusal(R"({"version": 1, "base": "none/such.json"})").find("beside the experiment"), std::string::npos);
  EXPECT_NE(refusal(R"({"version": 1, "base": {"version": 1, "scene": "s", "sed": 1}})").find("did you mean \"seed\"?"), std::string::npos);
}

TEST(Experiment, TooManyRunsAreCountedAndRefused) {
  const std::string range = R"({"from": 1, "to": 4096, "count": 200})";
  expectRefusal(R"("permute": {"radiosity.samples": )" + range + R"(, "direct.samples": )" + range + R"(, "direct.lumel_samples": )" + range + "}",
                "8000000 configurations x 1 seeds x 1 repeats are 8000000 runs; 10000 at most");
  expectRefusal(R"("permute": {"radiosity.samples": )" + range + R"(}, "seeds": {"from": 1, "count": 60})", "12000 runs");
}

TEST(Experiment, ABasePathIsBesideTheExperimentOrInTheProgramsFolder) {
  const test::TemporaryFolder folder;
  Preset p;
  p.seed = 77;
  savePreset(p, folder / "mine.json");
  const auto file = folder / "e.json";
  EXPECT_EQ(experimentFromJson(R"({"version": 1, "base": "mine.json"})", file).base.seed, 77u);
  EXPECT_EQ(experimentFromJson(R"({"version": 1, "base": "mine.json"})", file).seeds, std::vector<uint32_t>{77}) << "the base's own seed";
  EXPECT_EQ(experimentFromJson(R"({"version": 1, "base": "presets/cornell_radiosity.json"})", file).base.scene, "cornell_box");
  EXPECT_EQ(experimentFromJson(R"({"version": 1, "base": "cornell_direct"})", file).base.technique, "none");
}

TEST(Experiment, TheShippedOnesCanBeReadAndAreNoPresets) {
  const auto all = listExperiments();
  ASSERT_FALSE(all.empty());
  for (const PresetListing& listing : all) EXPECT_NO_THROW(openExperiment(listing.id)) << listing.label;
  for (const PresetListing& listing : listPresets()) EXPECT_EQ(listing.label.find("cannot be read"), std::string::npos) << listing.id << listing.label;
}

TEST(ExperimentSchema, HasEveryKeyThatAnExperimentHas) {
  const auto schema = nlohmann::json::parse(fileSchema());
  const auto properties = schema["$defs"]["experiment"]["properties"];
  const auto written = nlohmann::json::parse(experimentJson(read(R"("permute": {"radiosity.samples": [1]})")));
  for (const auto& member : written.items()) EXPECT_TRUE(properties.contains(member.key())) << member.key();
  EXPECT_EQ(properties.size(), written.size());
  EXPECT_TRUE(schema["$defs"]["preset"]["properties"].contains("scene"));
}

}  // namespace
}  // namespace hl
