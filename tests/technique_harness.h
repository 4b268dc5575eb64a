#pragma once
// Drives one technique on one scene without a Session: device under validation, scene, tracer, direct light, atlas and graph.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/frame_graph.h"
#include "engine/lightmap/atlas.h"
#include "engine/lightmap/inside.h"
#include "engine/params/groups.h"
#include "engine/passes/direct_light.h"
#include "engine/scene/gpu_scene.h"
#include "engine/techniques/technique.h"
#include "engine/trace/tracer.h"

namespace hl::test {

class TechniqueHarness {
 public:
  TechniqueHarness(std::string techniqueId, Scene theScene, std::string tracerId = "embree")
      : scene(std::move(theScene)), features(sceneFeatures(scene)), technique(techniqueInfo(techniqueId).create()), tracerId_(std::move(tracerId)) {
    DeviceOptions options;
    options.validation = true;
    device = std::make_unique<Device>(options);
    shaders = std::make_unique<ShaderLibrary>(*device);
    graph = std::make_unique<FrameGraph>(*device, *shaders);
    params.add(technique->params());
    params.add(lightmapView(lightmap));
    params.add(probesView(probes));
    params.add(directView(direct));
  }
  ~TechniqueHarness() {
    technique.reset();
    directLight.reset();
    tracer.reset();
    graph.reset();
    for (const std::string& message : device->takeValidationMessages()) ADD_FAILURE() << message;
  }

  TechniqueHarness& set(const std::string& key, const std::string& value) {
    const ParamSet::Found found = params.find(key);
    found.view->set(*found.info, parseParam(*found.info, value));
    return *this;
  }

  /// Scene, tracer, atlas and technique, with the parameters as they are.
  void rebuild() {
    gpuScene = uploadScene(*device, scene);
    embree = std::make_shared<EmbreeScene>(scene);
    tracer = makeTracer(tracerId_, *device, *shaders, scene, gpuScene, embree, pool);
    directLight = std::make_unique<DirectLight>(*device, *shaders, gpuScene, *tracer);
    AtlasSettings settings;
    settings.resolution = lightmap.resolution;
    settings.uvOverlapTolerance = lightmap.uv_overlap_tolerance;
    settings.margin = lightmap.margin;
    const auto cast = [this](std::span<const shared::Ray> rays, std::span<shared::Hit> hits) { embree->closest(rays, hits); };
    atlas = buildAtlas(scene, settings, pool, progress, insideTest(scene, pool, kInsideRayOffset * gpuScene.diagonal, cast));
    rebuildTechnique();
  }
  void rebuildTechnique() {
    Gpu gpu{*device, *shaders};
    if (technique->needs().probes) placed = placeProbes(probes, scene, *embree, pool, progress);
    const SceneView view{scene, features, gpuScene, *tracer, *directLight, pool, &atlas, lightmap, direct, seed, technique->needs().probes ? &placed : nullptr};
    technique->rebuild(gpu, view, progress);
    technique->reset();
  }
  /// Scene's lights as they are now, everything else kept.
  void relight() {
    updateLights(*device, gpuScene, scene);
    technique->reset();
  }
  /// Units until settled, or until `units` are done.
  void work(uint64_t units = ~uint64_t{0}) {
    for (uint64_t i = 0; i < units && !technique->work().settled(); ++i) {
      technique->recordWork(*graph);
      last = graph->execute();
    }
  }
  std::vector<vec3> bake() {
    rebuild();
    work();
    return technique->lightmapIrradiance();
  }

  double counter(const std::string& name) const {
    for (const auto& [key, value] : technique->counters())
      if (key == name) return value;
    ADD_FAILURE() << "no counter " << name;
    return -1;
  }
  double meanLuminance(const std::vector<vec3>& irradiance) const {
    double sum = 0, area = 0;
    for (size_t i = 0; i < irradiance.size(); ++i) {
      sum += static_cast<double>(luminance(irradiance[i])) * static_cast<double>(atlas.lumels[i].area);
      area += static_cast<double>(atlas.lumels[i].area);
    }
    return sum / area;
  }

  Scene scene;
  SceneFeatures features;
  LightmapParams lightmap;
  ProbesParams probes;
  DirectParams direct;
  uint32_t seed = 1;
  TaskPool pool;
  Progress progress;
  std::unique_ptr<Device> device;
  std::unique_ptr<ShaderLibrary> shaders;
  std::unique_ptr<FrameGraph> graph;
  GpuScene gpuScene;
  std::shared_ptr<EmbreeScene> embree;
  std::unique_ptr<Tracer> tracer;
  std::unique_ptr<DirectLight> directLight;
  Atlas atlas;
  PlacedProbes placed;
  std::unique_ptr<Technique> technique;
  ParamSet params;
  BatchTimings last;

 private:
  std::string tracerId_;
};

}  // namespace hl::test
