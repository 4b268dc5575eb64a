// The scene's time in a session: what a frame shows, what a change resets, and what a baked technique says of a moment that is not its own.
#include "engine/scene/animation.h"
#include "tests/session_fixture.h"

namespace hl {
namespace {

constexpr const char* kScene = R"({"version": 1, "lightmap_uvs": true, "shapes": [
  {"type": "box", "name": "room", "material": "white", "min": [0, 0, 0], "max": [2, 2, 2], "facing": "inward"},
  {"type": "box", "name": "block", "material": "red", "min": [0.2, 0, 0.4], "max": [0.8, 1.2, 0.9]}],
  "materials": {"white": {"albedo": 0.6}, "red": {"albedo": [0.7, 0.1, 0.1]}},
  "lights": [{"type": "point", "name": "lamp", "position": [1, 1.8, 1], "intensity": 2}],
  "cameras": [{"name": "front", "position": [1, 1, 1.95], "target": [1, 1, 0], "vertical_fov_degrees": 80}],
  "animations": [
    {"name": "slide", "objects": ["block"], "repeat": "once", "keys": [{"time": 0}, {"time": 1, "translation": [0.8, 0, 0], "angle_degrees": 40}], "pivot": [0.5, 0, 0.6]}],
  "camera_paths": [{"name": "walk", "keys": [{"time": 0, "position": [1, 1, 1.95], "target": [1, 1, 0]}, {"time": 1, "position": [0.6, 1, 1.9], "target": [1, 1, 0]}]}]})";

class PlaybackTest : public test::SessionTest {
 protected:
  Preset preset(const std::string& technique) {
    Preset p = test::smallPreset(folder.write("moving.json", kScene), technique);
    if (technique == "radiosity") p.parameters["radiosity.samples"] = "64";
    return p;
  }
};

TEST_F(PlaybackTest, TimeIsAFunctionOfTheFrame) {
  const auto session = makeSession();
  Preset p = preset("none");
  p.animation.play = true, p.animation.start = 0.2f, p.animation.rate = 10;
  session->load(p);
  std::vector<std::string> hashes;
  for (int i = 0; i < 4; ++i) {
    const auto frame = session->frame();
    EXPECT_NEAR(frame->time, 0.2 + 0.1 * i, 1e-6);
    EXPECT_TRUE(frame->playing);
    EXPECT_FALSE(frame->settled);
    hashes.push_back(frame->displayHash);
  }
  EXPECT_NE(hashes[0], hashes[3]);
  // Again, and by way of another moment.
  session->load(p);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(session->frame()->displayHash, hashes[static_cast<size_t>(i)]) << i;
  Playback there;
  there.start = 0.5f;
  session->setPlayback(there);
  const auto still = session->frame();
  EXPECT_FALSE(still->playing);
  EXPECT_NEAR(still->time, 0.5, 1e-6);
  EXPECT_THROW(session->setTime(-1), Error);
  there.cameraPath = "wlak";
  EXPECT_THROW(session->setPlayback(there), Error);
  EXPECT_EQ(session->preset().animation.cameraPath, "");
  expectNoMessages(*session);
}

TEST_F(PlaybackTest, AMomentLooksTheSameHoweverItWasReached) {
  for (const std::string tracer : {"embree", "bvh"}) {
    SCOPED_TRACE(tracer);
    const auto session = makeSession(tracer);
    Preset p = preset("none");
    p.animation.start = 0.7f;
    session->load(p);
    const Image direct = (session->settle(), session->image("direct"));
    p.animation.start = 0, p.animation.play = true, p.animation.rate = 10;
    session->load(p);
    for (int i = 0; i < 7; ++i) session->frame();
    Playback there;
    there.start = 0.7f;
    session->setPlayback(there);
    session->settle();
    const Image again = session->image("direct");
    size_t different = 0;
    for (size_t i = 0; i < direct.data.size(); ++i) different += std::abs(direct.data[i] - again.data[i]) > 1e-3f;
    EXPECT_LE(different, direct.data.size() / 200);
    expectNoMessages(*session);
  }
}

TEST_F(PlaybackTest, MovingCostsPassesAndStandingStillDoesNot) {
  const std::pair<std::string, std::vector<std::string>> updates[] = {{"embree", {"embree: refit"}}, {"bvh", {"bvh: move triangles", "bvh: refit"}}};
  for (const auto& [tracer, passes] : updates) {
    SCOPED_TRACE(tracer);
    const auto session = makeSession(tracer);
    Preset p = preset("none");
    p.animation.play = true;
    session->load(p);
    session->frame();
    const auto moving = session->frame();
    const auto has = [](const FrameResult& f, const std::string& name, bool skipped) {
      for (const PassTiming& t : f.lastPasses)
        if (t.name.starts_with(name) && t.skipped.empty() != skipped) return true;
      return false;
    };
    EXPECT_TRUE(has(*moving, "scene: pose vertices", false));
    for (const std::string& pass : passes) EXPECT_TRUE(has(*moving, pass, false)) << pass;
    session->setPlayback({});
    session->frame();
    for (int i = 0; i < 3; ++i) {
      const auto still = session->frame();
      EXPECT_TRUE(has(*still, "scene: pose vertices", true));
      for (const std::string& pass : passes) EXPECT_FALSE(has(*still, pass, false)) << pass;
    }
    session->load(test::smallPreset("cornell_box", "none"));
    session->frame();
    const auto unmoved = session->frame();
    for (const PassTiming& t : unmoved->lastPasses)
      for (const char* of : {"pose", "refit", "move triangles"}) EXPECT_EQ(t.name.find(of), std::string::npos) << "a static scene lists no such pass: " << t.name;
  }
}

TEST_F(PlaybackTest, ABakeBelongsToItsMoment) {
  const auto session = makeSession();
  Preset p = preset("radiosity");
  session->load(p);
  session->settle();
  const Image atRest = session->image("indirect_irradiance");
  Playback play;
  play.play = true, play.rate = 4;
  session->setPlayback(play);
  session->frame();
  for (int i = 0; i < 3; ++i) {
    const auto frame = session->frame();
    EXPECT_NE(frame->message.find("belongs to 0.00 s"), std::string::npos) << frame->message;
    EXPECT_FALSE(frame->settled);
  }
  EXPECT_THROW(session->reference("lighmap"), Error);
  // The animation ends at 1 s: the time stands still from there on, and the bake is made anew.
  const auto settled = session->settle();
  EXPECT_EQ(settled->message, "");
  const Image there = session->image("indirect_irradiance");
  EXPECT_GT(std::abs(test::meanOf(there).x - test::meanOf(atRest).x) + std::abs(test::meanOf(there).y - test::meanOf(atRest).y), 1e-4f);
  // As it would have been baked there at once.
  Preset direct = preset("radiosity");
  direct.animation.start = 1;
  session->load(direct);
  session->settle();
  const vec3 a = test::meanOf(session->image("indirect_irradiance")), b = test::meanOf(there);
  EXPECT_NEAR(a.x, b.x, 1e-3f * b.x);
  EXPECT_NEAR(a.z, b.z, 1e-3f * b.z);
  expectNoMessages(*session);
}

TEST_F(PlaybackTest, ALoopNeverSettles) {
  const auto session = makeSession();
  Preset p = preset("none");
  std::string text(kScene);
  text.replace(text.find("\"once\""), 6, "\"loop\"");
  p.scene = folder.write("loop.json", text);
  p.animation.play = true;
  session->load(p);
  EXPECT_THROW(session->settle(), Error);
}

TEST_F(PlaybackTest, CameraPathsHoldTheCamera) {
  const auto session = makeSession();
  Preset p = preset("radiosity");
  session->load(p);
  session->settle();
  const uint64_t units = session->frame()->workUnits;
  Playback walk;
  walk.play = true, walk.rate = 4, walk.cameraPath = "walk";
  session->setPlayback(walk);
  session->setImagesWanted({"motion"});
  vec3 last(0);
  for (int i = 0; i < 4; ++i) {
    const auto frame = session->frame();
    if (i > 0) {
      EXPECT_NE(frame->camera.position.x, last.x);
    }
    last = frame->camera.position;
    EXPECT_EQ(frame->workUnits, units) << "a moved camera leaves the bake alone";
    ASSERT_TRUE(frame->images.count("motion"));
  }
  // Who takes hold of the camera leaves the path.
  Camera c = session->scene().cameras.front();
  c.position.x += 0.1f;
  session->setCamera(c);
  EXPECT_EQ(session->preset().animation.cameraPath, "");
  expectNoMessages(*session);
}

}  // namespace
}  // namespace hl
