// What every technique must do in scenes whose objects and cameras move: these run over the registry.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/hash.h"
#include "tests/session_fixture.h"

namespace hl::test {
namespace {

class EveryTechniqueMoving : public SessionTest, public ::testing::WithParamInterface<std::string> {
 protected:
  Preset preset(const std::string& scene) const {
    Preset p = smallPreset(scene, GetParam());
    p.width = 32, p.height = 24;
    p.parameters["direct.samples"] = "4";
    if (GetParam() == "radiosity") p.parameters["radiosity.samples"] = "64", p.parameters["lightmap.resolution"] = "128";
    if (GetParam() == "srp") p.parameters["srp.receiver_rays"] = "32", p.parameters["srp.sh_order"] = "4", p.parameters["lightmap.resolution"] = "64";
    if (GetParam() == "ddgi") p.parameters["ddgi.rays"] = "64", p.parameters["ddgi.hysteresis"] = "0.9", p.parameters["ddgi.spacing"] = "0.125";
    if (GetParam() == "surfels") p.parameters["surfels.ray_budget"] = "2", p.parameters["surfels.settle_frames"] = "64", p.parameters.erase("surfels.young_rays");
    return p;
  }
  static float brightness(Session& session) {
    const Image image = session.image("indirect_irradiance");
    for (const float v : image.data) EXPECT_TRUE(std::isfinite(v));
    return luminance(meanOf(image));
  }
  bool hasIndirect() const { return GetParam() != "none"; }
};

std::vector<std::string> techniqueIds() {
  std::vector<std::string> ids;
  for (const TechniqueInfo& info : techniqueInfos()) ids.emplace_back(info.id);
  return ids;
}

/// A door that opens while the camera flies: the frame's number decides everything.
TEST_P(EveryTechniqueMoving, TwoRunsAgreeToTheBit) {
  Preset p = preset("two_rooms");
  p.animation.play = true, p.animation.start = 0.4f, p.animation.rate = 10, p.animation.cameraPath = "through";
  std::string hashes[2];
  for (std::string& hash : hashes) {
    const auto session = makeSession();
    session->load(p);
    session->finishWork();  // a bake belongs to the first moment, and how far it has come by a frame is a matter of time
    Hasher h;
    for (int i = 0; i < 10; ++i) {
      session->frame();
      h.array(session->image("final").data);
      if (hasIndirect()) h.array(session->image("indirect_irradiance").data);
    }
    hash = h.hex();
    expectNoMessages(*session);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

/// Truth is 0 behind a closed door and a wall of 2 cm. Both sides are looked at in turn, so that caches which go where the camera looks stand on both.
TEST_P(EveryTechniqueMoving, NothingLeaksThroughADoorOrAThinWall) {
  for (const char* scene : {"two_rooms", "thin_wall_tunnel"}) {
    SCOPED_TRACE(scene);
    const auto session = makeSession();
    Preset p = preset(scene);
    p.cameraName = "dark";
    if (GetParam() == "ddgi") p.parameters["ddgi.rays"] = "32";
    // A texel that lies across a wall's foot has the light of both sides: smaller ones, as with radiosity.
    if (GetParam() == "srp") p.parameters["lightmap.resolution"] = "128";
    if (GetParam() == "srp" && std::string(scene) == "thin_wall_tunnel") p.parameters["probes.spacing"] = "0.08";  // 0.25 of its length leaves no place in a half
    session->load(p);
    session->settle();
    session->setCameraName("lit");
    session->settle();
    const float lit = brightness(*session);
    session->setCameraName("dark");
    session->settle();
    const float dark = brightness(*session);
    RecordProperty(std::string("leak_") + scene, std::to_string(dark / std::max(lit, 1e-9f)));
    if (!hasIndirect()) continue;
    EXPECT_GT(lit, 0.1f);
    EXPECT_LE(dark, (GetParam() == "ddgi" ? 2e-2f : 1e-2f) * lit);
    expectNoMessages(*session);
  }
}

/// Inf in whatever a technique remembers of the light, by the one way in that every technique has: lights so bright that their sum is past what a float
/// holds (an infinite one is refused). Counted while it lasts, gone after one reset.
TEST_P(EveryTechniqueMoving, InfFromBlindingLightsIsCountedAndGoneAfterOneReset) {
  const auto bad = [](const FrameResult& f) {
    double sum = 0;
    for (const auto& [name, value] : f.counters)
      if (name.ends_with("nan") || name.ends_with("inf")) sum += value;
    return sum;
  };
  const auto session = makeSession();
  Preset p = preset("point_light_cube");
  if (GetParam() == "ddgi") p.parameters["ddgi.spacing"] = "0.25";
  session->load(p);
  EXPECT_EQ(bad(*session->settle()), 0);
  const float before = hasIndirect() ? brightness(*session) : 0;
  std::vector<PointLight> points = session->scene().pointLights;
  const std::vector<PointLight> sound = points;
  ASSERT_FALSE(points.empty());
  const vec3 sky = session->scene().sky;
  points.front().intensity = vec3(std::numeric_limits<float>::infinity());
  EXPECT_THROW(session->setLights(points, {}, {}, sky), Error);
  EXPECT_EQ(bad(*session->frame()), 0) << "what was refused has changed something";
  points.front().intensity = vec3(std::numeric_limits<float>::max());
  points.resize(32, points.front());
  session->setLights(points, {}, {}, sky);
  session->finishWork();
  for (int i = 0; i < 3; ++i) session->frame();
  EXPECT_GT(bad(*session->frame()), 0);
  session->setLights(sound, {}, {}, sky);
  session->resetTechnique();
  session->finishWork();
  session->frame();
  EXPECT_EQ(bad(*session->frame()), 0);
  EXPECT_EQ(bad(*session->settle()), 0);
  if (hasIndirect()) {
    EXPECT_NEAR(brightness(*session), before, 0.05f * before);
  }
  expectNoMessages(*session);
}

/// A block that has jumped aside: where it was and where it is look as if it had always been there, and surfaces that moved are lit in the frame after.
TEST_P(EveryTechniqueMoving, AMovedBlockLeavesNoTrail) {
  const std::string file = folder.write("block.json", R"({"version": 1, "lightmap_uvs": true, "shapes": [
    {"type": "box", "name": "room", "material": "white", "min": [0, 0, 0], "max": [2, 2, 2], "facing": "inward"},
    {"type": "box", "name": "block", "material": "red", "min": [0.2, 0.1, 0.4], "max": [0.8, 1.2, 0.9]},
    {"type": "quad", "name": "lamp", "material": "lamp", "corners": [[0.8, 1.98, 0.8], [1.2, 1.98, 0.8], [1.2, 1.98, 1.2], [0.8, 1.98, 1.2]]}],
    "materials": {"white": {"albedo": 0.6}, "red": {"albedo": [0.7, 0.1, 0.1]}, "lamp": {"albedo": 0, "emission": 10}},
    "cameras": [{"name": "front", "position": [1, 1, 1.95], "target": [1, 0.8, 0], "vertical_fov_degrees": 85}],
    "animations": [{"name": "slide", "objects": ["block"], "repeat": "once", "keys": [{"time": 0}, {"time": 1, "translation": [0.8, 0, 0]}]}]})");
  Preset there = preset(file);
  if (GetParam() == "ddgi") there.parameters["ddgi.spacing"] = "0.25";
  Preset here = there;
  there.animation.start = 1;
  const auto fresh = makeSession();
  fresh->load(there);
  fresh->settle();
  const auto session = makeSession();
  session->load(here);
  session->settle();
  session->setTime(1);
  const auto first = session->frame();
  if (GetParam() == "surfels") {
    // Surfels ride on the block: of the pixels that see its front again none has lost its cover.
    for (const auto& [name, value] : first->counters) EXPECT_TRUE(name != "unlit_pixels" || value < 0.02 * 32 * 24) << value;
  }
  session->settle();
  const Image a = session->image("indirect_irradiance"), b = fresh->image("indirect_irradiance");
  expectNoMessages(*session);
  if (!hasIndirect()) return;
  // Means over blocks of 8 x 6 pixels: a trail is larger than that, noise of pixels is not.
  double worst = 0, worstAt = -1;
  const vec3 all = meanOf(b);
  for (int by = 0; by < 4; ++by)
    for (int bx = 0; bx < 4; ++bx) {
      double was = 0, is = 0;
      for (int y = by * 6; y < by * 6 + 6; ++y)
        for (int x = bx * 8; x < bx * 8 + 8; ++x) {
          const float *u = a.pixel(x, y), *v = b.pixel(x, y);
          was += static_cast<double>(luminance(vec3(v[0], v[1], v[2]))), is += static_cast<double>(luminance(vec3(u[0], u[1], u[2])));
        }
      const double off = std::abs(is - was) / 48 / static_cast<double>(luminance(all));
      if (off > worst) worst = off, worstAt = by * 4 + bx;
    }
  RecordProperty("worst_block", std::to_string(worst));
  EXPECT_LT(worst, GetParam() == "radiosity" ? 1e-3 : 0.08) << "block " << worstAt;
}

/// A camera that jumps into a room it has never seen: lit at once by caches that do not depend on it, within the frames given by those that do.
TEST_P(EveryTechniqueMoving, ATeleportedCameraSettles) {
  const auto session = makeSession();
  Preset p = preset("two_rooms");
  p.cameraName = "lit", p.animation.start = 2;  // the door is open
  session->load(p);
  if (!hasIndirect()) return;
  const StepReport cut = session->measureStep(parseStep("camera=dark"), 200);
  ASSERT_FALSE(cut.meanLeft.empty());
  RecordProperty("first_frame_left", std::to_string(cut.meanLeft.front()));
  RecordProperty("mean_at_20", std::to_string(cut.meanLeft[std::min<size_t>(20, cut.meanLeft.size() - 1)]));
  EXPECT_LT(cut.meanLeft[std::min<size_t>(20, cut.meanLeft.size() - 1)], 0.1);
  if (GetParam() != "surfels") {
    EXPECT_LT(cut.meanLeft.front(), 0.02);
  }
  expectNoMessages(*session);
}

/// A technique rests while there is no light; what has moved in the meantime it hears of when it goes on.
TEST_F(SessionTest, SurfelsHearOfWhatMovedInTheDark) {
  const auto session = makeSession();
  Preset p;
  p.technique = "surfels", p.width = 24, p.height = 16, p.animation.play = false;
  p.scene = folder.write("drawer.json", R"({"version": 1, "shapes": [
    {"type": "box", "material": "wall", "min": [-1, -1, -1], "max": [1, 1, 1], "facing": "inward"},
    {"type": "box", "name": "drawer", "material": "wall", "min": [-0.6, -0.9, -0.5], "max": [-0.2, -0.3, 0]}],
    "materials": {"wall": {"albedo": [0.7, 0.7, 0.7]}},
    "lights": [{"type": "point", "position": [0, 0.8, 0.5], "intensity": 5}],
    "animations": [{"name": "pull", "objects": ["drawer"], "keys": [{"time": 0}, {"time": 1, "translation": [0.7, 0, 0]}]}],
    "cameras": [{"name": "front", "position": [0, 0, 0.95], "target": [0, -0.3, -1], "vertical_fov_degrees": 80}]})");
  p.parameters = {{"surfels.freeze_frames", "30"}, {"surfels.radius_pixels", "3"}, {"surfels.max_surfels", "4096"}, {"surfels.spawn_at_hits", "false"}};
  session->load(p);
  const auto listed = [&] {
    const std::shared_ptr<const FrameResult> f = session->frame();
    return std::any_of(f->passes.begin(), f->passes.end(), [](const PassStatistics& pass) { return pass.name == "surfels: sort cells" && pass.skipped.empty(); });
  };
  for (int i = 0; i < 32; ++i) session->frame();
  EXPECT_FALSE(listed());
  const std::vector<PointLight> lights = session->scene().pointLights;
  session->setLights({}, {}, {}, vec3(0));
  EXPECT_FALSE(listed());
  session->setTime(0.5);
  EXPECT_FALSE(listed());
  EXPECT_FALSE(listed());
  session->setLights(lights, {}, {}, vec3(0));
  EXPECT_TRUE(listed());
  expectNoMessages(*session);
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryTechniqueMoving, ::testing::ValuesIn(techniqueIds()), [](const auto& p) { return p.param; });

}  // namespace
}  // namespace hl::test
