// Probes through the session: placed when a technique needs them, anew only where scene or probes.* changed; by hand; and their views.
#include <cmath>

#include "engine/session/probe_views.h"
#include "tests/session_fixture.h"

namespace hl {
namespace {

using test::smallPreset;
using ProbesSessionTest = test::SessionTest;

Preset quick() {
  Preset p = smallPreset("cornell_box", "srp");
  const std::pair<const char*, const char*> changed[] = {
      {"lightmap.resolution", "32"}, {"srp.sh_order", "1"}, {"srp.receiver_rays", "16"}, {"srp.probe_rays", "64"}, {"probes.placement", "manual"}};
  for (const auto& [key, text] : changed) p.parameters.insert_or_assign(key, std::string(text));
  return p;
}

size_t differing(const std::vector<unsigned char>& a, const std::vector<unsigned char>& b) {
  size_t n = 0;
  for (size_t i = 0; i + 3 < a.size(); i += 4) n += a[i] != b[i] || a[i + 1] != b[i + 1] || a[i + 2] != b[i + 2];
  return n;
}

TEST_F(ProbesSessionTest, PlacedOnceAndAnewOnlyWhereTheyChange) {
  auto session = makeSession();
  session->load(quick());
  const auto first = session->settle();
  ASSERT_TRUE(first->probes) << first->message;
  EXPECT_EQ(first->probes->count(), 27u);
  EXPECT_EQ(first->probes->insideGeometry, 0u);
  session->setParam("srp.sh_order", "2");
  EXPECT_EQ(session->frame()->probes, first->probes) << "a parameter of the technique alone";
  session->setParam("lightmap.resolution", "48");
  EXPECT_EQ(session->frame()->probes, first->probes) << "another lightmap";
  session->setParam("probes.placement", "grid");
  const auto grid = session->frame();
  EXPECT_NE(grid->probes, first->probes);
  EXPECT_GT(grid->probes->count(), 60u);
  // By hand, one of them inside the tall block: kept, counted and told of.
  session->setProbes(std::vector<vec3>{{0.278f, 0.4f, 0.1f}, {0.37f, 0.15f, 0.35f}});
  EXPECT_EQ(session->frame()->probes, grid->probes) << "of no use as long as they are placed by a grid";
  session->setParam("probes.placement", "manual");
  const auto own = session->frame();
  ASSERT_EQ(own->probes->count(), 2u) << own->message;
  EXPECT_EQ(own->probes->insideGeometry, 1u);
  EXPECT_EQ(session->preset().probes->size(), 2u);
  EXPECT_THROW(session->setProbes(std::vector<vec3>{{0, std::nanf(""), 0}}), Error);
  session->setProbes(std::nullopt);
  EXPECT_EQ(session->frame()->probes->count(), 27u);
  session->setTechnique("none");
  EXPECT_FALSE(session->frame()->probes);
  expectNoMessages(*session);
}

constexpr int kWidth = 240, kHeight = 180;

TEST_F(ProbesSessionTest, Views) {
  auto session = makeSession();
  Preset p = quick();
  p.width = kWidth, p.height = kHeight;
  p.probes = std::vector<vec3>{{0.278f, 0.4f, 0.1f}, {0.37f, 0.15f, 0.35f}};
  session->load(p);
  session->settle();
  const auto shown = [&](const char* view) {
    Display d;
    d.view = view;
    session->setDisplay(d);
    return session->frame();
  };
  const auto plain = shown("final"), balls = shown("probes"), coverage = shown("probe_coverage");
  // Two balls, one red in front of the block that it stands in; nothing else.
  EXPECT_GT(differing(plain->display, balls->display), 10u);
  EXPECT_LT(differing(plain->display, balls->display), 300u);
  size_t red = 0, uncovered = 0;
  for (size_t i = 0; i + 3 < balls->display.size(); i += 4) {
    red += balls->display[i] > 100 && balls->display[i + 1] < 60 && balls->display[i + 2] < 50 && plain->display[i] != balls->display[i];
    uncovered += coverage->display[i] == 214 && coverage->display[i + 1] == 39 && coverage->display[i + 2] == 140;
  }
  EXPECT_GT(red, 2u);
  EXPECT_GT(uncovered, 100u) << "two probes do not see all of the blocks";
  EXPECT_LT(uncovered, kWidth * kHeight / 2u);
  double area = 0, unseen = -1;
  for (const uvec3 t : session->scene().indices) {
    const auto& at = session->scene().positions;
    area += 0.5 * static_cast<double>(glm::length(glm::cross(at[t.y] - at[t.x], at[t.z] - at[t.x])));
  }
  for (const auto& [name, value] : plain->counters)
    if (name == "probes_unseen_area") unseen = value;
  EXPECT_NEAR(unseen, (1 - plain->probes->coverage) * area, 1e-4 * area);
  EXPECT_GT(unseen, 0);
  // The ball under a pixel is picked, and what the probe sees stays as it is.
  const CameraBasis basis = cameraBasis(plain->camera, static_cast<float>(kWidth) / kHeight);
  int x = -1, y = -1;
  for (int v = 0; v < kHeight && x < 0; ++v)
    for (int u = 0; u < kWidth; ++u)
      if (probeOnRay(std::span(p.probes->data(), 1), basis, pixelDirection(basis, static_cast<float>(u) + 0.5f, static_cast<float>(v) + 0.5f, kWidth, kHeight), 0.007f)) x = u, y = v;
  ASSERT_GE(x, 0);
  session->pick(x, y);
  const auto seen = shown("probe_seen");
  EXPECT_EQ(seen->pickedProbe, std::optional<uint32_t>(0));
  bool told = false;
  for (const auto& [name, text] : seen->pick.facts) told = told || (name == "probe" && text.find("1 of 2") == 0);
  EXPECT_TRUE(told);
  EXPECT_GT(differing(plain->display, seen->display), 600u);
  EXPECT_LT(differing(plain->display, seen->display), kWidth * kHeight * 3u / 4);
  session->setTechnique("none");
  Display d;
  d.view = "probes";
  EXPECT_THROW(session->setDisplay(d), Error);
  expectNoMessages(*session);
}

}  // namespace
}  // namespace hl
