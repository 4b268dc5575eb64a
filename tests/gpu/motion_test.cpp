// Posed vertices on the device, and motion vectors against points carried along on the host.
#include <cmath>

#include "engine/passes/gbuffer.h"
#include "engine/passes/pose.h"
#include "engine/scene/scene_pose.h"
#include "tests/gpu_fixture.h"
#include "tests/moving_scenes.h"

namespace hl {
namespace {

constexpr int kWidth = 64, kHeight = 48;

class MotionTest : public test::GpuTest {
 protected:
  void make(Scene rest) {
    scene = std::move(rest);
    pose = ScenePose(scene);
    gpuScene = uploadScene(*device, scene);
  }
  void moveTo(double time) {
    const ScenePose::Changed changed = pose.apply(scene, time);
    if (changed.transforms) updateTransforms(*device, gpuScene, pose.transforms());
    if (changed.geometry) recordPose(*graph, gpuScene);
  }
  GBuffer render(const Camera& now, const Camera& before) {
    GBuffer g = recordGBuffer(*graph, gpuScene, Buffer(), now, kWidth, kHeight);
    recordMotion(*graph, g, gpuScene, now, before);
    graph->execute();
    return g;
  }
  static Camera camera() {
    Camera c;
    c.position = vec3(0.5f, 0.5f, 0.95f), c.target = vec3(0.5f, 0.45f, 0), c.verticalFov = 1.2f;
    return c;
  }
  /// Where a camera sees a point, in pixels.
  static vec2 seenAt(const Camera& c, vec3 p) {
    const vec4 clip = cameraMatrix(c, static_cast<float>(kWidth) / kHeight) * vec4(p, 1);
    return vec2((clip.x / clip.w * 0.5f + 0.5f) * kWidth, (clip.y / clip.w * 0.5f + 0.5f) * kHeight);
  }

  Scene scene;
  ScenePose pose;
  GpuScene gpuScene;
};

TEST_F(MotionTest, DeviceAndHostPoseAlike) {
  make(test::turningRoom());
  for (const double time : {0.3, 1.9, 0.0}) {
    moveTo(time);
    graph->execute();
    const std::vector<vec3> positions = download<vec3>(gpuScene.positions), normals = download<vec3>(gpuScene.normals);
    for (size_t v = 0; v < positions.size(); ++v) {
      ASSERT_LT(glm::length(positions[v] - scene.positions[v]), 1e-6f) << v;
      ASSERT_LT(glm::length(normals[v] - scene.normals[v]), 2e-6f) << v;
    }
  }
}

TEST_F(MotionTest, IsExactlyZeroWhereNothingMoved) {
  make(test::turningRoom());
  moveTo(0.5), moveTo(0.5);
  const GBuffer g = render(camera(), camera());
  for (const float v : device->download(g.motion).data) ASSERT_EQ(v, 0.0f);
}

TEST_F(MotionTest, FollowsObjectsAndCamera) {
  make(test::turningRoom());
  Camera before = camera();
  before.position += vec3(0.02f, -0.01f, 0), before.target.x += 0.03f;
  moveTo(0.4);
  graph->execute();
  const std::vector<vec3> old = scene.positions;
  moveTo(0.45);
  const GBuffer g = render(camera(), before);
  const Image motion = device->download(g.motion), position = device->download(g.position);
  std::vector<uint32_t> ids(position.pixels() * 2);
  device->download(g.ids, ids.data(), ids.size() * sizeof(uint32_t));
  const std::vector<bool> moving = movingTriangles(scene);
  size_t onMoving = 0, seen = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const size_t i = static_cast<size_t>(y) * kWidth + static_cast<size_t>(x);
      if (ids[2 * i] == 0) continue;
      const uint32_t triangle = ids[2 * i] - 1;
      ++seen, onMoving += moving[triangle];
      // Barycentrics of the point now, and the same point of the triangle before.
      const uvec3 t = scene.indices[triangle];
      const float* at = position.pixel(x, y);
      const glm::dvec3 p(at[0], at[1], at[2]), a(scene.positions[t.x]), b(scene.positions[t.y]), c(scene.positions[t.z]);
      const glm::dvec3 n = glm::cross(b - a, c - a);
      const double area = glm::dot(n, n);
      const double v = glm::dot(glm::cross(p - a, c - a), n) / area, w = glm::dot(glm::cross(b - a, p - a), n) / area;
      const glm::dvec3 was = (1 - v - w) * glm::dvec3(old[t.x]) + v * glm::dvec3(old[t.y]) + w * glm::dvec3(old[t.z]);
      const vec2 expected = seenAt(before, vec3(was)) - vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const float* m = motion.pixel(x, y);
      // Thin slivers do not determine their barycentrics better.
      ASSERT_NEAR(m[0], expected.x, 0.02f) << x << ", " << y;
      ASSERT_NEAR(m[1], expected.y, 0.02f) << x << ", " << y;
    }
  EXPECT_GT(seen, size_t{kWidth * kHeight / 2});
  EXPECT_GT(onMoving, 50u);
}

TEST_F(MotionTest, TheSkyTurnsWithTheCameraAlone) {
  Scene empty;
  test::addTriangle(empty, vec3(100, 100, 100), vec3(101, 100, 100), vec3(100, 101, 100), test::addMaterial(empty));
  make(empty);
  Camera now, moved = now;
  now.position = vec3(0), now.target = vec3(0, 0, -1);
  moved = now;
  moved.position += vec3(3, 2, 1), moved.target += vec3(3, 2, 1);
  for (const float v : device->download(render(now, moved).motion).data) ASSERT_NEAR(v, 0, 1e-3f);
  moved = now;
  moved.target.x = 0.05f;
  const Image turned = device->download(render(now, moved).motion);
  const float* centre = turned.pixel(kWidth / 2, kHeight / 2);
  EXPECT_LT(centre[0], -1.0f) << "the previous camera looked further to the right: what is in the middle now was left of it";
}

}  // namespace
}  // namespace hl
