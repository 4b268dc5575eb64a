// What a rebuild takes is said before it: counts are those that then happen, times those of a device that has done such work before.
#include <cmath>

#include "engine/session/work_rates.h"
#include "tests/session_fixture.h"

namespace hl::test {
namespace {

double counterOf(const FrameResult& f, const std::string& name) {
  for (const auto& [key, value] : f.counters)
    if (key == name) return value;
  ADD_FAILURE() << "no counter " << name;
  return -1;
}

class RebuildForecastTest : public SessionTest {
 protected:
  /// The session's own validation messages are looked at in other tests of the same passes: here they would be measured.
  std::unique_ptr<Session> quietSession() { return std::make_unique<Session>(SessionOptions{}); }

  /// All that the forecast promises and that then is: preparation and work.
  static double forecastSeconds(const RebuildForecast& f) {
    double sum = 0;
    for (const auto& [name, seconds] : f.parts) sum += seconds;
    return sum;
  }
  std::shared_ptr<const FrameResult> apply(Session& session, const std::map<std::string, std::string>& changes) {
    for (const auto& [key, text] : changes) session.setParam(key, text);
    session.finishWork();
    return session.frame();
  }
  /// Within a factor of three, of three tries: others work on this machine too.
  void expectTime(Session& session, const std::string& key, const std::vector<std::string>& values) {
    double nearest = 1e9;
    for (const std::string& value : values) {
      const RebuildForecast f = session.forecastRebuild({{key, value}});
      const auto frame = apply(session, {{key, value}});
      const double taken = (frame->prepareMs + frame->workMs) / 1000, said = forecastSeconds(f);
      EXPECT_EQ(f.basis, ForecastBasis::Measured);
      nearest = std::min(nearest, std::max(said / taken, taken / said));
      if (nearest < 3) return;
    }
    ADD_FAILURE() << "said and taken differ by a factor of " << nearest << " at least";
  }
};

Preset srpPreset() {
  Preset p = smallPreset("cornell_box", "srp");
  p.parameters["srp.sh_order"] = "3";
  p.parameters["srp.receiver_rays"] = "128";
  p.parameters["srp.probe_rays"] = "256";
  return p;
}

TEST_F(RebuildForecastTest, RaysAndBytesOfSrpAreThoseThatHappen) {
  const auto session = quietSession();
  session->load(srpPreset());
  EXPECT_TRUE(session->forecastRebuild({{"srp.sh_order", "4"}}).rebuilds);
  EXPECT_LT(session->forecastRebuild({{"srp.sh_order", "4"}}).seconds, 0) << "nothing stands yet";
  session->finishWork();
  session->frame();

  struct Case {
    std::map<std::string, std::string> changes;
    double bytesFactor;
  };
  // Compressed matrices may be of lower rank than pca_vectors.
  const std::vector<Case> cases = {{{{"srp.sh_order", "4"}, {"srp.k", "5"}}, 1.02},
                                   {{{"probes.spacing", "0.4"}, {"srp.pca_vectors", "8"}, {"srp.storage", "float16"}}, 1.02},
                                   {{{"srp.compression", "none"}, {"srp.support", "probe_radius"}, {"srp.radius", "0.5"}}, 1.001}};
  for (const Case& c : cases) {
    const RebuildForecast f = session->forecastRebuild(c.changes);
    const std::string text = forecastText(f);
    SCOPED_TRACE(text);
    const auto frame = apply(*session, c.changes);
    EXPECT_TRUE(f.rebuilds);
    EXPECT_EQ(f.refused, "");
    EXPECT_EQ(f.anew.back(), "transport");
    EXPECT_EQ(f.anew.size(), c.changes.contains("probes.spacing") ? 2u : 1u);
    EXPECT_EQ(f.anew.front(), c.changes.contains("probes.spacing") ? "placement" : "transport");
    EXPECT_EQ(text.find(f.anew.front()), 0u) << text;
    const double probes = counterOf(*frame, "probes");
    EXPECT_EQ(f.work.rays, counterOf(*frame, "rays_cast") + 256 * probes);
    double matrices = 0, lumels = 0;
    for (const MemoryItem& m : frame->memory) {
      if (m.name == "srp: transport matrices") matrices += static_cast<double>(m.bytes);
      if (m.name == "srp: surfaces read") lumels += static_cast<double>(m.bytes);
    }
    EXPECT_GT(lumels, 0);
    EXPECT_GE(f.work.bytesMore, lumels - 4 * (counterOf(*frame, "receivers") + 1)) << "but for where each receiver's begin";
    EXPECT_GE(f.work.bytes + 4, matrices) << "but for padding to whole words";
    EXPECT_LE(f.work.bytes, c.bytesFactor * matrices);
    if (f.work.bytesBefore > 0) {
      EXPECT_EQ(f.work.bytesBefore, counterOf(*frame, "uncompressed_bytes"));
      EXPECT_NE(text.find("before compression"), std::string::npos);
    }
  }
  // Of another lightmap the receivers are not counted, but in proportion.
  const RebuildForecast larger = session->forecastRebuild({{"lightmap.resolution", "64"}});
  EXPECT_EQ(larger.anew, (std::vector<std::string>{"lightmap", "transport"}));
  const auto frame = apply(*session, {{"lightmap.resolution", "64"}});
  const double cast = counterOf(*frame, "rays_cast") + 256 * counterOf(*frame, "probes");
  EXPECT_GT(larger.work.rays, cast / 1.25);
  EXPECT_LT(larger.work.rays, cast * 1.25);
}

/// Radiance receivers have rows of their own in the matrices, and frames hold what those give.
TEST_F(RebuildForecastTest, RadianceReceiversAreCountedBeforehand) {
  Preset p = srpPreset();
  p.scene = "glossy_box";
  const auto session = quietSession();
  session->load(p);
  session->finishWork();
  session->frame();
  const std::map<std::string, std::string> changes = {{"srp.receivers", "radiance"}, {"srp.glossy_order", "3"}, {"srp.compression", "none"}};
  const RebuildForecast f = session->forecastRebuild(changes);
  SCOPED_TRACE(forecastText(f));
  const auto frame = apply(*session, changes);
  const auto bytesOf = [&](const std::string& name) {
    for (const MemoryItem& m : frame->memory)
      if (m.name == name) return static_cast<double>(m.bytes);
    ADD_FAILURE() << "no memory is called " << name;
    return 0.0;
  };
  EXPECT_EQ(f.work.bytes, bytesOf("srp: transport matrices"));
  EXPECT_EQ(f.work.bytesOfFrames, bytesOf("srp: radiance at glossy receivers"));
  EXPECT_GT(f.work.bytesOfFrames, 0);
  EXPECT_NE(forecastText(f).find("for its frames"), std::string::npos);
  EXPECT_EQ(f.work.rays, counterOf(*frame, "rays_cast") + 256 * counterOf(*frame, "probes"));
  // What would be refused for want of memory is known beforehand too, in the same words.
  const std::map<std::string, std::string> scarce = {{"srp.glossy_order", "8"}, {"srp.cluster_size", "8192"}, {"srp.least_clusters", "1"}, {"srp.precompute_memory_mb", "8"}};
  const RebuildForecast refused = session->forecastRebuild(scarce);
  EXPECT_NE(refused.refused.find("srp.precompute_memory_mb is 8"), std::string::npos) << refused.refused;
  EXPECT_EQ(apply(*session, scarce)->message, refused.refused);
}

/// What is wrong with probes by hand is said before the rebuild, in its words, also where nothing stands yet.
TEST_F(RebuildForecastTest, ProbesByHandAreLookedAtBeforehand) {
  using Hand = std::optional<std::vector<vec3>>;
  const std::map<std::string, std::string> byHand = {{"probes.placement", "manual"}};
  const auto session = quietSession();
  Preset p = srpPreset();
  session->load(p);
  for (const bool stands : {false, true}) {
    SCOPED_TRACE(stands);
    if (stands) session->finishWork(), session->frame();
    EXPECT_NE(session->forecastRebuild(byHand, Hand(std::vector<vec3>{})).refused.find("no probes of its own"), std::string::npos);
    EXPECT_NE(session->forecastRebuild(byHand, Hand(std::vector<vec3>{{0, 0, 0}, {NAN, 0, 0}})).refused.find("probe 2: nan is no place"), std::string::npos);
    EXPECT_NE(session->forecastRebuild({}, Hand(std::vector<vec3>{{0, 1e30f, 0}})).refused.find("probe 1"), std::string::npos);
    const RebuildForecast inside = session->forecastRebuild(byHand, Hand(std::vector<vec3>{{0.1f, 0.3f, 0.1f}, {0.186f, 0.08f, 0.169f}}));  // in the short block
    EXPECT_EQ(inside.refused, "");
    EXPECT_NE(forecastText(inside).find("1 of 2 manual ones stands inside geometry: number 2"), std::string::npos) << forecastText(inside);
    EXPECT_EQ(inside.seconds >= 0, stands);
  }
  const RebuildForecast f = session->forecastRebuild(byHand, Hand(std::vector<vec3>{}));
  session->setProbes(std::vector<vec3>{});
  EXPECT_EQ(apply(*session, byHand)->message, f.refused);
}

TEST_F(RebuildForecastTest, NothingChangesByAsking) {
  const auto session = quietSession();
  session->load(srpPreset());
  session->finishWork();
  const auto before = session->frame();
  EXPECT_FALSE(session->forecastRebuild({{"srp.least_valid", "0.7"}}).rebuilds) << "Live";
  EXPECT_FALSE(session->forecastRebuild({{"srp.window", "hann"}}).rebuilds) << "Reset";
  EXPECT_FALSE(session->forecastRebuild({{"srp.sh_order", "3"}}).rebuilds) << "as it is";
  EXPECT_THROW(session->forecastRebuild({{"srp.sh_order", "9"}}), Error);
  const std::string refused = session->forecastRebuild({{"srp.sh_order", "8"}, {"srp.probe_rays", "64"}}).refused;
  EXPECT_NE(refused.find("srp.probe_rays"), std::string::npos) << refused;
  EXPECT_NE(session->forecastRebuild({{"probes.placement", "manual"}}, std::optional<std::vector<vec3>>(std::vector<vec3>{})).refused, "");
  session->forecastRebuild({{"probes.spacing", "0.3"}});
  const auto after = session->frame();
  EXPECT_EQ(after->probes, before->probes);
  EXPECT_FALSE(after->technique.running);
  EXPECT_EQ(presetHash(after->preset), presetHash(before->preset));
}

TEST_F(RebuildForecastTest, WhatIsOnDiskIsNotCountedAgain) {
  Preset p = srpPreset();
  p.parameters["srp.cache"] = "true";
  const auto session = quietSession();
  session->load(p);
  session->finishWork();
  const RebuildForecast other = session->forecastRebuild({{"srp.k", "6"}});
  EXPECT_GT(other.work.parts.front().amount, 0);
  apply(*session, {{"srp.k", "6"}});
  const RebuildForecast back = session->forecastRebuild({{"srp.k", "8"}});
  EXPECT_EQ(back.work.parts.front().amount, 0);
  EXPECT_LT(forecastSeconds(back), forecastSeconds(other));
}

TEST_F(RebuildForecastTest, TimeOfSrpIsWithinAFactorOfThree) {
  const auto session = quietSession();
  session->load(srpPreset());
  session->finishWork();
  session->frame();
  expectTime(*session, "srp.receiver_rays", {"256", "384", "512"});
}

TEST_F(RebuildForecastTest, RadiosityCountsItsRaysAndItsTime) {
  Preset p = smallPreset("cornell_box", "radiosity");
  const auto session = quietSession();
  session->load(p);
  session->finishWork();
  session->frame();
  for (const std::string cache : {"512", "0"}) {
    const std::map<std::string, std::string> changes = {{"radiosity.samples", "512"}, {"radiosity.hit_cache_mb", cache}, {"radiosity.residual", "0"}, {"radiosity.bounces", "4"}};
    const RebuildForecast f = session->forecastRebuild(changes);
    SCOPED_TRACE(forecastText(f));
    const auto frame = apply(*session, changes);
    EXPECT_EQ(f.work.rays - f.work.parts.front().amount, counterOf(*frame, "rays_cast"));
    EXPECT_FALSE(f.work.atMost);
  }
  // Where bounces may end early, not by much.
  const RebuildForecast early = session->forecastRebuild({{"radiosity.residual", "0.001"}, {"radiosity.bounces", "32"}, {"radiosity.samples", "256"}});
  const auto frame = apply(*session, {{"radiosity.residual", "0.001"}, {"radiosity.bounces", "32"}, {"radiosity.samples", "256"}});
  EXPECT_TRUE(early.work.atMost);
  const double cast = counterOf(*frame, "rays_cast"), said = early.work.rays - early.work.parts.front().amount;
  EXPECT_GT(said, cast / 1.5);
  EXPECT_LT(said, cast * 1.5);
  expectTime(*session, "radiosity.samples", {"512", "768", "1024"});
}

TEST_F(RebuildForecastTest, EachRebuildIsToldAsItBegins) {
  const auto session = quietSession();
  std::vector<RebuildForecast> told;
  session->tellRebuilds([&](const RebuildForecast& f) { told.push_back(f); });
  session->load(srpPreset());
  session->finishWork();
  const auto frame = session->frame();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].work.rays, counterOf(*frame, "rays_cast") + 256 * counterOf(*frame, "probes"));
  EXPECT_EQ(told[0].basis, ForecastBasis::Calibrated) << "the cache folder is new";
  EXPECT_GT(told[0].seconds, 0);
  session->setParam("srp.k", "4");
  session->frame();
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[1].basis, ForecastBasis::Measured);
  expectNoMessages(*session);
}

TEST_F(RebuildForecastTest, SpeedsAreKeptAndTakenUpAgain) {
  {
    WorkRates rates("device");
    EXPECT_FALSE(rates.of("scene", "srp", "rays"));
    rates.learn("scene", "srp", "rays", 1e6, 500);
    rates.learn("scene", "srp", "rays", 10, 1);       // too short to replace anything
    rates.learn("scene", "srp", "sums", 0, 500);      // nothing was done
    rates.store();
  }
  const WorkRates again("device"), elsewhere("another");
  ASSERT_TRUE(again.of("scene", "srp", "rays"));
  EXPECT_DOUBLE_EQ(again.of("scene", "srp", "rays")->msPerAmount, 5e-4);
  EXPECT_TRUE(again.of("scene", "srp", "rays")->sameScene);
  ASSERT_TRUE(again.of("other scene", "srp", "rays"));
  EXPECT_FALSE(again.of("other scene", "srp", "rays")->sameScene);
  EXPECT_FALSE(again.of("scene", "srp", "sums"));
  EXPECT_FALSE(elsewhere.of("scene", "srp", "rays"));
  folder.write("work_rates.txt", "halflight work rates 1\nnonsense\n-1\tdevice|scene|srp|rays\nnan\tdevice|scene|srp|rays\n");
  EXPECT_FALSE(WorkRates("device").of("scene", "srp", "rays"));
  folder.write("work_rates.txt", "something else\n1\tdevice|scene|srp|rays\n");
  EXPECT_FALSE(WorkRates("device").of("scene", "srp", "rays"));
}

/// The threshold is Live, and so is the view that shows it.
TEST_F(RebuildForecastTest, ReceiverValidityFollowsItsThreshold) {
  const auto session = quietSession();
  Preset p = srpPreset();
  p.display.view = "receiver_validity";
  p.parameters["srp.least_valid"] = "0";
  session->load(p);
  session->finishWork();
  const auto redPixels = [&] {
    const auto frame = session->frame();
    int red = 0;
    for (size_t i = 0; i + 3 < frame->display.size(); i += 4) red += frame->display[i] > 150 && frame->display[i + 1] < 40 && frame->display[i + 2] < 40;
    return std::pair(red, counterOf(*frame, "invalid_receivers"));
  };
  const auto none = redPixels();
  EXPECT_EQ(none.first, 0);
  EXPECT_EQ(none.second, 0);
  session->setParam("srp.least_valid", "1");
  const auto all = redPixels();
  EXPECT_GT(all.second, 0);
  EXPECT_GT(all.first, 0);
  EXPECT_FALSE(session->frame()->technique.running);
}

/// One error, and it says who has to act: whoever drives the session prints it.
TEST_F(RebuildForecastTest, ARefusalSaysOfWhichKindItIs) {
  const auto session = quietSession();
  Preset p = srpPreset();
  p.parameters["srp.sh_order"] = "8";
  p.parameters["srp.probe_rays"] = "64";
  session->load(p);
  const auto frame = session->frame();
  EXPECT_TRUE(frame->techniqueFailed);
  EXPECT_EQ(frame->failure, ErrorKind::BadInput);
  EXPECT_NE(frame->message.find("srp.probe_rays"), std::string::npos);
}

}  // namespace
}  // namespace hl::test
