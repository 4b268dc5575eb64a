// What every technique must pass, whoever wrote it: these run over the registry.
#include <fmt/core.h>

#include <cmath>

#include "engine/core/hash.h"
#include "tests/session_fixture.h"

namespace hl::test {
namespace {

class EveryTechnique : public SessionTest, public ::testing::WithParamInterface<std::string> {};

std::vector<std::string> techniqueIds() {
  std::vector<std::string> ids;
  for (const TechniqueInfo& info : techniqueInfos()) ids.emplace_back(info.id);
  return ids;
}

/// A closed room of side `side` round `centre`, with a light in its ceiling and a box on its floor.
std::string room(float side, vec3 centre, const char* extra = "", float albedo = 0.6f, float emission = 10.0f) {
  const auto at = [&](float x, float y, float z) {
    return fmt::format("[{}, {}, {}]", centre.x + side * x, centre.y + side * y, centre.z + side * z);
  };
  return fmt::format(
      R"({{"version": 1, "shapes": [
  {{"type": "box", "material": "wall", "min": {}, "max": {}, "facing": "inward"}},
  {{"type": "box", "material": "block", "min": {}, "max": {}}},
  {{"type": "quad", "material": "lamp", "corners": [{}, {}, {}, {}]}}{}],
 "materials": {{"wall": {{"albedo": [{}, {}, {}]}}, "block": {{"albedo": [0.5, 0.3, 0.2]}},
   "lamp": {{"albedo": [0, 0, 0], "emission": [{}, {}, {}]}}}},
 "cameras": [{{"name": "in", "position": {}, "target": {}, "vertical_fov_degrees": 70}}]}})",
      at(-.5f, -.5f, -.5f), at(.5f, .5f, .5f), at(-.2f, -.5f, -.2f), at(.1f, -.2f, .1f), at(-.1f, .49f, -.1f), at(.1f, .49f, -.1f),
      at(.1f, .49f, .1f), at(-.1f, .49f, .1f), extra, albedo, albedo, albedo, emission, emission, emission, at(.35f, .1f, .42f),
      at(-.1f, -.2f, -.1f));
}

void expectFinite(const Image& image) {
  for (const float v : image.data) ASSERT_TRUE(std::isfinite(v));
}

TEST_P(EveryTechnique, FurnaceFollowsTheSeries) {
  for (const char* scene : {"furnace_box_050", "furnace_box_080", "furnace_box_090"}) {
    auto session = makeSession();
    const vec3 mean = meanOf(settledIndirect(*session, smallPreset(scene, GetParam())));
    const Material& wall = session->scene().materials.front();
    const double rho = static_cast<double>(wall.albedo.x), emission = static_cast<double>(wall.emission.x);
    const int bounces = session->transport().bounces;
    double expected = 0, term = 3.14159265358979 * emission;
    for (int k = 0; k < std::min(bounces, 4000); ++k) expected += (term *= rho);
    // The technique may stop at a residual of 1e-3; the rest is sampling error.
    EXPECT_NEAR(static_cast<double>(mean.x), expected, 0.01 * expected + 1e-6) << scene << " with " << bounces << " bounces";
  }
}

TEST_P(EveryTechnique, SamePresetSameBits) {
  std::string hashes[2];
  for (std::string& hash : hashes) {
    auto session = makeSession();
    const Image image = settledIndirect(*session, quickPreset("cornell_box", GetParam()));
    hash = Hasher().array(image.data).hex();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST_P(EveryTechnique, RoundTripThroughAPresetFile) {
  auto session = makeSession();
  Preset preset = quickPreset("cornell_box", GetParam());
  preset.seed = 7;
  session->load(preset);
  Camera moved = session->scene().cameras.front();
  moved.position = moved.position + vec3(0.05f, 0.02f, 0);
  session->setCamera(moved);
  const auto first = session->settle();
  savePreset(session->preset(), folder / "saved.json");

  auto again = makeSession();
  again->load(loadPreset(folder / "saved.json"));
  const auto second = again->settle();
  EXPECT_EQ(first->displayHash, second->displayHash);
  EXPECT_EQ(first->provenance.presetHash, second->provenance.presetHash);
}

TEST_P(EveryTechnique, NearTheMatchedReference) {
  auto session = makeSession();
  settledIndirect(*session, smallPreset("cornell_box", GetParam()));
  if (session->transport().bounces == 0) {
    EXPECT_EQ(luminance(meanOf(session->image("indirect_irradiance"))), 0.0f);
    return;
  }
  session->reference();
  for (const ErrorValue& e : session->measureErrors({"relmse", "bias"})) {
    if (e.reference != "matched" || e.component != "indirect" || !e.roi.empty()) continue;
    EXPECT_EQ(e.nonFinite, 0u);
    EXPECT_LT(std::abs(e.value), e.metric == "bias" ? 0.03 : 0.05) << e.metric;
    EXPECT_NE(e.value, 0.0) << e.metric;
  }
}

TEST_P(EveryTechnique, TwiceTheLightTwiceTheResult) {
  auto session = makeSession();
  const std::string dim = folder.write("dim.json", room(2, vec3(0), "", 0.6f, 10)), bright = folder.write("bright.json", room(2, vec3(0), "", 0.6f, 20));
  const Image one = settledIndirect(*session, quickPreset(dim, GetParam())), two = settledIndirect(*session, quickPreset(bright, GetParam()));
  for (size_t i = 0; i < one.data.size(); ++i) ASSERT_NEAR(two.data[i], 2 * one.data[i], 1e-4f * std::abs(two.data[i]) + 1e-6f);
}

TEST_P(EveryTechnique, ScaleAndPlaceDoNotMatter) {
  auto session = makeSession();
  const auto indirect = [&](float side, vec3 centre) {
    return meanOf(settledIndirect(*session, smallPreset(folder.write("placed.json", room(side, centre)), GetParam()))).y;
  };
  const float expected = indirect(2, vec3(0));
  // Where surfels are placed and recycled is drawn by chance, which the least rounding turns: what is left is their sampling error. Of such a mean it is 8e-4 (five seeds at
  // each of three sizes, whose means over seeds agree to 2e-4), so of a difference 1.2e-3: the bound is three and a half of these.
  const float bound = GetParam() == std::string("surfels") ? 4.2e-3f : 1e-3f;
  EXPECT_NEAR(indirect(2e-3f, vec3(0)), expected, bound * expected);
  EXPECT_NEAR(indirect(2e3f, vec3(0)), expected, bound * expected);
  EXPECT_NEAR(indirect(2, vec3(1e4f, 0, -1e4f)), expected, 1e-2f * expected);
}

TEST_P(EveryTechnique, DuplicateAndEmptyTrianglesChangeNothing) {
  auto session = makeSession();
  const float expected = meanOf(settledIndirect(*session, quickPreset(folder.write("plain.json", room(2, vec3(0))), GetParam()))).y;
  // A second floor in the same plane, and a quad of no area.
  const std::string extra = R"(, {"type": "quad", "material": "wall", "corners": [[-1, -1, 1], [1, -1, 1], [1, -1, -1], [-1, -1, -1]]},
    {"type": "quad", "material": "wall", "corners": [[0, 0, 0], [0.5, 0, 0], [0.5, 0, 0], [0, 0, 0]]})";
  const Image doubled = settledIndirect(*session, quickPreset(folder.write("doubled.json", room(2, vec3(0), extra.c_str())), GetParam()));
  expectFinite(doubled);
  // Two coplanar floors share the hits between them: energy stays within what the two lightmaps' texels resolve.
  EXPECT_NEAR(meanOf(doubled).y, expected, 0.02f * expected);
}

TEST_P(EveryTechnique, ExtremeAlbedosAndLights) {
  auto session = makeSession();
  for (const float albedo : {0.0f, 0.99f}) {
    const Image image = settledIndirect(*session, quickPreset(folder.write("albedo.json", room(2, vec3(0), "", albedo)), GetParam()));
    expectFinite(image);
  }
  // A light 1e5 times brighter than the rest.
  const std::string beam = R"(, {"type": "quad", "material": "beam", "corners": [[-0.9, -0.5, 0.99], [-0.8, -0.5, 0.99], [-0.8, -0.4, 0.99], [-0.9, -0.4, 0.99]]})";
  std::string scene = room(2, vec3(0), beam.c_str());
  scene.replace(scene.find("\"lamp\": {"), 9, R"("beam": {"albedo": [0, 0, 0], "emission": [1e6, 1e6, 1e6]}, "lamp": {)");
  expectFinite(settledIndirect(*session, quickPreset(folder.write("beam.json", scene), GetParam())));
}

TEST_P(EveryTechnique, ScenesWithAlmostNothing) {
  auto session = makeSession();
  const std::string camera = R"("cameras": [{"name": "c", "position": [0, 1, 3], "target": [0, 0, 0]}])";
  const std::string oneTriangle = "v -1 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3\n";
  folder.write("one.obj", oneTriangle);
  const std::string scenes[] = {
      R"({"version": 1, "sky": [1, 1, 1], )" + camera + "}",
      R"({"version": 1, "shapes": [{"type": "quad", "material": "m", "corners": [[-1,0,1],[1,0,1],[1,0,-1],[-1,0,-1]]}], "materials": {"m": {"albedo": [0.5,0.5,0.5]}}, )" + camera + "}",
      R"({"version": 1, "mesh": {"file": "one.obj"}, "sky": [0.5, 0.5, 0.5], )" + camera + "}",
  };
  for (const std::string& text : scenes) {
    const Image image = settledIndirect(*session, quickPreset(folder.write("bare.json", text), GetParam()));
    expectFinite(image);
    expectFinite(session->image("final"));
  }
}

/// What a technique may let through a sealed wall. Probes that stand on both sides of it are told apart by a bound on visibility alone.
float leakLimit(const std::string& technique) { return technique == "ddgi" ? 2e-2f : 1e-3f; }

/// A dark room beside a lit one, with a wall of no thickness between: what is seen there is a leak.
TEST_P(EveryTechnique, SealedRoomStaysDark) {
  auto session = makeSession();
  const std::string text = R"({"version": 1, "shapes": [
    {"type": "box", "material": "wall", "min": [-1, -1, -1], "max": [1, 1, 1], "facing": "inward"},
    {"type": "box", "material": "wall", "min": [1, -1, -1], "max": [3, 1, 1], "facing": "inward"},
    {"type": "quad", "material": "lamp", "corners": [[-0.2, 0.98, -0.2], [0.2, 0.98, -0.2], [0.2, 0.98, 0.2], [-0.2, 0.98, 0.2]]}],
    "materials": {"wall": {"albedo": [0.7, 0.7, 0.7]}, "lamp": {"albedo": [0, 0, 0], "emission": [10, 10, 10]}},
    "cameras": [{"name": "bright", "position": [-0.8, 0, 0.8], "target": [0.5, -0.2, -0.5], "vertical_fov_degrees": 80},
                {"name": "dark", "position": [1.2, 0, 0.8], "target": [2.5, -0.2, -0.5], "vertical_fov_degrees": 80}]})";
  Preset preset = smallPreset(folder.write("two_rooms.json", text), GetParam());
  preset.cameraName = "bright";
  const float bright = meanOf(settledIndirect(*session, preset)).y;
  preset.cameraName = "dark";
  const float dark = meanOf(settledIndirect(*session, preset)).y;
  EXPECT_LE(dark, leakLimit(GetParam()) * bright);
  if (session->transport().bounces > 0) {
    EXPECT_GT(bright, 0.1f);
  }
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryTechnique, ::testing::ValuesIn(techniqueIds()), [](const auto& p) { return p.param; });

}  // namespace
}  // namespace hl::test
