#pragma once
// Drives the technique `srp`: its precomputation, and frames until nothing changes, without a picture that anybody looks at.
#include <string>
#include <vector>

#include "engine/passes/gbuffer.h"
#include "tests/technique_harness.h"

namespace hl::test {

class SrpHarness : public TechniqueHarness {
 public:
  explicit SrpHarness(Scene theScene, std::string tracerName = "embree") : TechniqueHarness("srp", std::move(theScene), std::move(tracerName)) {
    set("srp.cache", "false").set("srp.compression", "none").set("lightmap.resolution", "64");
  }

  void frame() {
    const Camera camera = scene.cameras.empty() ? Camera() : scene.cameras.front();
    GBuffer g = recordGBuffer(*graph, gpuScene, {}, camera, 16, 16);
    FrameInputs in{g};
    in.frame = frames_, in.sinceChange = sinceChange_, in.seed = seed;
    in.camera = in.previousCamera = camera;
    in.lightsChanged = std::exchange(lightsChanged_, false);
    if (in.lightsChanged) in.sinceChange = sinceChange_ = 0;
    technique->record(*graph, in);
    last = graph->execute();
    ++frames_, ++sinceChange_;
  }
  /// Frames until the technique counts as settled; irradiance at lumels.
  std::vector<vec3> settle() {
    do frame();
    while (sinceChange_ < technique->framesToSettle());
    return technique->lightmapIrradiance();
  }
  std::vector<vec3> light() {
    rebuild();
    work();
    frames_ = sinceChange_ = 0;
    return settle();
  }
  /// The lights of `scene` as they are now; the technique follows them.
  void lightsEdited() {
    device->waitIdle();
    updateLights(*device, gpuScene, scene);
    lightsChanged_ = true;
  }
  double mean(const std::vector<vec3>& e) const { return meanLuminance(e); }

 private:
  uint32_t frames_ = 0, sinceChange_ = 0;
  bool lightsChanged_ = false;
};

}  // namespace hl::test
