// The Session as a person drives it: edits that fail leave it as it was, edits that undo each other give the same picture.
#include <chrono>
#include <cmath>
#include <set>

#include "engine/session/session_thread.h"
#include "engine/experiment/bundle.h"
#include "engine/experiment/open_target.h"
#include "engine/scene/scene_build.h"
#include "tests/session_fixture.h"
#include "tests/trace_scenes.h"

namespace hl::test {
namespace {

/// Runs `f` and returns the message of the Error it must throw.
template <class F>
std::string messageOf(F f, ErrorKind kind = ErrorKind::BadInput) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), kind);
    return e.what();
  }
  ADD_FAILURE() << "no error was thrown";
  return {};
}

TEST_F(SessionTest, BadEditsLeaveItAsItWas) {
  auto session = makeSession();
  session->load(smallPreset("cornell_box", "radiosity"));
  const std::string before = presetJson(session->preset(), true);
  const std::string hash = session->settle()->displayHash;
  EXPECT_NE(messageOf([&] { session->setParam("radiosity.sampels", "3"); }).find("radiosity.samples"), std::string::npos);
  EXPECT_NE(messageOf([&] { session->setParam("radiosity.samples", "99999"); }).find("4096"), std::string::npos);
  EXPECT_NE(messageOf([&] { session->setTechnique("radioisty"); }).find("radiosity"), std::string::npos);
  EXPECT_NE(messageOf([&] { session->setScene("no_such_scene"); }).find("no_such_scene"), std::string::npos);
  EXPECT_NE(messageOf([&] { session->setResolution(0, 10); }).find("0x10"), std::string::npos);
  EXPECT_NE(messageOf([&] { session->setCameraName("nowhere"); }).find("nowhere"), std::string::npos);
  Preset bad = session->preset();
  bad.parameters["lightmap.resolution"] = "3";
  EXPECT_NE(messageOf([&] { session->load(bad); }).find("lightmap.resolution"), std::string::npos);
  Display display;
  display.view = "fianl";
  EXPECT_NE(messageOf([&] { session->setDisplay(display); }).find("final"), std::string::npos);
  EXPECT_EQ(presetJson(session->preset(), true), before);
  EXPECT_EQ(session->settle()->displayHash, hash);
  expectNoMessages(*session);
}

TEST_F(SessionTest, AnEditAndItsUndoGiveTheSamePicture) {
  auto session = makeSession();
  session->load(smallPreset("cornell_box", "radiosity"));
  const std::string hash = session->settle()->displayHash;
  session->setParam("radiosity.bounces", "1");
  EXPECT_NE(session->settle()->displayHash, hash);
  session->setParam("radiosity.bounces", "8");
  EXPECT_EQ(session->settle()->displayHash, hash);
  session->setTechnique("none");
  const auto direct = session->settle();
  EXPECT_NE(direct->displayHash, hash);
  session->setTechnique("radiosity");
  EXPECT_EQ(session->settle()->displayHash, hash);
  expectNoMessages(*session);
}

TEST_F(SessionTest, LightsCanBeEditedAndAreKeptInThePreset) {
  auto session = makeSession();
  session->load(smallPreset("point_light_cube", "radiosity"));
  session->settle();
  const float before = meanOf(session->image("indirect_irradiance")).y;
  std::vector<PointLight> lights = session->scene().pointLights;
  ASSERT_EQ(lights.size(), 1u);
  lights[0].intensity = lights[0].intensity * 3.0f;
  session->setLights(lights, {}, {}, vec3(0));
  const auto result = session->settle();
  EXPECT_NEAR(meanOf(session->image("indirect_irradiance")).y, 3 * before, 3e-3f * before);
  ASSERT_TRUE(session->preset().lights);
  auto again = makeSession();
  again->load(presetFromJson(presetJson(session->preset()), "test"));
  EXPECT_EQ(again->settle()->displayHash, result->displayHash);
}

TEST_F(SessionTest, PassesThatHaveNothingToDoSayWhy) {
  auto session = makeSession();
  session->load(smallPreset("cornell_box", "none"));
  const auto result = session->settle();
  bool skipped = false;
  for (const PassStatistics& pass : result->passes) skipped |= !pass.skipped.empty();
  EXPECT_TRUE(skipped);
  EXPECT_GT(result->frameTime.medianMs, 0);
}

TEST_F(SessionTest, TheBakeStopsWhenCancelledAndGoesOnLater) {
  auto session = makeSession();
  Preset preset = smallPreset("cornell_box", "radiosity");
  session->load(preset);
  const std::string hash = session->settle()->displayHash;
  session->load(preset);
  const auto started = session->frame();
  ASSERT_LT(started->technique.done, 1.0);
  session->cancelWork();
  const auto stopped = session->frame();
  EXPECT_FALSE(stopped->technique.running);
  const double done = stopped->technique.done;
  EXPECT_EQ(session->frame()->technique.done, done);
  session->restartWork();
  EXPECT_EQ(session->settle()->displayHash, hash);
}

TEST_F(SessionTest, ReferenceIsCachedAndErrorsAreMeasuredAgainstIt) {
  Preset preset = smallPreset("cornell_box", "radiosity");
  auto session = makeSession();
  session->load(preset);
  session->settle();
  EXPECT_TRUE(session->measureErrors({"mse"}).empty());
  session->reference();
  const auto errors = session->measureErrors({"mse", "relmse"});
  ASSERT_FALSE(errors.empty());
  auto again = makeSession();
  again->load(preset);
  again->settle();
  again->reference();
  const auto second = again->measureErrors({"mse", "relmse"});
  ASSERT_EQ(errors.size(), second.size());
  for (size_t i = 0; i < errors.size(); ++i) EXPECT_EQ(errors[i].value, second[i].value) << errors[i].metric;
  // The lightmap has a truth of its own.
  session->reference("lightmap");
  const auto texels = session->measureErrors({"bias"}, "lightmap");
  ASSERT_EQ(texels.size(), 1u);
  EXPECT_LT(std::abs(texels[0].value), 0.03);
}

/// Every metric for the whole image and each region, of both components; a lightmap's by area, laid out as it lies.
TEST_F(SessionTest, EveryMetricIsMeasuredInEveryRegion) {
  Preset preset = smallPreset("cornell_box", "radiosity");
  auto session = makeSession();
  session->load(preset);
  session->settle();
  session->reference();
  std::vector<std::string> all;
  for (const MetricInfo& m : metricInfos()) all.emplace_back(m.id);
  const auto errors = session->measureErrors(all);
  const size_t regions = session->scene().regions.size();
  ASSERT_GE(regions, 2u);
  for (const std::string& metric : all)
    for (const char* component : {"indirect", "final"})
      for (const char* reference : {"matched", "full"}) {
        std::set<std::string> places;
        for (const ErrorValue& e : errors)
          if (e.metric == metric && e.component == component && e.reference == reference) {
            EXPECT_FALSE(std::isnan(e.value)) << metric;  // psnr is infinite where the reference's noise hides what error there is
            EXPECT_EQ(metricInfo(metric).squared, std::isfinite(e.noiseFloor)) << metric;
            EXPECT_EQ(metricInfo(metric).windowed, std::isnan(e.standardError)) << metric;
            places.insert(e.roi);
          }
        EXPECT_EQ(places.size(), regions + 1) << metric << " " << component << " " << reference;
      }
  // The map's mean over what counts is the value.
  for (const char* metric : {"ssim", "flip", "flip_hdr", "l_star_mse", "dfpr", "relmse"}) {
    const Image map = session->errorMap(metric, "matched");
    const Image position = session->image("normal");
    double sum = 0, count = 0;
    for (size_t i = 0; i < map.pixels(); ++i) {
      const float* n = &position.data[i * 3];
      if (n[0] == 0 && n[1] == 0 && n[2] == 0) continue;
      sum += static_cast<double>(map.data[i]), ++count;
    }
    for (const ErrorValue& e : errors)
      if (e.metric == metric && e.component == "indirect" && e.reference == "matched" && e.roi.empty()) {
        EXPECT_NEAR(sum / count, e.value, 1e-5 * std::fabs(e.value)) << metric;
      }
  }
  session->reference("lightmap");
  const auto texels = session->measureErrors(all, "lightmap");
  ASSERT_EQ(texels.size(), all.size());
  for (const ErrorValue& e : texels) EXPECT_TRUE(std::isfinite(e.value)) << e.metric;

  // The picture's metrics follow how it is shown; the others do not.
  Display display = preset.display;
  display.exposure = -2, display.toneMap = ToneMap::Aces;
  session->setDisplay(display);
  const auto dimmed = session->measureErrors(all);
  ASSERT_EQ(dimmed.size(), errors.size());
  for (size_t i = 0; i < errors.size(); ++i) {
    const std::string& m = errors[i].metric;
    const bool shown = m == "ssim" || m == "flip" || m == "l_star_mse" || m == "dfpr";
    EXPECT_EQ(shown, errors[i].value != dimmed[i].value) << m << " " << errors[i].component << " " << errors[i].roi;
  }
  display.errorMetric = "sparkle";
  EXPECT_THROW(session->setDisplay(display), Error);
}

/// The error views show the map of the metric that is asked for, and each looks different.
TEST_F(SessionTest, ErrorViewsShowTheChosenMetric) {
  Preset preset = smallPreset("cornell_box", "radiosity");
  auto session = makeSession();
  session->load(preset);
  session->settle();
  session->reference();
  std::set<std::string> pictures;
  for (const MetricInfo& m : metricInfos()) {
    preset.display.view = "error", preset.display.errorMetric = m.id;
    session->setDisplay(preset.display);
    pictures.insert(session->frame()->displayHash);
  }
  // psnr's map is mse's.
  EXPECT_EQ(pictures.size(), metricInfos().size() - 1);
}

/// A lightmap that is done does not flicker, and neither does no indirect light; what a step of the light leaves has an end.
TEST_F(SessionTest, FlickerAndStepResponse) {
  auto session = makeSession();
  for (const char* technique : {"radiosity", "none"}) {
    session->load(smallPreset("point_light_cube", technique));
    session->settle();
    const auto flicker = session->measureFlicker(5);
    ASSERT_GE(flicker.size(), 2u);
    for (const ErrorValue& e : flicker) {
      EXPECT_EQ(e.value, 0) << technique << " " << e.component;
      EXPECT_EQ(e.metric, "flicker");
    }
    const StepReport step = session->measureStep(parseStep("lights=0.25"), 1000);
    if (std::string(technique) == "none") {
      EXPECT_EQ(step.size, 0);
      continue;
    }
    EXPECT_GT(step.size, 0);
    ASSERT_TRUE(step.frames5 && step.frames1 && step.ms1);
    EXPECT_TRUE(step.settled);
    EXPECT_LE(*step.frames5, *step.frames1);
    EXPECT_NEAR(step.left.front(), 0.25 / 0.75, 1e-6) << "the first frame is drawn before the bake has begun again, without indirect light";
    EXPECT_EQ(step.left.back(), 0) << "the same bake as the one before";
  }
  EXPECT_THROW(session->measureFlicker(1), Error);
  for (const char* bad : {"lights", "=1", "lights=", "lights=-1", "lights=nan", "lights=1", "lights=2x"}) EXPECT_THROW(parseStep(bad), Error) << bad;
  EXPECT_THROW(session->checkStep(parseStep("radiosity.nothing=1")), Error);
  session->load(smallPreset("cornell_box", "none"));
  EXPECT_THROW(session->checkStep(parseStep("lights=2")), Error);  // lit by a surface alone
}

/// A reference that was left half-way is found again by the next session, and one that is done outlives what does not concern it.
TEST_F(SessionTest, FramesCarryTheImagesThatWereAskedFor) {
  auto session = makeSession();
  session->load(smallPreset("cornell_box", "radiosity"));
  EXPECT_TRUE(session->frame()->images.empty());
  EXPECT_THROW(session->setImagesWanted({"finall"}), Error);
  const std::vector<std::string> names = {"final", "indirect_irradiance", "reference", "reference_matched", "reference_matched_indirect"};
  session->setImagesWanted(names);
  const auto early = session->frame();
  EXPECT_EQ(early->images.size(), 2u);  // no reference yet
  session->setReferenceWanted(true);
  const auto frame = session->settle();
  ASSERT_EQ(frame->images.size(), names.size());
  for (const std::string& name : names) {
    ASSERT_TRUE(frame->images.at(name));
    EXPECT_EQ(frame->images.at(name)->channels, 3);
    EXPECT_EQ(frame->images.at(name)->data, session->image(name).data) << name;
  }
  // Two bounces are darker than all of them.
  double matched = 0, full = 0;
  for (const float v : frame->images.at("reference_matched")->data) matched += v;
  for (const float v : frame->images.at("reference")->data) full += v;
  EXPECT_LT(matched, full);
  EXPECT_GT(matched, 0.5 * full);
  // With what comes beside them, anyone finds the session's own errors.
  int compared = 0;
  for (const ErrorValue& e : session->measureErrors({"relmse"})) {
    if (e.component == "indirect" && e.reference == "full") continue;  // its image was not asked for
    const std::string truth = e.component == "indirect" ? "reference_matched_indirect" : e.reference == "matched" ? "reference_matched" : "reference";
    if (!e.roi.empty()) continue;
    const Image& shown = *frame->images.at(e.component == "indirect" ? "indirect_irradiance" : "final");
    const double found = measure("relmse", shown, *frame->references.at(truth), *frame->surfaces).value;
    EXPECT_NEAR(found, e.value, 1e-6 * e.value) << truth;  // the device composes the final picture, and rounds otherwise
    ++compared;
  }
  EXPECT_EQ(compared, 3);
  // A reference's image is made once, as long as it stays the same.
  EXPECT_EQ(session->frame()->images.at("reference"), frame->images.at("reference"));
  session->setTechnique("none");
  EXPECT_NO_THROW(session->frame());
  expectNoMessages(*session);
}

TEST_F(SessionTest, ErrorsAreMeasuredForRegionsThatWereSet) {
  auto session = makeSession();
  session->load(smallPreset("cornell_box", "radiosity"));
  session->setReferenceWanted(true);
  session->settle();
  const std::vector<Region> bad[] = {{{"a", 0.5f, 0, 0.6f, 1}}, {{"a", 0, 0, 0, 1}}, {{"", 0, 0, 1, 1}}, {{"a", 0, 0, 1, 1}, {"a", 0, 0, 1, 1}}, {{"a", -0.1f, 0, 1, 1}}};
  for (const std::vector<Region>& regions : bad) EXPECT_THROW(session->setRegions(regions), Error);
  const size_t own = session->scene().regions.size();
  EXPECT_GT(own, 0u);
  session->setRegions(std::vector<Region>{{"left", 0, 0, 0.5f, 1}, {"all", 0, 0, 1, 1}});
  const auto frame = session->frame();
  ASSERT_EQ(frame->scene->regions.size(), 2u);
  std::map<std::string, double> relmse;
  for (const ErrorValue& e : frame->errors)
    if (e.metric == "relmse" && e.component == "indirect" && e.reference == "full") relmse[e.roi] = e.value;
  ASSERT_EQ(relmse.size(), 3u);
  EXPECT_EQ(relmse["all"], relmse[""]);
  EXPECT_NE(relmse["left"], relmse[""]);
  session->setRegions(std::vector<Region>{});
  const auto without = session->frame();
  EXPECT_FALSE(without->errors.empty());
  for (const ErrorValue& e : without->errors) EXPECT_EQ(e.roi, "");
  // Kept in the preset; without them the scene's own are there.
  EXPECT_TRUE(session->preset().regions.has_value());
  session->setRegions(std::nullopt);
  EXPECT_EQ(session->frame()->scene->regions.size(), own);
  EXPECT_FALSE(session->preset().regions.has_value());
}

TEST_F(SessionTest, AReferenceLeftHalfWayGoesOnLater) {
  Preset preset = smallPreset("cornell_box", "radiosity");
  preset.parameters["reference.samples"] = "262144";
  double done = 0;
  {
    auto session = makeSession();
    session->load(preset);
    session->settle();
    session->setReferenceWanted(true);
    const auto start = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - start < std::chrono::seconds(9)) done = session->frame()->reference.done;
    ASSERT_GT(done, 0);
    ASSERT_LT(done, 1);
    // Neither fewer bounces nor another technique and back ask for a new one.
    session->setParam("radiosity.bounces", "3");
    EXPECT_GE(session->frame()->reference.done, done);
    session->setTechnique("none");
    EXPECT_GE(session->frame()->reference.done, 0.5 * done);  // of two runs, where the technique wants one of its own
    expectNoMessages(*session);
  }
  auto again = makeSession();
  again->load(preset);
  again->settle();
  again->setReferenceWanted(true);
  const auto first = again->frame();
  EXPECT_GT(first->reference.done, 0.5 * done);  // whole passes are kept
}

/// A value near the given one that the parameter also takes.
std::string anotherValue(const ParamInfo& info, ParamValue value) {
  if (info.type == ParamType::Float) {
    const double now = static_cast<double>(std::get<float>(value)), doubled = now > 0 ? 2 * now : 0.1 * info.softMax;
    return formatParam(info, static_cast<float>(doubled <= info.max ? doubled : 0.5 * now));
  }
  const int32_t now = std::get<int32_t>(value);
  if (info.type == ParamType::Bool) return formatParam(info, 1 - now);
  if (info.type == ParamType::Enum) return formatParam(info, (now + 1) % static_cast<int32_t>(info.values.size()));
  return formatParam(info, now + 1 <= static_cast<int32_t>(info.max) ? now + 1 : now - 1);
}

/// What an edit leaves is what a preset of it loads: for every parameter, whatever is derived from it.
TEST_F(SessionTest, EveryParameterEditedEqualsThePresetOfIt) {
  auto edited = makeSession(), loaded = makeSession();
  Preset preset = smallPreset("cornell_box", "radiosity");
  preset.width = 24, preset.height = 18;
  preset.parameters["lightmap.resolution"] = "32";
  preset.parameters["radiosity.samples"] = "64";
  edited->load(preset);
  edited->settle();
  size_t tried = 0;
  std::vector<std::string> keys;
  for (const ParamView& group : edited->params().views())
    for (const ParamInfo& info : group.infos())
      if (info.group != "reference") keys.push_back(info.key());  // that one changes no picture
  for (const std::string& key : keys) {
    const auto [view, info] = edited->params().find(key);
    const std::string before = formatParam(*info, view->get(*info)), other = anotherValue(*info, view->get(*info));
    if (other == before) continue;
    edited->setParam(key, other);
    const std::string hash = edited->settle()->displayHash;
    loaded->load(edited->preset());
    EXPECT_EQ(loaded->settle()->displayHash, hash) << key << " = " << other;
    edited->setParam(key, before);
    ++tried;
  }
  EXPECT_GT(tried, 10u);
}

/// A setting that this device has no room for ends the technique and nothing else.
TEST_F(SessionTest, WhatDoesNotFitIsSaidAndTheSessionGoesOn) {
  auto session = makeSession();
  Preset preset = smallPreset("cornell_box", "radiosity");
  session->load(preset);
  const std::string hash = session->settle()->displayHash;
  session->setResolution(8192, 8192);
  EXPECT_FALSE(messageOf([&] { session->frame(); }, ErrorKind::TooLarge).empty());
  session->setResolution(preset.width, preset.height);
  EXPECT_EQ(session->settle()->displayHash, hash);
}

/// The tracers keep what they need of a scene with alpha tests: a session moves its buffers about while it loads.
TEST_F(SessionTest, CutOutsLookTheSameThroughEveryTracer) {
  Scene scene = foliage();
  scene.sky = vec3(1.0f);
  finishScene(scene);
  Preset preset = smallPreset("leaves", "radiosity");
  writeBundle(folder / "leaves.hlb", {preset, {{"leaves", &scene}}, {}});
  std::optional<double> expected;
  for (const char* tracer : {"embree", "bvh", "auto"}) {
    auto session = makeSession(tracer);
    session->load(openTarget((folder / "leaves.hlb").string()));
    session->load(session->preset());  // again, with an old scene to give up
    session->settle();
    const Image final = session->image("final");
    double sum = 0;
    for (size_t i = 0; i < final.pixels(); ++i) sum += static_cast<double>(final.data[i * static_cast<size_t>(final.channels) + 1]);
    ASSERT_TRUE(std::isfinite(sum)) << tracer;
    ASSERT_GT(sum, 0) << tracer;
    if (!expected) expected = sum;
    EXPECT_NEAR(sum, *expected, 2e-3 * *expected) << tracer;
    expectNoMessages(*session);
  }
}

}  // namespace
}  // namespace hl::test
