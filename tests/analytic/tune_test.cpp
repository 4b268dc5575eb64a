// The tuner on a tiny scene: what wins is within the budget, and no worse than what comes by itself.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "engine/sweep/tune.h"
#include "tests/session_fixture.h"

namespace hl::test {
namespace {

class TuneTest : public SessionTest {
 protected:
  TuneOptions tiny() const {
    TuneOptions o;
    o.base = smallPreset("cornell_box", "radiosity");
    o.base.width = 24, o.base.height = 18;
    o.base.parameters["lightmap.resolution"] = "32";
    o.base.parameters["radiosity.samples"] = "4";  // quick, and far from what the budget allows
    o.base.parameters["radiosity.bounces"] = "1";
    for (const char* key : {"lightmap.resolution", "radiosity.directions", "radiosity.unweighted", "radiosity.hit_cache_mb", "radiosity.residual"}) o.fixed.insert(key);
    o.budgetMs = 3000;
    o.candidates = 4;
    o.techniques = {"radiosity"};  // one: each more takes a minute
    return o;
  }
};

TEST_F(TuneTest, TheWinnerIsWithinTheBudgetAndNoWorseThanTheDefaults) {
  const TuneOptions o = tiny();
  const auto session = makeSession();
  Progress p;
  const TuneResult r = Tuner(o, folder / "out").run(*session, p);
  expectNoMessages(*session);
  const Trial* winner = r.winner();
  ASSERT_TRUE(winner);
  EXPECT_EQ(winner, &r.rungs.back().trials.front());
  EXPECT_LE(winner->costMs, o.budgetMs);
  EXPECT_EQ(winner->error.samples, 6) << "over seeds that no rung before has seen";
  bool base = false;
  for (const Trial& t : r.rungs.back().trials) {
    base |= presetHash(t.preset) == presetHash(o.base);
    if (t.withinBudget) {
      EXPECT_LE(winner->error.mean, t.error.mean) << t.label;
    }
  }
  EXPECT_TRUE(base) << "what the person has is compared to the end";
  for (const Rung& rung : r.rungs)
    for (const Trial& t : rung.trials)
      if (presetHash(t.preset) == presetHash(o.base)) {
        EXPECT_LT(winner->error.mean, 0.5 * t.error.mean) << "one bounce of four rays is easily beaten";
      }
  std::set<uint32_t> seeds;
  for (const Rung& rung : r.rungs)
    for (const uint32_t s : rung.seeds) EXPECT_TRUE(seeds.insert(s).second) << "seed " << s << " twice";

  const Preset best = loadPreset(folder / "out/best.json");
  Preset wanted = winner->preset;
  wanted.seed = o.base.seed;
  EXPECT_EQ(presetHash(best), presetHash(wanted));
  const auto document = nlohmann::json::parse(readFile(folder / "out/tune.json"));
  EXPECT_EQ(document.at("winner").at("label"), winner->label);
  EXPECT_EQ(document.at("rungs").size(), r.rungs.size());
  EXPECT_FALSE(openSweep(folder / "out" / r.rungs.back().folder).tracer.empty()) << "the path tracer at equal time";

  // The same command again makes no run, and says the same.
  size_t made = 0;
  Tuner again(o, folder / "out");
  again.onStatus = [&](const SweepStatus& s) { made += s.done < s.total; };
  const TuneResult same = again.run(*session, p);
  EXPECT_EQ(made, 0u);
  EXPECT_EQ(tuneJson(o, same), tuneJson(o, r));
}

TEST_F(TuneTest, WhereNothingFitsItSaysSo) {
  TuneOptions o = tiny();
  o.budgetMs = 0.01;
  o.candidates = 2;
  o.techniques.clear();  // all of them
  const auto session = makeSession();
  Progress p;
  const TuneResult r = Tuner(o, folder / "out").run(*session, p);
  EXPECT_FALSE(r.winner());
  EXPECT_FALSE(std::filesystem::exists(folder / "out/best.json"));
  EXPECT_NE(readFile(folder / "out/tune.md").find("Nothing that was tried"), std::string::npos);
  for (const Trial& t : r.rungs.front().trials) EXPECT_GT(t.costMs, o.budgetMs) << "how far off it is";

  // What took too long has no cause that could be mended: it is not tried again.
  size_t made = 0;
  Tuner again(o, folder / "out");
  again.onStatus = [&](const SweepStatus& s) { made += s.done < s.total; };
  EXPECT_EQ(tuneJson(o, again.run(*session, p)), tuneJson(o, r));
  EXPECT_EQ(made, 0u);
}

}  // namespace
}  // namespace hl::test
