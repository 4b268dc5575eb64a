// `pack`, and what runs from a bundle where neither the import module nor the scene's files are.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "engine/core/archive.h"
#include "engine/scene/scene_bundle.h"
#include "tests/cli/cli_process.h"
#include "tests/cli/results_table.h"

namespace hl::test {
namespace {

using nlohmann::json;

class CliPack : public ::testing::Test {
 protected:
  /// As on another machine: no module, no folders of scenes, an empty cache.
  std::vector<std::string> elsewhere() {
    return {"HALFLIGHT_IMPORT_MODULE=none", "HALFLIGHT_SCENES=", cacheVariable()};
  }
  std::string cacheVariable() { return "HALFLIGHT_CACHE=" + (folder / "cache elsewhere").string(); }
  std::vector<std::string> render(const std::string& what) {
    return {"render", what, "--json", "--resolution", "48x27", "--set", "lightmap.resolution=32", "--set", "radiosity.samples=16", "--metrics", "relmse",
            "--set", "reference.samples=4", "--set", "reference.direct_samples=4"};
  }
  void refused(const CliResult& r, const std::vector<std::string>& parts) {
    EXPECT_EQ(r.code, 2);
    EXPECT_EQ(r.out, "");
    EXPECT_EQ(r.err.find('\n'), r.err.size() - 1) << r.err;
    for (const std::string& part : parts) EXPECT_NE(r.err.find(part), std::string::npos) << part << " in: " << r.err;
  }

  TemporaryFolder folder;
  const std::string bundle = folder / "box.hlb";
};

TEST_F(CliPack, ABundleGivesTheSamePictureAndErrorsElsewhere) {
  const CliResult packed = runCli({"pack", "cornell_box", "--out", bundle, "--references", "--json", "--resolution", "48x27", "--set",
                                   "lightmap.resolution=32", "--set", "reference.samples=4", "--set", "reference.direct_samples=4"});
  ASSERT_EQ(packed.code, 0) << packed.err;
  const json listing = json::parse(packed.out);
  EXPECT_EQ(listing.at("bytes").get<uint64_t>(), std::filesystem::file_size(bundle));
  bool scene = false, reference = false;
  for (const json& part : listing.at("parts")) {
    scene |= part.at("name") == "scene/cornell_box";
    reference |= part.at("name").get<std::string>().starts_with("cache/references/");
  }
  EXPECT_TRUE(scene && reference) << packed.out;

  const CliResult here = runCli(render("cornell_box")), there = runCli(render(bundle), elsewhere());
  ASSERT_EQ(here.code, 0) << here.err;
  ASSERT_EQ(there.code, 0) << there.err;
  const json a = json::parse(here.out), b = json::parse(there.out);
  EXPECT_EQ(a.at("image"), b.at("image"));
  EXPECT_EQ(a.at("errors"), b.at("errors"));
  for (const char* key : {"preset_hash", "scene_hash"}) EXPECT_EQ(a.at("provenance").at(key), b.at("provenance").at(key));
  // The references came along: nothing had to be traced.
  size_t references = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "cache elsewhere/references")) references += entry.is_regular_file();
  EXPECT_GE(references, 1u);
}

/// What moves comes along: the same frames of the same flight past the same turning object.
TEST_F(CliPack, ABundleKeepsAnimationsAndFlights) {
  const CliResult packed = runCli({"pack", "cornell_spin", "--out", bundle, "--json"});
  ASSERT_EQ(packed.code, 0) << packed.err;
  const auto played = [](const std::string& what, const char* time) {
    return std::vector<std::string>{"render", what, "--json", "--resolution", "48x27", "--technique", "none", "--time", time, "--play", "--rate", "10", "--frames", "4"};
  };
  const CliResult here = runCli(played("cornell_spin", "0.5")), there = runCli(played(bundle, "0.5"), elsewhere()), later = runCli(played(bundle, "1.5"), elsewhere());
  for (const CliResult* r : {&here, &there, &later}) ASSERT_EQ(r->code, 0) << r->err;
  const json a = json::parse(here.out), b = json::parse(there.out), c = json::parse(later.out);
  EXPECT_EQ(a.at("image"), b.at("image"));
  EXPECT_EQ(a.at("provenance").at("scene_hash"), b.at("provenance").at("scene_hash"));
  EXPECT_NE(b.at("image"), c.at("image")) << "nothing moves: equal pictures above would say nothing";
}

TEST_F(CliPack, WithoutTheModuleImagesArePfmAndMeshesAreRefused) {
  ASSERT_EQ(runCli({"pack", "cornell_box", "--out", bundle}).code, 0);
  std::vector<std::string> arguments = render(bundle);
  arguments.insert(arguments.end(), {"--technique", "none", "--frames", "1", "--out", folder / "out"});
  std::erase_if(arguments, [](const std::string& a) { return a == "--set" || a.starts_with("radiosity.") || a.starts_with("lightmap.") || a.starts_with("reference."); });
  const CliResult r = runCli(arguments, elsewhere());
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/final.pfm"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/picture.pfm"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/final.exr"));
  refused(runCli({"render", "cornell_box"}, elsewhere()), {"cornell_box.obj", "import module", ".hlb", ".pfm"});
  writeText(folder / "a.png", "x");
  refused(runCli({"compare", folder / "a.png", folder / "a.png"}, elsewhere()), {"a.png", "import module"});
  const CliResult doctor = runCli({"doctor", bundle, "--json"}, elsewhere());
  ASSERT_EQ(doctor.code, 0) << doctor.err;
  EXPECT_NE(json::parse(doctor.out).at("missing").dump().find("import module"), std::string::npos);
}

TEST_F(CliPack, WrongFilesAndPlacesAreNamed) {
  ASSERT_EQ(runCli({"pack", "cornell_box", "--out", bundle}).code, 0);
  const std::string whole = contentOf(bundle);
  writeText(folder / "cut.hlb", whole.substr(0, whole.size() - 20));
  refused(runCli({"render", folder / "cut.hlb"}), {"cut.hlb", "cut off or damaged"});
  writeText(folder / "foreign.hlb", "not one of ours at all, and long enough to hold a head");
  refused(runCli({"render", folder / "foreign.hlb"}), {"foreign.hlb", "not a bundle"});
  std::string later = whole;
  later[std::string("halflight bundle\n").size()] = 99;
  writeText(folder / "later.hlb", later);
  refused(runCli({"render", folder / "later.hlb"}), {"later.hlb", "version 99"});
  refused(runCli({"pack", "cornell_box", "--out", folder / "box.zip"}), {"--out", ".hlb"});
  refused(runCli({"pack", "cornell_box", "--out", folder / "no/such/box.hlb"}), {"--out", "no folder"});
  refused(runCli({"pack", "cornel_box", "--out", bundle}), {"cornel_box", "cornell_box"});
  EXPECT_EQ(contentOf(bundle), whole) << "what was there stays";
}

// A compute node's whole errand: the bundle of an experiment, and nothing else.
TEST_F(CliPack, AnExperimentsBundleGivesTheSameTableElsewhere) {
  writeText(folder / "e.json", R"({"version": 1, "base": {"version": 1, "scene": "cornell_box", "resolution": [32, 24], "technique": "radiosity",
    "parameters": {"reference.samples": 64, "reference.direct_samples": 4, "direct.samples": 4, "direct.lumel_samples": 4, "radiosity.bounces": 3}},
    "permute": {"technique": ["radiosity", "none"], "radiosity.samples": [16, 64], "lightmap.resolution": 32, "resolution": [[32, 24], [24, 24]]},
    "seeds": [1, 2], "metrics": ["relmse"], "path_tracer": false})");
  for (const bool references : {false, true}) {
    std::vector<std::string> arguments = {"pack", folder / "e.json", "--out", bundle, "--json"};
    if (references) arguments.push_back("--references");
    const CliResult packed = runCli(arguments);
    ASSERT_EQ(packed.code, 0) << packed.err;
    size_t scenes = 0, traced = 0, experiments = 0;
    const json listing = json::parse(packed.out);
    for (const json& part : listing.at("parts")) {
      const std::string name = part.at("name");
      scenes += name == "scene/cornell_box", experiments += name == "experiment", traced += name.starts_with("cache/references/");
    }
    EXPECT_EQ(scenes, 1u);
    EXPECT_EQ(experiments, 1u);
    EXPECT_EQ(traced, references ? 2u : 0u) << "one a resolution: all else shares them";
    const CliResult there = runCli({"bench", bundle, "--out", folder / (references ? "there with" : "there")}, elsewhere());
    ASSERT_EQ(there.code, 0) << there.err;
  }
  const CliResult here = runCli({"bench", folder / "e.json", "--out", folder / "here"});
  ASSERT_EQ(here.code, 0) << here.err;
  const auto table = tableOf(folder / "here/results.csv");
  ASSERT_GT(table.size(), 12u);
  EXPECT_EQ(tableOf(folder / "there/results.csv"), table);
  EXPECT_EQ(tableOf(folder / "there with/results.csv"), table);

  refused(runCli({"render", bundle}), {"box.hlb", "experiment", "bench"});
  ASSERT_EQ(runCli({"pack", "cornell_box", "--out", folder / "preset.hlb"}).code, 0);
  refused(runCli({"bench", folder / "preset.hlb", "--out", folder / "no"}), {"preset.hlb", "holds a preset", "render"});
  writeText(folder / "cut.hlb", contentOf(bundle).substr(0, 5000));
  refused(runCli({"bench", folder / "cut.hlb", "--out", folder / "no"}), {"cut.hlb", "cut off or damaged"});

  // References that are whole as parts of the bundle, and are not what they say.
  const Archive sound(bundle, kBundleKind);
  std::string reference;
  for (const std::string& part : sound.parts())
    if (part.starts_with("cache/references/")) reference = part;
  const std::string bytes = sound.read(reference);
  std::string altered = bytes;
  altered[altered.size() / 2] = static_cast<char>(altered[altered.size() / 2] ^ 1);
  std::string otherKey = reference;
  otherKey[std::string("cache/references/").size()] = otherKey[std::string("cache/references/").size()] == '0' ? '1' : '0';
  const auto with = [&](const std::string& name, const std::string& content) {
    ArchiveWriter w(kBundleKind, 1);
    for (const char* part : {"experiment", "scene/cornell_box"}) w.add(part, sound.read(part));
    w.add(name, content);
    w.write(folder / "forged.hlb");
    const std::vector<std::string> there = {"HALFLIGHT_CACHE=" + (folder / "third cache").string()};
    return runCli({"bench", folder / "forged.hlb", "--out", folder / "no"}, there);
  };
  refused(with(reference, altered), {"forged.hlb", "checksum"});
  refused(with(reference, bytes.substr(0, bytes.size() - 1)), {"forged.hlb", "receivers"});
  refused(with(reference, "something else"), {"forged.hlb", "no reference of this version"});
  refused(with(otherKey, bytes), {"forged.hlb", "is called"});
  EXPECT_FALSE(std::filesystem::exists(folder / "third cache/references"));
}

}  // namespace
}  // namespace hl::test
