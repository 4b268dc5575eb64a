// What needs no device: usage, lists, descriptions, comparisons.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "engine/core/files.h"
#include "engine/core/image_io.h"
#include "tests/cli/cli_process.h"

namespace hl::test {
namespace {

using nlohmann::json;

/// Bad usage: nothing on stdout, one line on stderr that contains `part`, exit code 2. There is no device to be had: a
/// command that touches one first exits with 3.
void expectRefusal(const std::vector<std::string>& arguments, const std::string& part) {
  const CliResult r = runCli(arguments, {"VK_ICD_FILENAMES=/nonexistent.json", "VK_DRIVER_FILES=/nonexistent.json"});
  std::string command;
  for (const std::string& a : arguments) command += a + " ";
  EXPECT_EQ(r.code, 2) << command << r.err;
  EXPECT_EQ(r.out, "") << command;
  EXPECT_EQ(r.err.rfind("halflight-cli: ", 0), 0u) << command << r.err;
  EXPECT_EQ(r.err.find('\n'), r.err.size() - 1) << "one line: " << r.err;
  EXPECT_NE(r.err.find(part), std::string::npos) << command << r.err;
}

TEST(CliUsage, MistakesAreNamedWithWhatIsNear) {
  expectRefusal({}, "a command is wanted: list, doctor, render, reference, compare, pack, bench, tune, describe");
  expectRefusal({"rendr", "cornell_box"}, "unknown command rendr; did you mean render?");
  expectRefusal({"bench", "x.json"}, "--out");
  expectRefusal({"tune", "cornell_box"}, "--budget-ms");
  expectRefusal({"pack", "x.json"}, "--out");
  expectRefusal({"render"}, "TARGET");
  expectRefusal({"render", "cornell_box", "--frame", "3"}, "--frame of render; did you mean --frames?");
  expectRefusal({"render", "cornell_box", "--frames", "many"}, "--frames");
  expectRefusal({"render", "cornell_box", "--frames", "0"}, "--frames");
  expectRefusal({"render", "cornell_box", "cornell_box"}, "unknown argument cornell_box");
  expectRefusal({"list", "technique"}, "did you mean techniques?");
  expectRefusal({"describe", "--markdown", "--schema"}, "either");
}

TEST(CliUsage, ParametersAreCheckedBeforeADeviceIsTouched) {
  expectRefusal({"render", "cornell_box", "--set", "lightmap.resolution"}, "KEY=VALUE is wanted");
  expectRefusal({"render", "cornell_box", "--set", "lightmap.resolution=8"},
                "lightmap.resolution = 8: out of range [32, 4096] texels");
  expectRefusal({"render", "cornell_box", "--set", "lightmap.resolution=big"},
                "lightmap.resolution = big: not a whole number");
  expectRefusal({"render", "cornell_box", "--set", "lightmap.resolutoin=64"}, "did you mean lightmap.resolution?");
  expectRefusal({"render", "cornell_box", "--technique", "radiosty"}, "radiosity");
  expectRefusal({"render", "cornell_box", "--resolution", "640"}, "WIDTHxHEIGHT");
  expectRefusal({"render", "cornell_box", "--metrics", "relmsee"}, "did you mean relmse?");
  expectRefusal({"render", "cornell_box", "--errors-of", "pixels"}, "image or lightmap");
  expectRefusal({"reference", "cornell_box", "--bounces", "some"}, "or inf");
  expectRefusal({"reference", "cornell_box", "--bounces", "99"}, "out of range [0, 16]");
  expectRefusal({"reference", "cornell_box", "--spp", "1"}, "reference.samples = 1: out of range");
}

TEST(CliUsage, NumbersAreFiniteAndInRange) {
  for (const char* number : {"nan", "inf", "infinity", "1e999", "65", "-65", "bright", "0x1"})
    expectRefusal({"render", "cornell_box", std::string("--exposure=") + number}, "a number from -64 to 64 is wanted");
  for (const char* number : {"-3", "4294967296", "1.5", "nan", "one", "1e3"})
    expectRefusal({"render", "cornell_box", "--seed", number},
                  std::string("--seed: a whole number from 0 to 4294967295 is wanted, not ") + number);
  expectRefusal({"render", "cornell_box", "--frames", "2.5"}, "a whole number from 1 to 1000000 is wanted, not 2.5");
  expectRefusal({"reference", "cornell_box", "--spp", "-4"}, "a whole number from 1 to 2147483647 is wanted, not -4");
  for (const char* number : {"nan", "inf", "-inf"})
    expectRefusal({"render", "cornell_box", "--set", std::string("radiosity.residual=") + number},
                  "radiosity.residual");
}

TEST(CliUsage, WhereResultsGoIsCheckedBeforeADeviceIsTouched) {
  const TemporaryFolder folder;
  writeText(folder / "file", "this is no folder");
  expectRefusal({"render", "cornell_box", "--out", folder / "file"}, "file is no folder");
  expectRefusal({"render", "cornell_box", "--out", folder / "file/deeper/still"}, "file is no folder");
  expectRefusal({"render", "cornell_box", "--out", "/proc/halflight"}, "nothing can be written there");
  expectRefusal({"reference", "cornell_box", "--out", folder / "r.png"}, "r.png: a file .exr or .pfm is wanted");
  expectRefusal({"reference", "cornell_box", "--out", folder / "r"}, ".exr or .pfm");
  expectRefusal({"reference", "cornell_box", "--out", folder / "none/r.exr"}, "there is no folder");
  expectRefusal({"reference", "cornell_box", "--out", "/proc/r.exr"}, "nothing can be written there");
  std::filesystem::create_directory(folder.path() / "a.exr");
  expectRefusal({"reference", "cornell_box", "--out", folder / "a.exr"}, "this is a folder");
  // Nothing is left of the looking: this one is good, and what is missing is the device alone.
  for (const std::string out : {"new/and/deeper", "made"}) {
    const CliResult r = runCli({"render", "cornell_box", "--out", folder / out},
                               {"VK_ICD_FILENAMES=/nonexistent.json", "VK_DRIVER_FILES=/nonexistent.json"});
    EXPECT_EQ(r.code, 3) << r.err;
  }
  size_t left = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) left += entry.exists() ? 1 : 0;
  EXPECT_EQ(left, 2u) << "file and a.exr, which this test made";
}

TEST(CliUsage, PresetFilesAreCheckedBeforeADeviceIsTouched) {
  const TemporaryFolder folder;
  const std::string file = folder / "p.json";
  const auto refusal = [&](const std::string& text, const std::string& part) {
    writeText(file, text);
    expectRefusal({"render", file}, part);
  };
  const std::string head = R"({"version": 1, "scene": "cornell_box", "technique": "none", )";
  refusal(head + R"("seed": "one"})", "seed: a whole number in [0, 4294967295] is wanted, not the text \"one\"");
  refusal(head + R"("sed": 1})", "unknown key \"sed\"; did you mean \"seed\"?");
  refusal(head + R"("parameters": {"lightmap.resolution": 5000}})", "out of range [32, 4096]");
  refusal(head + R"("resolution": [640, NaN]})", "not valid JSON");
  refusal(head, "line 1");
  refusal(R"({"version": 1, "technique": "none"})", "the key \"scene\" is missing");
  expectRefusal({"render", folder.path().string()}, "this is a folder");
}

TEST(CliUsage, HelpAndVersionGoToStdout) {
  const CliResult help = runCli({"--help"});
  EXPECT_EQ(help.code, 0);
  for (const char* command : {"list", "doctor", "render", "reference", "compare", "bench", "tune", "pack", "describe"})
    EXPECT_NE(help.out.find(command), std::string::npos) << command;
  EXPECT_NE(help.out.find("HALFLIGHT_VALIDATION"), std::string::npos) << help.out;
  EXPECT_EQ(help.err, "");
  const CliResult version = runCli({"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_NE(version.out.find("0."), std::string::npos);
}

/// `list KIND --json`, run once.
const json& listed(const std::string& kind) {
  static std::map<std::string, json> known;
  if (!known.count(kind)) {
    const CliResult r = runCli({"--json", "list", kind});
    EXPECT_EQ(r.code, 0) << r.err;
    EXPECT_EQ(r.err, "");
    known[kind] = json::parse(r.out);
  }
  return known[kind];
}

bool lists(const std::string& kind, const std::string& id) {
  for (const json& row : listed(kind))
    if (row.at("id") == id) return true;
  return false;
}

TEST(CliList, EveryKindIsAJsonArrayAndATable) {
  for (const std::string kind : {"techniques", "scenes", "presets", "params", "metrics"}) {
    ASSERT_TRUE(listed(kind).is_array() && !listed(kind).empty()) << kind;
    for (const json& row : listed(kind)) EXPECT_TRUE(row.at("id").is_string() && row.at("label").is_string()) << row;
  }
  for (const std::string kind : {"scenes", "params"}) {
    const CliResult table = runCli({"list", kind});
    EXPECT_EQ(table.code, 0);
    for (const json& row : listed(kind))
      EXPECT_NE(table.out.find(row.at("id").get<std::string>()), std::string::npos) << row;
  }
}

TEST(CliList, HoldsWhatThereIs) {
  EXPECT_EQ(listed("techniques")[0].at("id"), "none");
  EXPECT_TRUE(lists("techniques", "radiosity"));
  EXPECT_TRUE(lists("scenes", "cornell_box"));
  EXPECT_TRUE(lists("presets", "cornell_radiosity"));
  EXPECT_TRUE(lists("params", "lightmap.resolution"));
  EXPECT_TRUE(lists("metrics", "relmse"));
}

TEST(CliList, ParametersCarryTheirDeclaration) {
  for (const json& row : listed("params"))
    if (row.at("id") == "lightmap.resolution") {
      EXPECT_EQ(row.at("type"), "int");
      EXPECT_EQ(row.at("default"), 256);
      EXPECT_EQ(row.at("min"), 32);
      EXPECT_EQ(row.at("max"), 4096);
      EXPECT_EQ(row.at("effect"), "rebuild");
      return;
    }
  FAIL() << "lightmap.resolution is not listed";
}

TEST(CliDescribe, SchemaIsJsonAndTextNamesEveryParameter) {
  const CliResult schema = runCli({"describe", "--schema"});
  EXPECT_EQ(schema.code, 0);
  const json document = json::parse(schema.out);
  const CliResult text = runCli({"describe"});
  for (const auto& p : document.at("$defs").at("preset").at("properties").at("parameters").at("properties").items())
    EXPECT_NE(text.out.find(p.key() + " = "), std::string::npos) << p.key();
}

TEST(CliDescribe, TheCommittedTableIsUpToDate) {
  const CliResult r = runCli({"describe", "--markdown"});
  EXPECT_EQ(r.code, 0);
  EXPECT_TRUE(r.out == contentOf(homeFolder() / "docs/PARAMETERS.md"))
      << "write it anew: halflight-cli describe --markdown > docs/PARAMETERS.md";
}

class CliCompare : public ::testing::Test {
 protected:
  CliCompare() : a(8, 6, 3), b(8, 6, 3) {
    for (size_t i = 0; i < a.data.size(); ++i) {
      a.data[i] = 0.1f + 0.01f * static_cast<float>(i % 37);
      b.data[i] = a.data[i] + (i % 2 == 0 ? 0.5f : -0.25f);
    }
  }
  std::string write(const Image& image, const char* name) {
    writeImage(folder / name, image);
    return folder / name;
  }
  TemporaryFolder folder;
  Image a, b;
};

double valueOf(const json& document, const std::string& metric, const std::string& roi = "") {
  for (const json& e : document.at("errors"))
    if (e.at("metric") == metric && e.at("roi") == roi) return e.at("value").get<double>();
  ADD_FAILURE() << metric << " is missing";
  return -1;
}

TEST_F(CliCompare, AnImageAgainstItselfIsZero) {
  for (const char* name : {"a.exr", "a.pfm", "a.png"}) {
    const std::string file = write(a, name);
    const CliResult r = runCli({"compare", file, file, "--json", "--metric", "mse", "--metric", "relmse,bias"});
    ASSERT_EQ(r.code, 0) << r.err;
    const json document = json::parse(r.out);
    EXPECT_EQ(document.at("errors").size(), 3u);
    for (const char* metric : {"mse", "relmse", "bias"}) EXPECT_EQ(valueOf(document, metric), 0) << name;
  }
}

TEST_F(CliCompare, FiguresAreThoseOfTheFormula) {
  const std::string fileA = write(a, "a.exr"), fileB = write(b, "b.pfm");
  double sum = 0;
  for (size_t i = 0; i < a.data.size(); ++i)
    sum += std::pow(static_cast<double>(a.data[i]) - static_cast<double>(b.data[i]), 2);
  const json document = json::parse(runCli({"compare", fileA, fileB, "--json"}).out);
  EXPECT_NEAR(valueOf(document, "mse"), sum / static_cast<double>(a.data.size()), 1e-9);
  EXPECT_GE(document.at("errors").size(), 7u) << "all metrics where none is named";
}

TEST_F(CliCompare, RegionsAreMeasuredApart) {
  b = a;
  b.pixel(2, 3)[0] += 3;
  const std::string fileA = write(a, "a.exr"), fileB = write(b, "b.exr");
  const json document = json::parse(
      runCli({"compare", fileA, fileB, "--json", "--metric", "mse", "--roi", "0,0,2,6", "--roi", "2,3,1,1"}).out);
  EXPECT_EQ(valueOf(document, "mse", "0,0,2,6"), 0);
  EXPECT_NEAR(valueOf(document, "mse", "2,3,1,1"), 3, 1e-5);
  for (const char* wrong : {"0,0,9,6", "1,2,3", "a,b,c,d", "-1,0,2,2", "0,0,0,1", "0,0,1,1,1"})
    expectRefusal({"compare", fileA, fileB, "--roi", wrong}, "--roi");
}

TEST_F(CliCompare, ANonFinitePixelFails) {
  b.pixel(1, 1)[2] = std::numeric_limits<float>::quiet_NaN();
  const CliResult r = runCli({"compare", write(a, "a.exr"), write(b, "b.exr"), "--json"});
  EXPECT_EQ(r.code, 1);
  EXPECT_NE(r.err.find("1 pixels are NaN or infinite"), std::string::npos) << r.err;
  EXPECT_EQ(json::parse(r.out).at("errors")[0].at("non_finite"), 1);
}

TEST_F(CliCompare, WritesTheMap) {
  const std::string map = folder / "map.exr", picture = folder / "map.png";
  ASSERT_EQ(runCli({"compare", write(a, "a.exr"), write(b, "b.exr"), "--metric", "mse", "--map", map}).code, 0);
  const Image values = readImage(map);
  EXPECT_EQ(values.width, 8);
  double sum = 0;
  for (size_t i = 0; i < values.pixels(); ++i) sum += values.data[i * static_cast<size_t>(values.channels)];
  EXPECT_NEAR(sum / static_cast<double>(values.pixels()), (0.25 + 0.0625) / 2, 1e-5);
  {
    const CliResult r = runCli({"compare", folder / "a.exr", folder / "b.exr", "--map", picture});
    ASSERT_EQ(r.code, 0) << r.err;
  }
  EXPECT_EQ(readImage(picture).height, 6);
}

TEST_F(CliCompare, BadImagesAreRefused) {
  const std::string fileA = write(a, "a.exr");
  expectRefusal({"compare", fileA, write(Image(4, 4, 3), "small.exr")}, "8x6");
  expectRefusal({"compare", fileA, folder / "none.exr"}, "none.exr");
  writeText(folder / "text.png", "this is no image");
  expectRefusal({"compare", fileA, folder / "text.png"}, "text.png");
  expectRefusal({"compare", fileA, fileA, "--metric", "msee"}, "did you mean mse?");
  expectRefusal({"compare", fileA, fileA, "--map", folder / "m.jpg"}, ".exr or .pfm or .png is wanted");
}

}  // namespace
}  // namespace hl::test
