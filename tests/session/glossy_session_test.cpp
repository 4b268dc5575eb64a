// Glossy surfaces through the session: the reference's third image, its share of the picture, its errors; and a scene without them.
#include <algorithm>
#include <set>

#include "engine/metrics/metrics.h"
#include "tests/session_fixture.h"

namespace hl {
namespace {

using test::smallPreset;

class GlossySession : public test::SessionTest {
 protected:
  static std::set<std::string> componentsOf(const std::vector<ErrorValue>& errors, const std::string& reference) {
    std::set<std::string> out;
    for (const ErrorValue& e : errors)
      if (e.reference == reference) out.insert(e.component);
    return out;
  }
};

TEST_F(GlossySession, TheReferenceHasTheLobesLight) {
  auto session = makeSession();
  session->load(smallPreset("glossy_box", "none"));
  session->setImagesWanted({"specular", "reference_specular", "reference_matched_specular"});
  session->setReferenceWanted(true);
  const auto frame = session->settle();
  EXPECT_TRUE(frame->features.glossySurfaces);
  const Image lobes = session->image("reference_specular"), matched = session->image("reference_matched_specular");
  EXPECT_EQ(frame->images.at("reference_specular")->data, lobes.data);
  const auto result = session->currentReference();
  ASSERT_TRUE(result && result->glossy());
  EXPECT_EQ(result->nonFinite, 0u);
  // The picture is what falls on the surfaces, and what their lobes send.
  const Image whole = session->image("reference"), direct = session->image("reference_direct"), indirect = session->image("reference_indirect");
  const Image albedo = session->image("albedo"), emission = session->image("emission"), highlights = session->image("reference_direct_specular");
  size_t glossy = 0, diffuse = 0;
  for (size_t p = 0; p < whole.pixels(); ++p) {
    for (size_t c = 0; c < 3; ++c) {
      const size_t i = 3 * p + c;
      const float truth = emission.data[i] + (direct.data[i] + indirect.data[i]) * albedo.data[i] / kPi + lobes.data[i] + highlights.data[i];
      ASSERT_NEAR(whole.data[i], truth, 1e-5f * truth);
      EXPECT_EQ(matched.data[i], 0) << "none models no lobes";
    }
    (lobes.data[3 * p] > 0 ? glossy : diffuse)++;
  }
  EXPECT_GT(glossy, whole.pixels() / 10);
  EXPECT_GT(diffuse, whole.pixels() / 10);
  // Errors: all three against the full reference; no specular one where nothing is modelled.
  const auto errors = session->measureErrors({"relmse", "ssim", "bias"});
  EXPECT_EQ(componentsOf(errors, "full"), (std::set<std::string>{"indirect", "specular", "final"}));
  EXPECT_EQ(componentsOf(errors, "matched"), (std::set<std::string>{"indirect", "final"}));
  // Whoever has the frame's images measures the same: the mask is of pixels that see a glossy surface.
  ASSERT_TRUE(frame->glossy && frame->surfaces);
  EXPECT_LT(std::count(frame->glossy->begin(), frame->glossy->end(), 1), std::count(frame->surfaces->begin(), frame->surfaces->end(), 1));
  MeasureOptions overGlossy;
  overGlossy.mask = *frame->glossy;
  const double bias = measure("bias", *frame->images.at("specular"), *frame->references.at("reference_specular"), overGlossy).value;
  std::set<std::string> regions;
  for (const ErrorValue& e : errors)
    if (e.component == "specular") {
      EXPECT_TRUE(std::isfinite(e.value)) << e.metric;
      regions.insert(e.roi);
      // All of it is missing.
      if (e.metric == "bias") {
        if (e.reference == "full" && e.roi.empty()) {
          EXPECT_EQ(e.value, bias);
        }
        EXPECT_LT(e.value, 0);
      }
    }
  EXPECT_EQ(regions, (std::set<std::string>{"", "floor", "block"}));
  // An image that has no lobes is no picture of this scene.
  EXPECT_EQ(componentsOf(session->measureErrorsOf(session->image("indirect_irradiance"), {"relmse"}), "full"), (std::set<std::string>{"indirect"}));
  // The truth itself has no error but the noise's.
  const Image truth = session->image("reference_specular");
  for (const ErrorValue& e : session->measureErrorsOf(session->image("reference_indirect"), {"mse"}, &truth))
    if (e.reference == "full" && e.roi.empty()) {
      EXPECT_LT(std::abs(e.value), 2 * e.noiseFloor + 1e-12) << e.component;
    }
  for (const char* view : {"specular", "reference_specular", "indirect"}) {
    Display display;
    display.view = view;
    session->setDisplay(display);
    EXPECT_EQ(session->frame()->view, view);
  }
  std::set<std::string> flicker;
  for (const ErrorValue& e : session->measureFlicker(2)) {
    flicker.insert(e.component + " " + e.roi);
    EXPECT_EQ(e.value, 0) << e.component;
  }
  EXPECT_EQ(flicker.size(), 9u) << "three components, the whole picture and two regions";
  expectNoMessages(*session);
}

// The picture's highlights against the reference's: two implementations that share the lobe alone.
TEST_F(GlossySession, HighlightsAreTheReferences) {
  const std::string lamps = R"([{"type": "point", "name": "lamp", "position": [0.5, 1.5, 1], "intensity": 4}, {"type": "spot", "name": "spot", "position": [-0.5, 1.9, 0.5],
    "direction": [0.1, -1, 0], "intensity": 6, "inner_degrees": 20, "outer_degrees": 40}, {"type": "directional", "name": "sun", "direction": [0.2, -1, -0.6], "irradiance": 2}])";
  const auto scene = [&](const std::string& light) {
    return folder.write("scene.json", R"({"version": 1, "shapes": [
      {"type": "quad", "name": "floor", "material": "floor", "corners": [[-2, 0, 2], [2, 0, 2], [2, 0, -2], [-2, 0, -2]]},
      {"type": "box", "name": "block", "material": "block", "min": [-0.5, 0, -0.9], "max": [0.1, 0.7, -0.3]},
      {"type": "quad", "name": "panel", "material": "shining", "corners": [[-1.2, 0.2, -1.5], [1.2, 0.2, -1.5], [1.2, 1.2, -1.5], [-1.2, 1.2, -1.5]]}],
      "materials": {"floor": {"albedo": 0.3, "specular": 0.5, "roughness": 0.3}, "block": {"albedo": 0.2, "specular": 0.7, "roughness": 0.15}, "shining": {"albedo": 0.2)" +
                                        light + R"(,
      "cameras": [{"name": "view", "position": [0.3, 1.2, 2.5], "target": [0, 0.2, 0], "vertical_fov_degrees": 45}]})");
  };
  struct Case {
    const char* name;
    std::string light;
    double most;  ///< of the rms difference, as a share of the rms
  };
  for (const Case& c : {Case{"punctual", R"(}}, "lights": )" + lamps, 2e-3}, Case{"panel and sky", R"(, "emission": 5}}, "sky": 0.5)", 0.06}}) {
    auto session = makeSession();
    Preset preset = smallPreset(scene(c.light), "none");
    preset.parameters["direct.samples"] = preset.parameters["reference.direct_samples"] = "512";
    preset.parameters["reference.samples"] = "2";
    session->load(preset);
    session->settle();
    session->reference();
    const Image ours = session->image("direct_specular"), truth = session->image("reference_direct_specular");
    double difference = 0, square = 0, sum = 0, truthSum = 0;
    for (size_t i = 0; i < truth.data.size(); ++i) {
      const double a = static_cast<double>(ours.data[i]), b = static_cast<double>(truth.data[i]);
      ASSERT_TRUE(std::isfinite(a));
      difference += (a - b) * (a - b), square += b * b, sum += a, truthSum += b;
    }
    std::printf("%s: rms difference %.4f of the rms, means' ratio %.5f\n", c.name, std::sqrt(difference / square), sum / truthSum);
    EXPECT_GT(square, 0);
    EXPECT_LT(std::sqrt(difference / square), c.most) << c.name;
    EXPECT_NEAR(sum / truthSum, 1, 0.01) << c.name;
    expectNoMessages(*session);
  }
}

TEST_F(GlossySession, WithoutGlossySurfacesThereIsNothingOfIt) {
  auto session = makeSession();
  session->load(smallPreset("cornell_box", "none"));
  session->setReferenceWanted(true);
  session->setImagesWanted({"specular", "reference_specular"});
  const auto frame = session->settle();
  EXPECT_FALSE(frame->features.glossySurfaces);
  EXPECT_TRUE(frame->images.empty());
  EXPECT_FALSE(session->currentReference()->glossy());
  for (const PassTiming& p : frame->lastPasses)
    if (p.name == "gbuffer: specular") {
      EXPECT_EQ(p.skipped, "scene has no glossy surfaces");
    }
  for (const char* name : {"specular", "reference_specular", "reference_matched_specular"}) {
    try {
      session->image(name);
      ADD_FAILURE() << name;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("no glossy surfaces"), std::string::npos) << e.what();
    }
  }
  for (const ErrorValue& e : session->measureErrors({"relmse"})) EXPECT_NE(e.component, "specular");
  Display display;
  display.view = "reference_specular";
  session->setDisplay(display);
  EXPECT_NE(session->frame()->message.find("no glossy surfaces"), std::string::npos);
  expectNoMessages(*session);
}

}  // namespace
}  // namespace hl
