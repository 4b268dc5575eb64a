// `bench` as a program: killed and run again, interrupted, failing.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/cli_process.h"
#include "tests/cli/results_table.h"

namespace hl::test {
namespace {

using nlohmann::json;

const std::string kExperiment = R"({"version": 1, "base": {"version": 1, "scene": "cornell_box", "resolution": [32, 24], "technique": "radiosity",
  "parameters": {"reference.samples": 64, "reference.direct_samples": 4, "direct.samples": 4, "direct.lumel_samples": 4, "radiosity.bounces": 3}},
  "permute": {"radiosity.samples": [16, 64], "lightmap.resolution": [32, 48]}, "seeds": [1, 2], "metrics": ["relmse", "bias"]})";

size_t runsIn(const std::filesystem::path& folder) {
  std::error_code none;
  size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "runs", none)) count += entry.path().extension() == ".json";
  return count;
}

/// Starts bench and sends `signal` as soon as `runs` are in the folder. Returns the exit code, or 128 + signal.
int benchUntil(const std::string& experiment, const std::filesystem::path& out, size_t runs, int signal) {
  std::vector<std::string> words = {HALFLIGHT_CLI, "bench", experiment, "--out", out};
  std::vector<char*> argv;
  for (std::string& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  if (posix_spawn(&child, HALFLIGHT_CLI, &actions, nullptr, argv.data(), environ)) throw std::runtime_error("cannot start");
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (runsIn(out) >= runs) {
      ::kill(child, signal);
      ::waitpid(child, &status, 0);
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST(CliBench, KilledHalfWayItEndsWithTheSameTable) {
  const TemporaryFolder folder;
  writeText(folder / "e.json", kExperiment);
  const CliResult whole = runCli({"bench", folder / "e.json", "--out", folder / "whole"});
  ASSERT_EQ(whole.code, 0) << whole.err;
  EXPECT_NE(whole.out.find("on the front"), std::string::npos) << whole.out;
  EXPECT_EQ(whole.out, contentOf(folder / "whole/report.md"));
  const auto table = tableOf(folder / "whole/results.csv");
  ASSERT_GT(table.size(), 8u);

  EXPECT_EQ(benchUntil(folder / "e.json", folder.path() / "killed", 3, SIGKILL), 128 + SIGKILL);
  const size_t kept = runsIn(folder.path() / "killed");
  EXPECT_GE(kept, 3u);
  EXPECT_LT(kept, 8u) << "killed half-way";
  EXPECT_FALSE(std::filesystem::exists(folder / "killed/results.csv"));
  const CliResult again = runCli({"bench", folder / "e.json", "--out", folder / "killed", "--json"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(tableOf(folder / "killed/results.csv"), table);

  const json d = json::parse(again.out);
  EXPECT_EQ(d.at("runs_done"), 8);
  EXPECT_EQ(again.err, "") << "--json says nothing else";
  for (const json& c : d.at("configurations")) {
    EXPECT_EQ(c.at("runs"), 2);
    EXPECT_GT(c.at("errors").at(0).at("value").at("ci95").get<double>(), 0) << "error bars";
    EXPECT_FALSE(c.at("path_tracer_at_equal_time").empty());
  }
  // Each run is the document that `render --json` prints, and more.
  const json run = json::parse(contentOf(folder.path() / "killed" / d.at("runs").at(0).at("file").get<std::string>()));
  for (const char* key : {"preset", "technique", "frames", "frame_ms", "passes", "memory", "errors", "counters", "convergence", "provenance", "run"})
    EXPECT_TRUE(run.contains(key)) << key;
}

TEST(CliBench, CtrlCKeepsWhatIsDone) {
  const TemporaryFolder folder;
  writeText(folder / "e.json", kExperiment);
  EXPECT_EQ(benchUntil(folder / "e.json", folder.path() / "out", 2, SIGINT), 130);
  const json d = json::parse(contentOf(folder / "out/results.json"));
  EXPECT_FALSE(d.at("complete").get<bool>());
  EXPECT_GE(d.at("runs_done").get<int>(), 2);
  EXPECT_LT(d.at("runs_done").get<int>(), 8);
}

/// A picture that the device has no room for fails in its run, first in the order; the others go on.
TEST(CliBench, AFailedRunIsRecordedAndTheExitCodeSaysSo) {
  const TemporaryFolder folder;
  std::string text = kExperiment;
  const std::string permute = R"("permute": {"radiosity.samples": [16, 64], "lightmap.resolution": [32, 48]})";
  text.replace(text.find(permute), permute.size(), R"("permute": {"resolution": [[8192, 8192], [32, 24]], "radiosity.samples": 16, "lightmap.resolution": 32})");
  writeText(folder / "e.json", text);
  const CliResult r = runCli({"bench", folder / "e.json", "--out", folder / "out"});
  EXPECT_EQ(r.code, 1) << r.err << r.out;
  EXPECT_NE(r.err.find("2 of 4 runs failed"), std::string::npos) << r.err;
  EXPECT_NE(r.out.find("failed: "), std::string::npos) << r.out;
  size_t failed = 0, done = 0;
  const json d = json::parse(contentOf(folder / "out/results.json"));
  for (const json& run : d.at("runs"))
    (run.at("state") == "failed" ? failed : done) += run.at("state") == "missing" ? 0 : 1;
  EXPECT_EQ(failed, 2u);
  EXPECT_EQ(done, 2u);
}

/// Values that each are right and make no sense together are known by the technique alone, in the run: bad input all the same, as `render` says of one such preset.
TEST(CliBench, RunsThatFailByBadInputAreBadInput) {
  const TemporaryFolder folder;
  const std::string base = R"({"version": 1, "scene": "point_light_cube", "resolution": [16, 12], "technique": "srp", "parameters": {"srp.sh_order": 8, "lightmap.resolution": 32, "reference.samples": 2, "srp.receiver_rays": 16)";
  writeText(folder / "preset.json", base + R"(, "srp.probe_rays": 64}})");
  const CliResult one = runCli({"render", folder / "preset.json"});
  EXPECT_EQ(one.code, 2) << one.err;
  const auto bench = [&](const std::string& permute) {
    writeText(folder / "e.json", R"({"version": 1, "base": )" + base + R"(}}, "permute": )" + permute + R"(, "metrics": ["relmse"], "stop": {"frames": 1}, "images": false})");
    std::filesystem::remove_all(folder.path() / "out");
    return runCli({"bench", folder / "e.json", "--out", folder / "out"});
  };
  for (const std::string permute : {R"({"srp.probe_rays": [64]})", R"({"srp.probe_rays": [64, 128]})", R"({"probes.placement": ["manual"]})"}) {
    const CliResult r = bench(permute);
    EXPECT_EQ(r.code, 2) << permute << r.err;
    const std::string last = r.err.substr(r.err.rfind("halflight-cli: "));  // after what precomputation says that it takes, on a slow machine
    EXPECT_EQ(std::count(last.begin(), last.end(), '\n'), 1) << r.err;
    EXPECT_NE(last.find(permute.find("manual") == std::string::npos ? "srp.probe_rays: 64 rays can't tell" : "has no probes of its own"), std::string::npos) << last;
    EXPECT_NE(last.find("1 of "), std::string::npos) << last;
  }
  const json d = json::parse(contentOf(folder / "out/results.json"));
  EXPECT_EQ(d.at("runs").at(0).at("state"), "failed");
  EXPECT_EQ(bench(R"({"srp.probe_rays": [128]})").code, 0);
}

TEST(CliBench, MistakesAreNamedBeforeADeviceIsTouched) {
  const TemporaryFolder folder;
  writeText(folder / "e.json", kExperiment);
  writeText(folder / "bad.json", R"({"version": 1, "base": "cornell_radiosity", "permute": {"radiosity.sample": [1]}})");
  const std::vector<std::string> noDevice = {"VK_ICD_FILENAMES=/nonexistent.json", "VK_DRIVER_FILES=/nonexistent.json"};
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& part) {
    const CliResult r = runCli(arguments, noDevice);
    EXPECT_EQ(r.code, 2) << r.err;
    EXPECT_NE(r.err.find(part), std::string::npos) << r.err;
    EXPECT_EQ(r.out, "");
  };
  refused({"bench", folder / "bad.json", "--out", folder / "o"}, "did you mean \"radiosity.samples\"?");
  refused({"bench", folder / "none.json", "--out", folder / "o"}, "none.json");
  refused({"bench", "cornell_radiosity_frnt", "--out", folder / "o"}, "did you mean cornell_radiosity_front?");
  refused({"bench", folder / "e.json"}, "--out");
  refused({"bench", folder / "e.json", "--out", folder / "e.json"}, "is no folder");
  EXPECT_FALSE(std::filesystem::exists(folder / "o"));
}

}  // namespace
}  // namespace hl::test
