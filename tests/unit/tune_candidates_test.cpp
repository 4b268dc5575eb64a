// What the tuner tries, without a device.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/error.h"
#include "engine/experiment/open_target.h"
#include "engine/sweep/cost_model.h"
#include "engine/sweep/tune.h"

namespace hl {
namespace {

TuneOptions options() {
  TuneOptions o;
  o.base.technique = "radiosity";
  o.techniques = {"radiosity"};  // each technique has as many of its own
  o.base.parameters = {{"lightmap.dilation", "1"}};
  o.candidates = 12;
  return o;
}

double knob(const Preset& p, const char* key) {
  for (const ParamInfo* k : knobsOf(p.technique, {}))
    if (k->key() == key) return numberOf(p, *k);
  ADD_FAILURE() << key << " is no knob";
  return 0;
}

TEST(TuneCandidates, KnobsAreWhatChangesTheResult) {
  std::set<std::string> keys;
  for (const ParamInfo* k : knobsOf("radiosity", {"radiosity.bounces"})) keys.insert(k->key());
  EXPECT_TRUE(keys.count("radiosity.samples") && keys.count("lightmap.resolution"));
  EXPECT_FALSE(keys.count("radiosity.bounces")) << "fixed";
  EXPECT_FALSE(keys.count("radiosity.slice_ms")) << "live: how long a frame waits";
  EXPECT_FALSE(keys.count("radiosity.estimator")) << "of one value";
  EXPECT_FALSE(keys.count("reference.samples") || keys.count("direct.samples")) << "no technique's own";
  EXPECT_TRUE(knobsOf("none", {}).empty());
}

TEST(TuneCandidates, TheFirstAreTheDefaultsAndDrawsWithinTheirRanges) {
  const TuneOptions o = options();
  const std::vector<Preset> all = firstCandidates(o);
  EXPECT_EQ(all.size(), 13u) << "the base is the technique as it comes; the lowest corner; eleven draws";
  EXPECT_EQ(presetHash(all[0]), presetHash(o.base));
  std::set<std::string> hashes;
  double least = 1e9, most = 0;
  for (const Preset& p : all) {
    EXPECT_NO_THROW(checkParameters(p));
    EXPECT_EQ(p.parameters.at("lightmap.dilation"), "1");
    hashes.insert(presetHash(p));
    least = std::min(least, knob(p, "radiosity.samples")), most = std::max(most, knob(p, "radiosity.samples"));
  }
  EXPECT_EQ(hashes.size(), all.size());
  EXPECT_LE(least, 64) << "drawn by their logarithm";
  EXPECT_GE(most, 1024);
  const std::vector<Preset> again = firstCandidates(o);
  for (size_t i = 0; i < all.size(); ++i) EXPECT_EQ(presetHash(again[i]), presetHash(all[i]));
  TuneOptions other = o;
  other.seed = 2;
  EXPECT_NE(presetHash(firstCandidates(other).back()), presetHash(all.back()));
}

/// ms = 0.01 (resolution / 64)^2 samples: a law that the model holds exactly, seen through a few draws.
double law(const Preset& p) { return 0.01 * std::pow(knob(p, "lightmap.resolution") / 64, 2) * knob(p, "radiosity.samples"); }

TEST(TuneCandidates, TheCostModelFindsAProductOfKnobs) {
  TuneOptions o = options();
  o.candidates = 40;
  CostModel model("radiosity", knobsOf("radiosity", {}));
  const std::vector<Preset> all = firstCandidates(o);
  for (size_t i = 0; i + 8 < all.size(); ++i) model.add(all[i], law(all[i]));
  for (size_t i = all.size() - 8; i < all.size(); ++i) EXPECT_LT(std::abs(std::log(model.predict(all[i]) / law(all[i]))), 0.7) << i;
}

TEST(TuneCandidates, TheNextOnesAreChosenForTheBudget) {
  TuneOptions o = options();
  o.candidates = 20;
  o.budgetMs = 2;
  std::vector<Trial> trials;
  for (const Preset& p : firstCandidates(o)) {
    Trial t;
    t.preset = p, t.costMs = law(p), t.withinBudget = t.costMs <= o.budgetMs;
    t.error = {1 / t.costMs, 0, 1};
    trials.push_back(t);
  }
  size_t before = 0, after = 0;
  for (const Trial& t : trials) before += t.withinBudget;
  const std::vector<Preset> next = furtherCandidates(o, trials, 0);
  ASSERT_GE(next.size(), 10u);
  for (const Preset& p : next) after += law(p) <= o.budgetMs;
  EXPECT_GT(static_cast<double>(after) / static_cast<double>(next.size()), 0.6);
  EXPECT_LT(static_cast<double>(before) / static_cast<double>(trials.size()), 0.6) << "else this test shows nothing";
  std::set<std::string> known;
  for (const Trial& t : trials) known.insert(presetHash(t.preset));
  for (const Preset& p : next) EXPECT_TRUE(known.insert(presetHash(p)).second) << "never the same twice";
}

TEST(TuneCandidates, BadOptionsAreNamed) {
  const auto refusal = [](auto change) {
    TuneOptions o = options();
    change(o);
    try {
      Tuner(o, "nowhere");
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::BadInput);
      return std::string(e.what());
    }
    return std::string("was accepted");
  };
  EXPECT_NE(refusal([](TuneOptions& o) { o.budgetMs = 0; }).find("above 0 ms"), std::string::npos);
  EXPECT_NE(refusal([](TuneOptions& o) { o.metric = "relmsee"; }).find("relmse"), std::string::npos);
  EXPECT_NE(refusal([](TuneOptions& o) { o.techniques = {"radiosty"}; }).find("radiosity"), std::string::npos);
  EXPECT_NE(refusal([](TuneOptions& o) { o.reference = "half"; }).find("matched or full"), std::string::npos);
}

}  // namespace
}  // namespace hl
