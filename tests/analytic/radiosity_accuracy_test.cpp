// What the spine is for: radiosity on the Cornell box against the matched reference, within the bounds that the project sets itself.
#include <cstdio>

#include "tests/session_fixture.h"

namespace hl::test {
namespace {

TEST_F(SessionTest, CornellBoxIsWithinItsBounds) {
  auto session = makeSession();
  Preset preset;
  preset.scene = "cornell_box";
  preset.technique = "radiosity";
  preset.width = 160, preset.height = 90;
  preset.parameters = {{"lightmap.resolution", "256"}, {"radiosity.samples", "1024"}, {"radiosity.bounces", "64"}, {"reference.samples", "2048"}};
  session->load(preset);
  session->settle();
  session->reference();
  bool relmse = false, bias = false;
  for (const ErrorValue& e : session->measureErrors({"relmse", "bias"})) {
    if (e.reference != "matched" || e.component != "indirect" || !e.roi.empty()) continue;
    std::printf("%s %.3g, standard error %.2g, noise floor %.2g\n", e.metric.c_str(), e.value, e.standardError, e.noiseFloor);
    EXPECT_EQ(e.nonFinite, 0u);
    if (e.metric == "relmse") {
      relmse = true;
      // The estimate is free of the reference's variance, and may be off by its standard error: a tenth of the bound at most.
      EXPECT_LE(e.standardError, 1e-4);
      EXPECT_LE(e.value, 1e-3);
      EXPECT_GT(e.value, -3 * e.standardError);
    } else {
      bias = true;
      EXPECT_LE(e.standardError, 1e-3);
      EXPECT_LE(std::abs(e.value), 5e-3);
    }
  }
  EXPECT_TRUE(relmse && bias);
  expectNoMessages(*session);
}

/// The scene file as it is shipped: albedo 0.8 and emission 1 on every surface, so that everything shines with 1 / (1 - 0.8).
TEST_F(SessionTest, FurnaceSphereOfTheSceneFolder) {
  auto session = makeSession();
  Preset preset;
  preset.scene = "furnace_sphere_080";
  preset.technique = "none";
  preset.width = 64, preset.height = 36;
  preset.parameters = {{"reference.samples", "256"}};
  session->load(preset);
  session->settle();
  session->reference();
  const Image radiance = session->image("reference");
  double sum = 0;
  for (const float v : radiance.data) sum += static_cast<double>(v);
  EXPECT_NEAR(sum / static_cast<double>(radiance.data.size()), 5, 0.002 * 5);
  expectNoMessages(*session);
}

/// As shipped: a 4 m cube of albedo 0.5 with 10 000 W in it. Means over all surfaces, by area.
TEST_F(SessionTest, SmallEmitterBoxOfTheSceneFolder) {
  auto session = makeSession();
  Preset preset = smallPreset("small_emitter_box", "radiosity");
  preset.parameters["reference.samples"] = "512";
  preset.parameters["reference.direct_samples"] = "256";
  preset.parameters["radiosity.bounces"] = "64";
  session->load(preset);
  session->settle();
  const auto truth = session->reference("lightmap");
  const ReferenceImage direct = truth->directImage(), indirect = truth->indirectImage(kAllBounces);
  const std::vector<vec3> baked = session->technique().lightmapIrradiance();
  double area = 0, all = 0, bounced = 0, radiosity = 0;
  for (size_t i = 0; i < session->atlas()->lumels.size(); ++i) {
    const double a = static_cast<double>(session->atlas()->lumels[i].area);
    area += a;
    all += a * static_cast<double>(direct.mean.data[3 * i] + indirect.mean.data[3 * i]);
    bounced += a * static_cast<double>(indirect.mean.data[3 * i]);
    radiosity += a * static_cast<double>(baked[i].x);
  }
  EXPECT_NEAR(all / area, 208.333, 0.005 * 208.333);
  EXPECT_NEAR(bounced / area, 104.167, 0.005 * 104.167);
  EXPECT_NEAR(radiosity / area, 104.167, 0.01 * 104.167);
  expectNoMessages(*session);
}

}  // namespace
}  // namespace hl::test
