// Surfels in the Cornell box against the matched reference, and over frames.
#include <cmath>

#include "tests/session_fixture.h"

namespace hl::test {
namespace {

class SurfelAccuracy : public SessionTest {
 protected:
  Preset box() const {
    Preset p;
    p.scene = "cornell_box";
    p.technique = "surfels";
    p.width = 160, p.height = 90;
    p.parameters = {{"surfels.max_surfels", "16384"}, {"surfels.radius_pixels", "2.5"},   {"surfels.ray_budget", "2"}, {"surfels.settle_frames", "300"},
                    {"reference.samples", "256"},     {"reference.direct_samples", "32"}, {"direct.samples", "16"}};
    return p;
  }
};

TEST_F(SurfelAccuracy, CornellBoxIsNearTheMatchedReference) {
  auto session = makeSession();
  session->load(box());
  const auto result = session->settle();
  EXPECT_TRUE(result->settled);
  expectNoMessages(*session);
  session->reference();
  int seen = 0;
  for (const ErrorValue& e : session->measureErrors({"relmse", "bias"})) {
    if (e.reference != "matched" || e.component != "indirect" || !e.roi.empty()) continue;
    std::printf("Cornell box, 160 x 90, %u frames: %s %.5f, standard error %.5f\n", result->frame, e.metric.c_str(), e.value, e.standardError);
    EXPECT_EQ(e.nonFinite, 0u);
    EXPECT_LT(std::abs(e.value), e.metric == "bias" ? 0.02 : 0.01) << e.metric;
    ++seen;
  }
  EXPECT_EQ(seen, 2);
  for (const auto& [name, value] : result->counters)
    if (name == "surfel_nan" || name == "surfel_inf" || name == "uncovered_pixels") {
      EXPECT_EQ(value, 0) << name;
    }
}

}  // namespace
}  // namespace hl::test
