#pragma once
// Drives the technique `surfels` frame by frame, with cameras, lights and parameters of a test's own choosing, under validation.
#include <cmath>
#include <functional>

#include "engine/passes/gbuffer.h"
#include "tests/technique_harness.h"

namespace hl::test {

class SurfelsHarness : public TechniqueHarness {
 public:
  explicit SurfelsHarness(Scene theScene, std::string tracerName = "embree") : TechniqueHarness("surfels", std::move(theScene), std::move(tracerName)) {
    lightmap.resolution = 32;  // the harness makes one; surfels have none
  }

  /// One frame as a session would record it. Returns indirect irradiance at pixels (RGBA; alpha: coverage).
  void frame(const Camera& camera) {
    GBuffer g = recordGBuffer(*graph, gpuScene, {}, camera, width, height);
    FrameInputs in{g};
    in.frame = frames, in.seed = seed;
    in.camera = camera, in.previousCamera = camera;
    in.lightsChanged = std::exchange(lightsChanged_, false);
    light_ = technique->record(*graph, in).irradiance;
    last = graph->execute();
    ++frames;
  }
  Image irradiance() { return device->download(light_); }
  /// Mean of a channel over pixels that show a surface (coverage above 0 where they have a surfel).
  double mean(int channel = 1) {
    const Image image = irradiance();
    double sum = 0;
    for (size_t i = 0; i < image.pixels(); ++i) sum += static_cast<double>(image.data[4 * i + static_cast<size_t>(channel)]);
    return sum / static_cast<double>(image.pixels());
  }
  /// The camera turns on the spot through all directions, `each` frames for each of six views of a right angle and more.
  void turn(vec3 from, int each) {
    const vec3 directions[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (const vec3 d : directions) {
      Camera c;
      c.position = from, c.target = from + d;
      c.up = std::abs(d.y) > 0.5f ? vec3(1, 0, 0) : vec3(0, 1, 0);
      c.verticalFov = 1.75f;
      for (int i = 0; i < each; ++i) frame(c);
    }
  }
  /// Emission of all materials; the cache is not told to start anew, as in a session.
  void shine(float emission) {
    for (Material& m : scene.materials) m.emission = vec3(emission);
    device->waitIdle();
    updateLights(*device, gpuScene, scene);
    lightsChanged_ = true;
  }
  void lightsEdited() {
    device->waitIdle();
    updateLights(*device, gpuScene, scene);
    lightsChanged_ = true;
  }

  int width = 64, height = 64;
  uint32_t frames = 0;

 private:
  GpuImage light_;
  bool lightsChanged_ = false;
};

}  // namespace hl::test
