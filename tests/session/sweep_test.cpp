// A sweep as a class, without a program round it: order, taking up, failures, cancellation, another machine's runs.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "engine/core/image_io.h"
#include "engine/sweep/cost_slopes.h"
#include "engine/sweep/results_folder.h"
#include "engine/sweep/sweep.h"
#include "tests/session_fixture.h"

namespace hl::test {
namespace {

class SweepTest : public SessionTest {
 protected:
  Experiment tiny(const std::string& rest) const {
    const std::string base = R"({"version": 1, "scene": "cornell_box", "resolution": [32, 24], "technique": "radiosity", "parameters": {"reference.samples": 64,
        "reference.direct_samples": 4, "direct.samples": 4, "direct.lumel_samples": 4, "lightmap.resolution": 32, "radiosity.samples": 16, "radiosity.bounces": 3}})";
    return experimentFromJson(R"({"version": 1, "base": )" + base + ", " + rest + "}", folder / "e.json");
  }
  std::map<std::string, std::string> files(const std::filesystem::path& at) const {
    std::map<std::string, std::string> out;
    for (const auto& entry : std::filesystem::directory_iterator(at)) out[entry.path().filename()] = readFile(entry.path());
    return out;
  }
};

TEST_F(SweepTest, RunsInterleavedAndTheFolderReadsBackTheSame) {
  const Experiment e = tiny(R"("permute": {"radiosity.samples": [4, 16]}, "seeds": [1, 2, 3], "repeats": 2)");
  Sweep sweep(e, folder / "out");
  std::vector<size_t> order;
  std::vector<std::string> doing;
  sweep.onRun = [&](const SweepResults&, size_t run) { order.push_back(run); };
  sweep.onStatus = [&](const SweepStatus& s) { doing.push_back(s.doing); };
  const auto session = makeSession();
  Progress p;
  sweep.run(*session, p);
  expectNoMessages(*session);
  const SweepResults& r = sweep.results();
  EXPECT_TRUE(r.complete());
  EXPECT_EQ(r.failed(), 0u);
  ASSERT_EQ(order.size(), 12u);
  for (size_t i = 0; i < order.size(); ++i) {
    EXPECT_EQ(order[i], i);
    EXPECT_EQ(r.plan[i].configuration, i % 2) << "all configurations once before the next seed";
    EXPECT_EQ(r.plan[i].seed, i / 2 % 3 + 1);
    EXPECT_EQ(r.plan[i].repeat, static_cast<int>(i / 6));
  }
  EXPECT_EQ(doing.front().find("reference of"), 0u) << "before anything is timed";
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(r.runs[i]->imageHash, r.runs[i + 6]->imageHash) << "a repeat is the same picture";
  EXPECT_NE(r.runs[0]->imageHash, r.runs[2]->imageHash) << "another seed is another";

  const Summary s = summarise(r);
  ASSERT_EQ(s.configurations.size(), 2u);
  for (const ConfigurationSummary& c : s.configurations) {
    EXPECT_EQ(c.runs, 6);
    EXPECT_EQ(c.errors.front().value.samples, 3) << "seeds, not runs";
    EXPECT_GT(c.totalMs.median, c.bakeMs());
    EXPECT_GT(c.frameMs.median, 0);
    EXPECT_GT(c.techniqueBytes, 0);
    ASSERT_EQ(c.parts.size(), 2u);
    EXPECT_GT(c.parts[0].variance.mean, 0);
    double mse = 0;
    for (const ErrorSummary& x : c.errors)
      if (x.reference == "matched" && x.metric == "mse" && x.component == "indirect" && x.roi.empty()) mse = x.value.mean;
    EXPECT_NEAR(c.parts[0].variance.mean + c.parts[0].biasSquared.mean, mse, 1e-9 * mse + 1e-12);
    ASSERT_FALSE(c.pathTracer.empty());
    EXPECT_GE(c.pathTracer[0].paths, 1);
    EXPECT_EQ(c.pathTracer[0].value.samples, 3);
  }
  EXPECT_GT(s.configurations[0].parts[0].variance.mean, s.configurations[1].parts[0].variance.mean) << "four times the rays, less noise";

  const SweepResults again = openSweep(folder / "out");
  EXPECT_TRUE(sweepCsv(again) == sweepCsv(r));
  EXPECT_TRUE(convergenceCsv(again) == convergenceCsv(r));
  EXPECT_TRUE(readFile(folder / "out/results.csv") == sweepCsv(r));
  EXPECT_TRUE(sweepJson(again, summarise(again)) == readFile(folder / "out/results.json"));
  const auto document = nlohmann::json::parse(readFile(folder / "out/results.json"));
  EXPECT_TRUE(document.at("complete").get<bool>());
  EXPECT_EQ(document.at("runs").size(), 12u);
  EXPECT_EQ(document.at("fronts").size(), 8u) << "four costs, two references";

  // The same again makes nothing; one more seed makes what is missing alone, and touches no other file.
  const auto before = files(folder / "out/runs");
  Sweep same(e, folder / "out");
  size_t made = 0;
  same.onRun = [&](const SweepResults&, size_t) { ++made; };
  same.run(*session, p);
  EXPECT_EQ(made, 0u);
  Experiment more = e;
  more.seeds.push_back(4);
  Sweep longer(more, folder / "out");
  longer.onRun = [&](const SweepResults&, size_t) { ++made; };
  longer.run(*session, p);
  EXPECT_EQ(made, 4u);
  const auto after = files(folder / "out/runs");
  for (const auto& [name, text] : before) EXPECT_TRUE(after.at(name) == text) << name;
}

TEST_F(SweepTest, RunsAreComparedWithOneOfTheirOwn) {
  const Experiment e = tiny(R"("permute": {"radiosity.samples": [4, 16, 9]}, "seeds": [1, 2], "metrics": ["mse", "bias"], "references": ["matched"], "path_tracer": false, "compare_with": {"radiosity.samples": 16})");
  const auto session = makeSession();
  Progress p;
  Sweep sweep(e, folder / "out");
  sweep.run(*session, p);
  expectNoMessages(*session);
  const SweepResults& r = sweep.results();
  ASSERT_EQ(r.failed(), 0u);
  ASSERT_EQ(r.plan.size(), 6u);
  EXPECT_EQ(r.plan[0].configuration, 1u) << "what others are compared with is made first";
  const auto errors = [](const RunRecord& run, const std::string& reference) {
    std::vector<double> out;
    for (const ErrorValue& v : run.errors)
      if (v.reference == reference && v.metric == "mse" && v.component == "indirect" && v.roi.empty()) out.push_back(v.value);
    return out;
  };
  for (size_t i = 0; i < r.plan.size(); ++i) {
    const std::vector<double> own = errors(*r.runs[i], "run");
    EXPECT_EQ(errors(*r.runs[i], "matched").size(), 1u);
    ASSERT_EQ(own.size(), r.plan[i].configuration == 1 ? 0u : 1u);
    if (own.empty()) continue;
    // By hand, from the two pictures.
    session->load(r.plan[i].preset);
    session->settle();
    const Image a = session->image("indirect_irradiance");
    const Image b = readImage(variancePictureOf(r.folder, r.plan[r.plan[i].seed == 1 ? 0 : 3]));
    ASSERT_EQ(r.plan[r.plan[i].seed == 1 ? 0 : 3].seed, r.plan[i].seed);
    double sum = 0;
    for (size_t k = 0; k < a.pixels(); ++k)
      for (size_t c = 0; c < 3; ++c) sum += std::pow(static_cast<double>(a.data[k * static_cast<size_t>(a.channels) + c]) - static_cast<double>(b.data[k * static_cast<size_t>(b.channels) + c]), 2) / 3;
    EXPECT_NEAR(own[0], sum / static_cast<double>(r.runs[i]->surfacePixels), 1e-5 * own[0]) << "where no surface is, both are 0";
    EXPECT_GT(own[0], 0);
  }
  const std::string report = sweepReport(r, summarise(r));
  EXPECT_NE(report.find("### Against the run with radiosity.samples 16"), std::string::npos);
  EXPECT_NE(sweepCsv(r).find(",run,image,indirect,mse,"), std::string::npos);
  EXPECT_TRUE(sweepCsv(openSweep(folder / "out")) == sweepCsv(r));

  // A picture that is gone is made again, by the run whose it is; compared with another, runs are others.
  std::filesystem::remove(variancePictureOf(r.folder, r.plan[0]));
  EXPECT_EQ(Sweep(e, folder / "out").results().done(), 5u);
  Experiment other = e;
  other.compareWith = {{"radiosity.samples", "9"}};
  EXPECT_EQ(Sweep(other, folder / "out").results().done(), 0u);

  const auto refused = [&](const std::string& with) {
    try {
      tiny(R"("permute": {"radiosity.samples": [4, 16]}, "compare_with": )" + with);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused(R"({"radiosity.samples": 5})").find("none of the runs is like"), std::string::npos);
  EXPECT_NE(refused(R"({"radiosity.samples": [4, 16]})").find("one value is wanted"), std::string::npos);
  EXPECT_NE(refused(R"({"camera": "front"})").find("different pictures"), std::string::npos);
  EXPECT_NE(refused(R"({"radiosity.sample": 4})").find("radiosity.samples"), std::string::npos);
}

TEST_F(SweepTest, LightmapErrorsTrafficSlopesAndTheCheapestWithinATarget) {
  const std::string base = R"({"version": 1, "scene": "cornell_box", "resolution": [32, 24], "technique": "srp", "parameters": {"reference.samples": 16, "reference.direct_samples": 4,
      "direct.samples": 4, "lightmap.resolution": 32, "probes.spacing": 0.5, "srp.receiver_rays": 64, "srp.probe_rays": 128, "srp.cache": false}})";
  const auto experiment = [&](const std::string& target) {
    return experimentFromJson(R"({"version": 1, "permute": [{"srp.sh_order": [0, 2, 4], "srp.compression": ["none"]}, {"srp.sh_order": [0], "srp.compression": ["cpca"]}],
      "metrics": ["relmse", "bias"], "references": ["matched"], "targets": ["image", "lightmap"], "path_tracer": false, "target_error": )" + target + R"(, "base": )" + base + "}", folder / "e.json");
  };
  Sweep sweep(experiment("1000"), folder / "out");
  const auto session = makeSession();
  Progress p;
  sweep.run(*session, p);
  expectNoMessages(*session);
  const SweepResults& r = sweep.results();
  ASSERT_EQ(r.failed(), 0u);
  EXPECT_GT(r.copyGbps, 0);
  // The lightmap's error is what the session measures: area-weighted over its own texels.
  session->load(r.plan[0].preset);
  session->settle();
  session->reference("lightmap");
  const std::vector<ErrorValue> own = session->measureErrors({"relmse"}, "lightmap");
  ASSERT_EQ(own.size(), 1u);
  int found = 0;
  for (const ErrorValue& e : r.runs[0]->errors)
    if (e.target == "lightmap" && e.metric == "relmse") {
      EXPECT_EQ(e.value, own[0].value);
      ++found;
    }
  EXPECT_EQ(found, 1);

  const Summary s = summarise(r);
  for (const char* pass : {"srp: project clusters", "srp: irradiance transport"}) {
    int rows = 0;
    for (const ConfigurationSummary& c : s.configurations)
      for (const PassSummary& stated : c.passes)
        if (stated.name == pass && stated.bytes > 0) {
          EXPECT_GT(stated.gbps(), 0);
          ++rows;
        }
    EXPECT_GE(rows, 3) << pass;
  }
  int memory = 0;
  for (const CostSlope& slope : costSlopes(r, s)) {
    EXPECT_EQ(slope.key, "srp.sh_order");
    EXPECT_EQ(slope.quantity, "bands");
    EXPECT_EQ(slope.fixed, "srp.compression none");
    EXPECT_EQ(slope.points.size(), 3u) << "the compressed one is of another kind";
    EXPECT_EQ(slope.points.back().first, 5);
    if (slope.cost == "technique_bytes") {
      EXPECT_GT(slope.slope, 0);
      ++memory;
    }
  }
  EXPECT_EQ(memory, 1);
  for (const WithinTarget& t : withinTarget(r, s)) {
    ASSERT_TRUE(t.configuration);
    double least = 1e30;
    for (const ConfigurationSummary& c : s.configurations) least = std::min(least, costOf(c, t.axis, r.experiment.amortiseFrames).median);
    EXPECT_EQ(t.cost, least) << "all are within it";
  }
  const std::string report = readFile(folder / "out/report.md");
  for (const char* part : {"lightmap relmse", "lightmap bias", "Memory traffic", "share of copy", "How cost grows", "Cheapest with relmse at most 1000"}) EXPECT_NE(report.find(part), std::string::npos) << part;
  const auto document = nlohmann::json::parse(readFile(folder / "out/results.json"));
  EXPECT_GT(document.at("copy_gbps").get<double>(), 0);
  EXPECT_FALSE(document.at("cost_slopes").empty());
  EXPECT_GT(document.at("configurations")[0].at("memory_traffic")[0].at("share_of_copy").get<double>(), 0);
  EXPECT_TRUE(sweepJson(openSweep(folder / "out"), summarise(openSweep(folder / "out"))) == readFile(folder / "out/results.json"));

  // Another target measures nothing anew; none can be below it here.
  Sweep strict(experiment("1e-9"), folder / "out");
  size_t made = 0;
  strict.onRun = [&](const SweepResults&, size_t) { ++made; };
  strict.run(*session, p);
  EXPECT_EQ(made, 0u);
  EXPECT_NE(readFile(folder / "out/report.md").find("none of these"), std::string::npos);
}

TEST(CostSlopes, FollowAPowerAndSayHowSure) {
  std::vector<std::pair<double, double>> points;
  for (const double x : {1.0, 2.0, 4.0, 9.0}) points.push_back({x, 3 * std::pow(x, 1.7)});
  EXPECT_NEAR(logLogSlope(points).first, 1.7, 1e-12);
  EXPECT_NEAR(logLogSlope(points).second, 0, 1e-7);
  points[2].second *= 2;
  EXPECT_GT(logLogSlope(points).second, 0.1);
  EXPECT_TRUE(std::isnan(logLogSlope({{2, 1}, {2, 3}, {2, 4}}).first));
}

TEST_F(SweepTest, CancelledItKeepsWhatIsDoneAndGoesOn) {
  const Experiment e = tiny(R"("permute": {"radiosity.samples": [4, 8, 16]}, "seeds": [1, 2], "path_tracer": false)");
  Progress stop;
  const auto session = makeSession();
  {
    Sweep sweep(e, folder / "out");
    sweep.onRun = [&](const SweepResults&, size_t run) {
      if (run == 2) stop.cancel();
    };
    try {
      sweep.run(*session, stop);
      ADD_FAILURE() << "was not cancelled";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Cancelled);
    }
    EXPECT_EQ(sweep.results().done(), 3u);
  }
  EXPECT_FALSE(nlohmann::json::parse(readFile(folder / "out/results.json")).at("complete").get<bool>());
  Sweep sweep(e, folder / "out");
  EXPECT_EQ(sweep.results().done(), 3u);
  Progress p;
  sweep.run(*session, p);
  EXPECT_TRUE(sweep.results().complete());

  Sweep whole(e, folder / "whole");
  whole.run(*session, p);
  ASSERT_EQ(whole.results().plan.size(), sweep.results().plan.size());
  for (size_t i = 0; i < whole.results().plan.size(); ++i) {
    const RunRecord &a = *whole.results().runs[i], &b = *sweep.results().runs[i];
    EXPECT_EQ(a.imageHash, b.imageHash);
    ASSERT_EQ(a.errors.size(), b.errors.size());
    for (size_t k = 0; k < a.errors.size(); ++k) EXPECT_EQ(a.errors[k].value, b.errors[k].value) << "to the bit";
  }
  expectNoMessages(*session);
}

TEST_F(SweepTest, AFailedRunIsARowAndTheOthersGoOn) {
  const Experiment e = tiny(R"("permute": [{"radiosity.samples": [4]}, {"camera": ["no such camera"]}, {"radiosity.samples": [8]}], "path_tracer": false)");
  Sweep sweep(e, folder / "out");
  const auto session = makeSession();
  Progress p;
  try {
    sweep.run(*session, p);
    ADD_FAILURE() << "bad input ends a sweep before its first run";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::BadInput);
  }
  EXPECT_EQ(sweep.results().done(), 0u);

  // The same fault where it shows only in the run itself.
  RunResults results;
  const RunRecord record = measureRun(*session, e, sweep.results().plan[1], {}, {}, p, results);
  EXPECT_NE(record.failed.find("no such camera"), std::string::npos) << record.failed;
  std::filesystem::create_directories(folder / "out/runs");
  writeFileAtomically(folder / "out/runs" / (record.key + ".json"), runRecordJson(record, results, sweep.results().plan[1].preset));
  const RunRecord back = readRunRecord(readFile(folder / "out/runs" / (record.key + ".json")), "x");
  EXPECT_EQ(back.failed, record.failed);

  const Sweep taken(e, folder / "out");
  EXPECT_EQ(taken.results().failed(), 1u);
  EXPECT_NE(sweepCsv(taken.results()).find("no such camera"), std::string::npos);
  EXPECT_NE(sweepReport(taken.results(), summarise(taken.results())).find("failed: "), std::string::npos);
}

TEST_F(SweepTest, RunsOfAnotherCommitDeviceOrTracerAreNotMixedIn) {
  const Experiment e = tiny(R"("path_tracer": false)");
  const auto session = makeSession();
  Progress p;
  Sweep(e, folder / "out").run(*session, p);
  const std::filesystem::path file = std::filesystem::directory_iterator(folder / "out/runs")->path();
  const std::string good = readFile(file);
  for (const char* key : {"commit", "device", "driver", "tracer"}) {
    auto document = nlohmann::json::parse(good);
    document["provenance"][key] = "another";
    writeFileAtomically(file, document.dump());
    try {
      Sweep(e, folder / "out").run(*session, p);
      ADD_FAILURE() << "mixed with another " << key;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::BadInput);
      EXPECT_NE(std::string(error.what()).find(key), std::string::npos) << error.what();
    }
    EXPECT_EQ(readFile(file), document.dump()) << "nothing is overwritten";
  }
  // A file that was cut off is made again.
  writeFileAtomically(file, good.substr(0, good.size() / 2));
  Sweep again(e, folder / "out");
  EXPECT_EQ(again.results().done(), 0u);
  again.run(*session, p);
  EXPECT_TRUE(again.results().complete());
}

TEST_F(SweepTest, ExperimentFilesOfOthersStay) {
  const auto session = makeSession();
  Progress p;
  // The person's own file, in the folder of the results.
  const std::string own = R"({"version": 1, "base": {"version": 1, "scene": "cornell_box", "technique": "none", "resolution": [32, 24]}, "permute": {"direct.samples": {"from": 1, "to": 2, "count": 2}}, "path_tracer": false})";
  for (const char* name : {"own", "other"}) std::filesystem::create_directories(folder / name);
  writeFileAtomically(folder / "own/experiment.json", own);
  Sweep(loadExperiment(folder / "own/experiment.json"), folder / "own").run(*session, p);
  EXPECT_EQ(readFile(folder / "own/experiment.json"), own);
  EXPECT_TRUE(openSweep(folder / "own").complete());
  // What is no experiment, under the name that ours would have.
  writeFileAtomically(folder / "other/experiment.json", "hi");
  try {
    Sweep(loadExperiment(folder / "own/experiment.json"), folder / "other").run(*session, p);
    ADD_FAILURE() << "written over";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::BadInput);
    EXPECT_NE(std::string(error.what()).find("written over"), std::string::npos) << error.what();
  }
  EXPECT_EQ(readFile(folder / "other/experiment.json"), "hi");
}

/// A flight has the errors of where it ends: of probes, which no camera moves, those of the camera that always stood there.
TEST_F(SweepTest, AFlightIsMeasuredWhereItEnds) {
  const std::string scene = folder.write("hall.json", R"({"version": 1, "shapes": [
    {"type": "box", "material": "wall", "min": [-2, -1, -1], "max": [2, 1, 1], "facing": "inward", "face_materials": {"-x": "red"}},
    {"type": "quad", "material": "lamp", "corners": [[-0.2, 0.98, -0.2], [0.2, 0.98, -0.2], [0.2, 0.98, 0.2], [-0.2, 0.98, 0.2]]}],
    "materials": {"wall": {"albedo": 0.7}, "red": {"albedo": [0.6, 0.1, 0.1]}, "lamp": {"albedo": 0, "emission": [10, 10, 10]}},
    "cameras": [{"name": "c", "position": [-1, 0, 0.5], "target": [2, 0, 0]}],
    "camera_paths": [{"name": "along", "keys": [{"time": 0, "position": [-1.5, 0, 0.5], "target": [2, 0, 0]}, {"time": 1, "position": [1, 0.2, 0.5], "target": [-2, 0, 0]}]}]})");
  const Experiment e = experimentFromJson(R"({"version": 1, "base": {"version": 1, "scene": ")" + scene + R"(", "resolution": [16, 12], "technique": "ddgi",
    "animation": {"play": true, "rate": 8, "camera_path": "along"}, "parameters": {"ddgi.rays": 16, "ddgi.spacing": 0.3, "direct.samples": 1, "reference.samples": 16}},
    "permute": {"animation.start": [1, 0]}, "metrics": ["relmse", "bias"], "references": ["matched"], "stop": {"frames": 12}, "path_tracer": false})", folder / "e.json");
  Sweep sweep(e, folder / "out");
  const auto session = makeSession();
  Progress p;
  sweep.run(*session, p);
  expectNoMessages(*session);
  const SweepResults& r = sweep.results();
  ASSERT_TRUE(r.complete());
  ASSERT_EQ(r.failed(), 0u);
  ASSERT_EQ(r.runs.size(), 2u);
  ASSERT_FALSE(r.runs[0]->errors.empty());
  ASSERT_EQ(r.runs[0]->errors.size(), r.runs[1]->errors.size());
  for (size_t i = 0; i < r.runs[0]->errors.size(); ++i) EXPECT_EQ(r.runs[0]->errors[i].value, r.runs[1]->errors[i].value) << r.runs[0]->errors[i].metric;
  EXPECT_EQ(r.runs[0]->imageHash, r.runs[1]->imageHash);
}

TEST_F(SweepTest, StopRules) {
  const auto session = makeSession();
  Progress p;
  Sweep frames(tiny(R"("stop": {"frames": 6}, "path_tracer": false)"), folder / "frames");
  frames.run(*session, p);
  const RunRecord& a = *frames.results().runs[0];
  EXPECT_EQ(a.frames, 6u);
  std::vector<uint32_t> counts;
  for (const ErrorAt& at : a.convergence) counts.push_back(at.frames);
  EXPECT_EQ(counts, (std::vector<uint32_t>{2, 4, 6})) << "the first goes before the bake is done";
  for (size_t i = 1; i < a.convergence.size(); ++i) EXPECT_GT(a.convergence[i].ms, a.convergence[i - 1].ms);
  EXPECT_GT(a.workMs, 0);

  Sweep ms(tiny(R"("stop": {"ms": 150}, "path_tracer": false, "images": true)"), folder / "ms");
  ms.run(*session, p);
  const RunRecord& b = *ms.results().runs[0];
  EXPECT_GE(b.totalMs, 150);
  EXPECT_GT(b.frames, 0u);
  const Image picture = readImage(pictureOf(folder / "ms", 0));
  EXPECT_EQ(hashOfImage(picture), b.imageHash) << "the picture that was measured";
  expectNoMessages(*session);
}

TEST_F(SweepTest, ALimitEndsARunAndSaysSo) {
  const auto session = makeSession();
  Progress p;
  // Preparing alone takes longer; the second would go on for minutes.
  const Experiment e = tiny(R"("limit_ms": 0.5, "path_tracer": false, "permute": [{"radiosity.samples": 4}, {"lightmap.resolution": 512, "radiosity.samples": 4096}])");
  Sweep sweep(e, folder / "out");
  RunResults results;
  const RunRecord quick = measureRun(*session, e, sweep.results().plan[0], {}, {}, p, results);
  EXPECT_NE(quick.failed.find("the limit is"), std::string::npos) << quick.failed;
  const RunRecord slow = measureRun(*session, e, sweep.results().plan[1], {}, {}, p, results);
  EXPECT_NE(slow.failed.find("the limit is"), std::string::npos) << slow.failed;
  EXPECT_LT(slow.seconds, 20);
  EXPECT_FALSE(p.cancelled()) << "the sweep goes on";
  expectNoMessages(*session);
}

// A run is the same whether it is limited (as those of `tune` are) or not: measured on its way, and the frames that are shown for that are in no total.
TEST_F(SweepTest, MeasuringIsNoPartOfTheTotal) {
  const auto session = makeSession();
  Progress p;
  const std::string rest = R"("path_tracer": false, "permute": {"radiosity.samples": [4096], "lightmap.resolution": [128], "reference.samples": [4], "resolution": [[320, 240]]})";
  for (const std::string limit : {R"("limit_ms": 600000, )", ""}) {
    const Experiment e = tiny(limit + rest);
    Sweep sweep(e, folder / ("out" + limit.substr(0, 1)));
    RunResults results;
    const RunRecord run = measureRun(*session, e, sweep.results().plan[0], {}, {}, p, results);
    ASSERT_EQ(run.failed, "");
    const FrameResult& f = *results.frame;
    const double shown = f.settledMs - f.workMs, before = run.frames - 1;
    std::printf("%s: prepared %.0f ms, work %.0f, total %.0f; %u frames shown by then, the last took %.0f ms, a median one %.0f; %zu points\n", limit.c_str(), run.prepareMs,
                run.workMs, run.totalMs, run.frames, shown, run.frameTime.medianMs, run.convergence.size());
    ASSERT_GE(run.frames, 4u) << "frames for measuring: there is something to leave out";
    EXPECT_GE(run.convergence.size(), 2u) << "limited runs are measured on the way too";
    EXPECT_DOUBLE_EQ(run.totalMs, run.prepareMs + run.workMs + shown);
    EXPECT_GT(shown, 0);
    EXPECT_LT(shown, 0.5 * (before + 1) * run.frameTime.p95Ms) << "one frame, not all of them";
    for (const ErrorAt& at : run.convergence) EXPECT_LE(at.ms, run.totalMs + 2 * run.frameTime.p95Ms);
  }
  expectNoMessages(*session);
}

TEST_F(SweepTest, ThePathTracerComesToTheTruth) {
  const auto session = makeSession();
  Progress p;
  Preset preset = smallPreset("cornell_box", "radiosity");
  preset.parameters["reference.samples"] = "1024";
  preset.width = 24, preset.height = 18;
  session->load(preset, &p);
  session->reference("image", &p);
  const auto tracer = session->progressiveTracer(12345);
  const auto mseNow = [&] {
    for (const ErrorValue& e : session->measureErrorsOf(tracer->image(), {"mse"}))
      if (e.reference == "matched" && e.component == "indirect" && e.roi.empty()) return e.value;
    return -1.0;
  };
  while (tracer->passes() < 16) tracer->advance(p);
  const double few = mseNow();
  while (tracer->passes() < 256) tracer->advance(p);
  const double many = mseNow();
  EXPECT_GT(tracer->ms(), 0);
  EXPECT_GT(few, 0);
  // Unbiased: sixteen times the paths, a sixteenth of the squared error, or better by stratification; a bias would stop it well above.
  EXPECT_LT(many, few / 10);
  Progress stopped;
  stopped.cancel();
  EXPECT_THROW(tracer->advance(stopped), Error);
  EXPECT_EQ(tracer->passes(), 256u) << "a cancelled pass is forgotten";
}

}  // namespace
}  // namespace hl::test
