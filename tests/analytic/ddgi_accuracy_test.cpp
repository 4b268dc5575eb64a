// The Cornell box, converged, against the matched reference.
#include <cmath>
#include <cstdio>

#include "tests/session_fixture.h"

namespace hl::test {
namespace {

TEST_F(SessionTest, CornellBoxIsWithinItsBounds) {
  auto session = makeSession();
  Preset preset;
  preset.scene = "cornell_box";
  preset.technique = "ddgi";
  preset.width = 64, preset.height = 48;
  preset.parameters = {{"reference.samples", "512"}, {"ddgi.rays", "64"}, {"ddgi.hysteresis", "0.9"}, {"ddgi.distance_texels", "8"}};
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
      EXPECT_LE(e.value, 3e-2);
    } else {
      bias = true;
      EXPECT_LE(std::abs(e.value), 3e-2);
    }
  }
  EXPECT_TRUE(relmse && bias);
  expectNoMessages(*session);
}

}  // namespace
}  // namespace hl::test
