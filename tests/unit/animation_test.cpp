// Animations at a moment, their files, and a scene that is brought from one moment to the next.
#include "engine/scene/animation.h"

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_pack.h"
#include "engine/scene/scene_pose.h"
#include "tests/moving_scenes.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

TEST(Animation, TimesRepeat) {
  EXPECT_EQ(timeWithin(Repeat::Once, 2, 5), 2);
  EXPECT_EQ(timeWithin(Repeat::Loop, 2, 5), 1);
  EXPECT_EQ(timeWithin(Repeat::PingPong, 2, 3), 1);
  EXPECT_EQ(timeWithin(Repeat::PingPong, 2, 4.5), 0.5);
  EXPECT_EQ(timeWithin(Repeat::Loop, 0, 4.5), 0);
  EXPECT_EQ(timeWithin(Repeat::Loop, 2, -1), 0);
}

TEST(Animation, TurnsAboutItsPivot) {
  ObjectAnimation a;
  a.pivot = vec3(1, 0, 0), a.axis = vec3(0, 1, 0);
  a.keys = {{0, vec3(0), 0, vec3(1)}, {4, vec3(0), 2 * kPi, vec3(1)}};
  const vec3 p = vec3(poseAt(a, 1) * vec4(2, 3, 0, 1));  // a quarter turn, counter-clockwise seen from above: +x to -z
  EXPECT_NEAR(p.x, 1, 1e-6f);
  EXPECT_NEAR(p.y, 3, 1e-6f);
  EXPECT_NEAR(p.z, -1, 1e-6f);
  EXPECT_EQ(poseAt(a, 0), mat4(1.0f));
  EXPECT_EQ(poseAt(a, 4), mat4(1.0f)) << "a loop begins again";
  a.keys = {{0, vec3(0), 0, vec3(1)}, {2, vec3(0, 4, 0), 0, vec3(2, 1, 1)}};
  const vec3 q = vec3(poseAt(a, 1) * vec4(3, 0, 0, 1));
  EXPECT_NEAR(q.x, 1 + 1.5f * 2, 1e-6f);
  EXPECT_NEAR(q.y, 2, 1e-6f);
}

TEST(Animation, CameraPathsPassThroughTheirKeysSmoothly) {
  CameraPath path;
  path.name = "flight";
  for (int i = 0; i < 5; ++i) {
    CameraKey k;
    k.time = static_cast<float>(i * i);
    k.camera.position = vec3(static_cast<float>(i), static_cast<float>(i % 2), 0);
    k.camera.target = k.camera.position + vec3(0, 0, -1);
    path.keys.push_back(k);
  }
  for (const CameraKey& k : path.keys) EXPECT_TRUE(cameraAt(path, static_cast<double>(k.time)).seesAs(k.camera));
  // No kink at a key: the speeds on both sides agree.
  const double h = 1e-3, at = 4;
  const vec3 before = cameraAt(path, at).position - cameraAt(path, at - h).position, after = cameraAt(path, at + h).position - cameraAt(path, at).position;
  EXPECT_LT(glm::length(before - after), 0.02f * glm::length(before));
}

TEST(ScenePose, BringsVerticesAndBoundsAlong) {
  const Scene rest = test::turningRoom();
  Scene scene = rest;
  ScenePose pose(scene);
  ASSERT_TRUE(pose.movesGeometry());
  EXPECT_TRUE(pose.apply(scene, 0.5).geometry);
  size_t moved = 0;
  for (size_t v = 0; v < rest.positions.size(); ++v) moved += rest.positions[v] != scene.positions[v];
  EXPECT_GT(moved, 50u);
  EXPECT_LE(moved, pose.vertices().size());
  const std::vector<bool> moving = movingTriangles(scene);
  for (size_t t = 0; t < moving.size(); ++t)
    if (!moving[t]) {
      EXPECT_EQ(rest.positions[rest.indices[t].x], scene.positions[scene.indices[t].x]);
    }
  for (double time = 0; time < 4; time += 0.37) {
    pose.apply(scene, time);
    for (const shared::MovingVertex& v : pose.vertices()) {
      const vec3 p = scene.positions[v.vertex];
      for (int k = 0; k < 3; ++k) {
        EXPECT_GE(p[k], rest.bounds.min[k] - 0.01f);
        EXPECT_LE(p[k], rest.bounds.max[k] + 0.01f);
      }
      EXPECT_NEAR(glm::length(scene.normals[v.vertex]), 1, 1e-5f);
    }
  }
  // The same moment again: nothing moves, and the transforms say so.
  const double now = 1.25;
  pose.apply(scene, now);
  const ScenePose::Changed still = pose.apply(scene, now);
  EXPECT_FALSE(still.geometry);
  EXPECT_TRUE(still.transforms);
  EXPECT_FALSE(pose.apply(scene, now).transforms);
  for (const shared::ObjectTransform& t : pose.transforms()) EXPECT_EQ(t.restToWorld, t.previousRestToWorld);
  // Moments do not depend on those before.
  Scene other = rest;
  ScenePose direct(other);
  direct.apply(other, now);
  EXPECT_EQ(other.positions, scene.positions);
  EXPECT_EQ(other.normals, scene.normals);
}

TEST(ScenePose, SharedVerticesAreTakenApart) {
  Scene scene;
  const uint32_t m = test::addMaterial(scene);
  test::addQuad(scene, vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), m);
  scene.indices[1].x = scene.indices[0].x;  // the quad's triangles share a corner
  const uint32_t second = test::addObject(scene, "second", 1);
  ObjectAnimation a;
  a.name = "a", a.objects = {second}, a.keys = {{0, vec3(0), 0, vec3(1)}, {1, vec3(0, 0, 5), 0, vec3(1)}};
  a.repeat = Repeat::Once;
  scene.animations = {a};
  finishScene(scene);
  EXPECT_NE(scene.indices[1].x, scene.indices[0].x);
  ScenePose pose(scene);
  pose.apply(scene, 1);
  EXPECT_EQ(scene.positions[scene.indices[0].x].z, 0);
  EXPECT_EQ(scene.positions[scene.indices[1].x].z, 5);
}

constexpr const char* kRoom = R"("version": 1, "shapes": [{"type": "box", "name": "door", "material": "m", "min": [0, 0, 0], "max": [1, 1, 1]},
  {"type": "box", "name": "leg left", "material": "m", "min": [2, 0, 0], "max": [3, 1, 1]}, {"type": "box", "name": "leg right", "material": "m", "min": [4, 0, 0], "max": [5, 1, 1]}],
  "materials": {"m": {"albedo": 0.5}}, "lights": [{"type": "point", "name": "lamp", "position": [0, 2, 0], "intensity": 1},
  {"type": "directional", "name": "sun", "direction": [0, -1, 0], "irradiance": 1}])";

class AnimationFiles : public ::testing::Test {
 protected:
  std::string file(const std::string& more) {
    writeFileAtomically(folder / "room.json", std::string("{") + kRoom + ", " + more + "}");
    return (folder / "room.json").string();
  }
  void refused(const std::string& more, const std::vector<std::string>& words) {
    SCOPED_TRACE(more);
    try {
      loadScene(file(more));
      ADD_FAILURE() << "accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.exitCode(), 2);
      const std::string what = e.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      for (const std::string& word : words) EXPECT_NE(what.find(word), std::string::npos) << word << " in: " << what;
    }
  }
  test::TemporaryFolder folder;
};

TEST_F(AnimationFiles, AreRead) {
  const Scene s = loadScene(file(R"("animations": [
    {"name": "swing", "objects": ["door", "leg*"], "pivot": [1, 0, 0], "axis": [0, 2, 0], "repeat": "ping_pong", "eased": true,
     "keys": [{"time": 0}, {"time": 2, "angle_degrees": 90, "translation": [0, 1, 0], "scale": [1, 2, 1]}]},
    {"light": "sun", "keys": [{"time": 0, "direction": [0, -1, 0]}, {"time": 1, "direction": [-1, 0, 0]}]},
    {"light": "lamp", "repeat": "once", "keys": [{"time": 0, "position": [0, 2, 0], "intensity_factor": 1}, {"time": 1, "position": [1, 2, 0], "intensity_factor": 0}]}],
    "camera_paths": [{"name": "flight", "keys": [{"time": 0, "position": [0, 0, 5], "target": [0, 0, 0]}, {"time": 3, "position": [5, 0, 0], "target": [0, 0, 0]}]}])"));
  ASSERT_EQ(s.animations.size(), 1u);
  EXPECT_EQ(s.animations[0].objects.size(), 3u);
  EXPECT_EQ(s.animations[0].axis, vec3(0, 1, 0));
  EXPECT_NEAR(s.animations[0].keys[1].angle, kPi / 2, 1e-6f);
  ASSERT_EQ(s.lightAnimations.size(), 2u);
  EXPECT_TRUE(s.lightAnimations[1].movesPosition && s.lightAnimations[1].scalesIntensity && !s.lightAnimations[1].turnsDirection);
  EXPECT_EQ(cameraPath(s, "flight").keys.size(), 2u);
  EXPECT_THROW(cameraPath(s, "fligth"), Error);
  EXPECT_TRUE(sceneFeatures(s).movingObjects && sceneFeatures(s).movingLights);

  Scene posed = s;
  ScenePose pose(posed);
  pose.apply(posed, 0.5);
  EXPECT_NEAR(posed.directionalLights[0].direction.x, -std::sqrt(0.5f), 1e-5f);
  EXPECT_NEAR(posed.pointLights[0].intensity.x, 0.5f, 1e-6f);
  EXPECT_NEAR(posed.pointLights[0].position.x, 0.5f, 1e-6f);
  // Edits go under what moves.
  Scene edited = s;
  edited.pointLights[0].intensity = vec3(4.0f);
  pose.setLights(edited);
  pose.apply(posed, 0.5);
  EXPECT_NEAR(posed.pointLights[0].intensity.x, 2.0f, 1e-6f);

  const Scene again = unpackScene(packScene(s));
  EXPECT_EQ(again.hash, s.hash);
  EXPECT_EQ(sceneContentHash(again), s.hash);
  EXPECT_EQ(again.cameraPaths.at(0).keys.at(1).camera.position, vec3(5, 0, 0));
  Scene slower = s;
  slower.animations[0].keys[1].time = 3;
  EXPECT_NE(sceneContentHash(slower), s.hash);
}

TEST_F(AnimationFiles, BadOnesAreRefused) {
  refused(R"("animations": [{"objects": ["dor"], "keys": [{"time": 0}]}])", {"animations[0].objects", "'dor'", "did you mean 'door'"});
  refused(R"("animations": [{"objects": [], "keys": [{"time": 0}]}])", {"animations[0].objects", "names"});
  refused(R"("animations": [{"objects": ["door"], "keys": []}])", {"animations[0].keys", "at least one"});
  refused(R"("animations": [{"objects": ["door"], "keys": [{"time": 1}]}])", {"animations[0].keys[0].time", "the first key is at 0"});
  refused(R"("animations": [{"objects": ["door"], "keys": [{"time": 0}, {"time": 2}, {"time": 1}]}])", {"keys[2].time", "not after"});
  refused(R"("animations": [{"objects": ["door"], "keys": [{"time": 0, "scale": 0}]}])", {"keys[0].scale", "out of range"});
  refused(R"("animations": [{"objects": ["door"], "repeat": "forever", "keys": [{"time": 0}]}])", {"animations[0].repeat", "once, loop or ping_pong"});
  refused(R"("animations": [{"objects": ["door"], "keys": [{"time": 0, "angel_degrees": 5}]}])", {"keys[0]", "did you mean 'angle_degrees'"});
  refused(R"("animations": [{"light": "lampe", "keys": [{"time": 0, "intensity_factor": 5}]}])", {"animations[0].light", "did you mean 'lamp'"});
  refused(R"("animations": [{"light": "sun", "keys": [{"time": 0, "position": [0, 0, 0]}]}])", {"animations[0].keys", "has no position"});
  refused(R"("animations": [{"light": "sun", "keys": [{"time": 0}]}])", {"keys[0]", "is wanted"});
  refused(R"("camera_paths": [{"name": "a", "keys": [{"time": 0, "position": [0, 0, 0], "target": [0, 0, 0]}]}])", {"camera_paths[0].keys[0].target", "must differ"});
  refused(R"("camera_paths": [{"name": "a", "keys": [{"time": 0, "position": [0, 0, 1], "target": [0, 0, 0]}]},
             {"name": "a", "keys": [{"time": 0, "position": [0, 0, 1], "target": [0, 0, 0]}]}])", {"camera_paths[1].name", "already"});
}

}  // namespace
}  // namespace hl
