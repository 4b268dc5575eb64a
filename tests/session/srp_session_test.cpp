// Sparse radiance probes through a whole session: what leaks in the picture, ringing, numbers at their ends, work that is cancelled, what is followed and what is not.
#include <algorithm>
#include <cmath>

#include "tests/invariances.h"
#include "tests/session_fixture.h"

namespace hl::test {
namespace {

class SrpSession : public SessionTest {
 protected:
  static Preset onLightmap(const std::string& scene, const std::string& technique, int side) {
    Preset p = smallPreset(scene, technique);
    p.width = 32, p.height = 24;
    std::map<std::string, std::string> changed = {{"direct.samples", "1"}, {"lightmap.resolution", std::to_string(side)}};
    if (technique == "radiosity") changed.insert({"radiosity.samples", "16"});
    if (technique == "srp") changed.insert({{"srp.compression", "none"}, {"srp.receiver_rays", "16"}, {"srp.sh_order", "2"}});
    if (technique == "srp" && scene == "thin_wall_tunnel") changed.insert({"probes.spacing", "0.14"});  // 0.25 of its length leaves no place in a half
    changed.merge(p.parameters);  // keeps what is there
    p.parameters = changed;
    return p;
  }
  /// The picture of the dark side over that of the bright one, by mean luminance. What is below zero counts like what is above.
  static double leak(Session& session) {
    double means[2] = {};
    for (const char* camera : {"lit", "dark"}) {
      session.setCameraName(camera);
      session.settle();
      const Image image = session.image("indirect_irradiance");
      for (size_t i = 0; i < image.pixels(); ++i) {
        const float* v = &image.data[i * static_cast<size_t>(image.channels)];
        means[camera[0] == 'd'] += std::abs(static_cast<double>(luminance(vec3(v[0], v[1], v[2]))));
      }
    }
    EXPECT_GT(means[0], 0);
    expectNoMessages(session);
    return means[1] / means[0];
  }
};

/// Behind a closed door and behind a wall of 2 cm it is dark. Texels that lie on both sides of a wall have one value for both, whatever fills them in: so on coarse
/// lightmaps the rim of walls shines, by probes as by radiosity, which has no probes; and on one of texels small enough nothing is left to see.
TEST_F(SrpSession, NothingLeaksIntoThePictureButWhatTheLightmapLetsThrough) {
  for (const char* scene : {"two_rooms", "thin_wall_tunnel"}) {
    SCOPED_TRACE(scene);
    const auto session = makeSession();
    session->load(onLightmap(scene, "radiosity", 128));
    const double lightmaps = leak(*session);
    session->load(onLightmap(scene, "srp", 128));
    const double coarse = leak(*session);
    session->setParam("srp.compression", "cpca");
    const double compressed = leak(*session);
    session->load(onLightmap(scene, "srp", 256));
    const double fine = leak(*session);
    std::printf("%s: 128^2 radiosity %.2e, srp %.2e, with 32 vectors %.2e; 256^2 srp %.2e\n", scene, lightmaps, coarse, compressed, fine);
    EXPECT_LE(coarse, 1.1 * lightmaps + 1e-4);
    EXPECT_LE(compressed, 1.1 * lightmaps + 1e-3);
    EXPECT_LE(fine, 1e-3);
  }
}

double counterOf(const FrameResult& frame, const std::string& name) {
  for (const auto& [key, value] : frame.counters)
    if (key == name) return value;
  ADD_FAILURE() << "no counter " << name;
  return -1;
}
float least(const Image& image) { return *std::min_element(image.data.begin(), image.data.end()); }
bool finite(const Image& image) {
  return std::all_of(image.data.begin(), image.data.end(), [](float v) { return std::isfinite(v); });
}

/// A box lit in one spot: bands ring round it. What they make negative is counted, cut off or not, and shown as it is unless it is.
TEST_F(SrpSession, RingingIsCountedAndNeverHidden) {
  const std::string file = folder.write("ring.json", R"({"version": 1, "shapes": [{"type": "box", "material": "wall", "min": [-1, -1, -1], "max": [1, 1, 1], "facing": "inward", "face_materials": {"-y": "floor"}}],
    "materials": {"wall": {"albedo": 0.02}, "floor": {"albedo": 0.6, "specular": 0.5, "roughness": 0.3}},
    "lights": [{"type": "spot", "position": [0.95, 0.9, 0.8], "direction": [0, -1, 0.05], "intensity": 50, "inner_degrees": 4, "outer_degrees": 6}],
    "cameras": [{"name": "c", "position": [-0.8, 0.3, -0.9], "target": [0.5, -0.7, 0.6], "vertical_fov_degrees": 80}]})");
  Preset p = onLightmap(file, "srp", 32);
  p.parameters.insert_or_assign("srp.receivers", "radiance");
  p.parameters.insert_or_assign("srp.sample_weight", "valid");  // nothing read off the lightmap: bands alone
  p.parameters.insert_or_assign("srp.receiver_rays", "64");
  p.parameters.insert_or_assign("srp.sh_order", "4");
  p.parameters.insert_or_assign("srp.probe_share", "distance");
  const auto session = makeSession();
  session->load(p);
  const auto plain = session->settle();
  const Image irradiance = session->image("indirect_irradiance");
  EXPECT_GT(counterOf(*plain, "negative_receivers"), 0);
  EXPECT_GT(counterOf(*plain, "negative_reflections"), 0);
  EXPECT_EQ(counterOf(*plain, "lightmap_nan_inf"), 0);
  EXPECT_LT(least(irradiance), 0) << "not hidden";
  session->setParam("srp.clamp_negative", "true");
  session->resetTechnique();
  const auto clamped = session->settle();
  EXPECT_GT(counterOf(*clamped, "negative_receivers"), 0) << "counted before it is cut off";
  EXPECT_GT(counterOf(*clamped, "negative_reflections"), 0);
  EXPECT_GE(least(session->image("indirect_irradiance")), 0);
  expectNoMessages(*session);
}

/// Half precision holds transport, which is geometry; light stays in single precision, however bright.
TEST_F(SrpSession, HalfPrecisionHoldsUnderLightsAHundredThousandTimesBrighter) {
  Preset p = onLightmap("point_light_cube", "srp", 32);
  p.parameters.insert_or_assign("srp.storage", "float16");
  const auto session = makeSession();
  session->load(p);
  session->settle();
  const float before = luminance(meanOf(session->image("indirect_irradiance")));
  std::vector<PointLight> lights = session->scene().pointLights;
  for (PointLight& l : lights) l.intensity *= 1e5f;
  session->setLights(lights, {}, {}, session->scene().sky);
  const auto bright = session->settle();
  const Image image = session->image("indirect_irradiance");
  EXPECT_EQ(counterOf(*bright, "lightmap_nan_inf"), 0);
  EXPECT_TRUE(finite(image));
  EXPECT_GT(before, 0);
  EXPECT_NEAR(luminance(meanOf(image)) / before, 1e5f, 1e3f);
  expectNoMessages(*session);
}

/// Clusters without probes in reach, and clusters of rank 0, among others and alone, through precomputation, runtime and a frame.
TEST_F(SrpSession, EmptyClustersAndThoseOfRankZeroComeThroughAFrame) {
  const std::string room = R"({"type": "box", "material": "wall", "min": [-1, -1, -1], "max": [1, 1, 1], "facing": "inward"})";
  const std::string island = R"({"type": "quad", "material": "wall", "corners": [[20, 0, 0], [20, 0, 2], [22, 0, 2], [22, 0, 0]]})";
  const auto scene = [&](const std::string& name, const std::string& shapes, const std::string& camera) {
    return folder.write(name, R"({"version": 1, "shapes": [)" + shapes + R"(], "materials": {"wall": {"albedo": 0.6}}, "lights": [{"type": "point", "position": [0.2, 0.3, 0.1], "intensity": 5},
      {"type": "point", "position": [21, 1, 1], "intensity": 5}], "probes": [[0, 0.1, 0], [21, 0.5, 1]], "cameras": [)" + camera + "]}");
  };
  const std::string inRoom = R"({"name": "room", "position": [0.8, 0.5, 0.9], "target": [0, -0.5, 0], "vertical_fov_degrees": 80})";
  const std::string atIsland = R"({"name": "island", "position": [21, 2, 3], "target": [21, 0, 1], "vertical_fov_degrees": 60})";
  struct Case {
    std::string file, camera;
    std::map<std::string, std::string> changes;
    bool lit;
    double vectors;  ///< of all clusters; -1: some
  };
  const std::map<std::string, std::string> noneNear = {{"srp.support", "probe_radius"}, {"srp.radius", "0.01"}, {"srp.sample_weight", "valid"}};
  const std::vector<Case> cases = {
      {scene("both.json", room + "," + island, inRoom + "," + atIsland), "room", {}, true, -1},
      {scene("both.json", room + "," + island, inRoom + "," + atIsland), "island", {}, false, -1},
      {scene("island.json", island, atIsland), "island", {{"srp.compression", "cpca"}}, false, 0},
      {scene("both.json", room + "," + island, inRoom + "," + atIsland), "room", noneNear, false, 0},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.file + " " + c.camera);
    Preset p = onLightmap(c.file, "srp", 32);
    p.cameraName = c.camera;
    p.parameters.insert_or_assign("probes.placement", "manual");
    p.parameters.insert_or_assign("srp.compression", "cpca");
    p.parameters.insert_or_assign("srp.cluster_size", "64");
    for (const auto& [key, value] : c.changes) p.parameters.insert_or_assign(key, value);
    const auto session = makeSession();
    session->load(p);
    const auto frame = session->settle();
    EXPECT_FALSE(frame->techniqueFailed) << frame->message;
    EXPECT_GT(counterOf(*frame, "clusters"), 0);
    if (c.vectors >= 0) {
      EXPECT_EQ(counterOf(*frame, "light_vectors"), c.vectors);
    }
    EXPECT_EQ(counterOf(*frame, "lightmap_nan_inf"), 0);
    const Image image = session->image("indirect_irradiance");
    EXPECT_TRUE(finite(image));
    const float mean = luminance(meanOf(image));
    if (c.lit) {
      EXPECT_GT(mean, 0.1f);
    } else {
      EXPECT_EQ(mean, 0.0f);
    }
    expectNoMessages(*session);
  }
}

/// Cancelled midway frames go on without its light; taken up again, in this session or by the disk in the next, the picture is that of one that was never stopped, but for bounces
/// that were still on their way when it settled (the coefficients are the same to the bit: SrpWork).
TEST_F(SrpSession, CancelledPrecomputationGoesOnWhereItWas) {
  Preset p = onLightmap("point_light_cube", "srp", 48);
  p.parameters.insert_or_assign("srp.compression", "cpca");
  p.parameters.insert_or_assign("srp.slice_ms", "1");
  std::vector<float> whole;
  {
    const auto session = makeSession();
    session->load(p);
    session->settle();
    whole = session->image("indirect_irradiance").data;
  }
  const auto off = [&](Session& session) {
    const std::vector<float> now = session.image("indirect_irradiance").data;
    double difference = 0, sum = 0;
    for (size_t i = 0; i < whole.size(); ++i) difference += std::abs(static_cast<double>(now[i] - whole[i])), sum += static_cast<double>(whole[i]);
    return difference / sum;
  };
  p.parameters.insert_or_assign("srp.cache", "true");
  {
    const auto session = makeSession();
    session->load(p);
    std::shared_ptr<const FrameResult> f;
    for (int i = 0; i < 1000 && (!f || f->technique.done < 0.4); ++i) f = session->frame();
    ASSERT_TRUE(f->technique.running);
    ASSERT_LT(f->technique.done, 1);
    session->cancelWork();
    const double at = session->frame()->technique.done;
    f = session->frame();
    EXPECT_FALSE(f->technique.running);
    EXPECT_EQ(f->technique.done, at) << "it has stopped";
    EXPECT_EQ(luminance(meanOf(session->image("indirect_irradiance"))), 0);
    session->restartWork();
    session->settle();
    EXPECT_LT(off(*session), 2e-3);
    expectNoMessages(*session);
  }
  const auto session = makeSession();
  session->load(p);
  const auto f = session->settle();
  EXPECT_EQ(counterOf(*f, "clusters_from_disk"), counterOf(*f, "clusters"));
  EXPECT_LT(off(*session), 2e-3);
}

/// One probe that sees everything has it all; of two, the one behind the block sees less; one far off counts less by its distance.
TEST_F(SrpSession, APickedReceiverTellsTheFactorsOfEachProbesWeight) {
  Preset p = onLightmap(litRoom(folder, kTwoLights[0]), "srp", 32);
  p.parameters.insert_or_assign("probes.placement", "manual");
  p.parameters.insert_or_assign("srp.sample_weight", "valid");
  const auto session = makeSession();
  const auto factsOf = [&](const std::vector<vec3>& probes) {
    p.probes = probes;
    session->load(p);
    session->settle();
    session->pick(16, 12);
    std::vector<std::string> out;
    const auto frame = session->frame();
    for (const auto& [name, text] : frame->pick.facts)
      if (name.starts_with("weight of the probe at")) out.push_back(text);
    return out;
  };
  const auto numberAfter = [](const std::string& text, const std::string& word) {
    const size_t at = text.find(word);
    return at == std::string::npos ? -1.0 : std::stod(text.substr(at + word.size()));
  };
  const std::vector<std::string> one = factsOf({vec3(0.5f, 0.5f, 0.5f)});
  ASSERT_EQ(one.size(), 1u);
  const double all = std::stod(one[0]);
  EXPECT_GT(all, 50) << one[0];
  // Alone its share is 1 wherever it sees what is hit: in a closed room the two shares are one number.
  EXPECT_NEAR(numberAfter(one[0], "sees "), all, 0.11) << one[0];
  EXPECT_GT(numberAfter(one[0], "solid angle "), 0) << one[0];
  const std::vector<std::string> two = factsOf({vec3(0.5f, 0.5f, 0.5f), vec3(-0.9f, -0.9f, -0.9f)});
  ASSERT_EQ(two.size(), 2u);
  EXPECT_GT(std::stod(two[0]), std::stod(two[1])) << "those with the largest share first";
  EXPECT_GT(numberAfter(two[0], "distance "), numberAfter(two[1], "distance "));
  EXPECT_GT(numberAfter(two[0], "sees "), numberAfter(two[1], "sees ")) << two[1];
  EXPECT_LE(std::stod(two[0]) + std::stod(two[1]), 100.2);
  expectNoMessages(*session);
}

/// Transport is geometry's: another sun needs none anew, and says nothing; a block that has moved does, and says so.
TEST_F(SrpSession, TheSunMovesWithoutPrecomputationAndGeometryWithIt) {
  const std::string file = folder.write("sun.json", R"({"version": 1, "shapes": [
    {"type": "quad", "material": "wall", "corners": [[-2, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]]},
    {"type": "quad", "material": "wall", "corners": [[-2, 0, -2], [2, 0, -2], [2, 2, -2], [-2, 2, -2]]},
    {"type": "box", "name": "block", "material": "wall", "min": [-0.5, 0.1, -1], "max": [0.5, 1, 0]}],
    "materials": {"wall": {"albedo": 0.6}}, "lights": [{"type": "directional", "direction": [0.3, -1, -0.4], "irradiance": 10}],
    "cameras": [{"name": "c", "position": [1.5, 1.5, 3], "target": [0, 0.5, -0.5], "vertical_fov_degrees": 60}],
    "animations": [{"name": "slide", "objects": ["block"], "repeat": "once", "keys": [{"time": 0}, {"time": 1, "translation": [0.8, 0, 0]}]}]})");
  Preset p = onLightmap(file, "srp", 32);
  const auto session = makeSession();
  int told = 0;
  session->tellRebuilds([&](const RebuildForecast& f) {
    ++told;
    EXPECT_EQ(forecastText(f).find("transport: "), 0u) << forecastText(f);
  });
  session->load(p);
  const auto first = session->settle();
  const std::vector<float> before = session->image("indirect_irradiance").data;
  ASSERT_EQ(told, 1);
  std::vector<DirectionalLight> suns = session->scene().directionalLights;
  ASSERT_EQ(suns.size(), 1u);
  suns[0].direction = glm::normalize(vec3(-0.6f, -0.7f, -0.2f));
  session->setLights({}, {}, suns, session->scene().sky);
  const auto sun = session->settle();
  EXPECT_EQ(told, 1) << "nothing was computed anew";
  EXPECT_EQ(sun->workUnits, first->workUnits);
  const std::vector<float> moved = session->image("indirect_irradiance").data;
  EXPECT_NE(moved, before);
  // As if it had always been there.
  Preset there = p;
  session->load(there);
  session->setLights({}, {}, suns, session->scene().sky);
  session->settle();
  const Image fresh = session->image("indirect_irradiance");
  double off = 0, sum = 0;
  for (size_t i = 0; i < moved.size(); ++i) off += std::abs(static_cast<double>(moved[i] - fresh.data[i])), sum += std::abs(static_cast<double>(fresh.data[i]));
  EXPECT_LT(off, 1e-3 * sum);

  told = 0;
  session->setTime(1);
  const auto block = session->settle();
  EXPECT_EQ(told, 1) << "the block has moved: transport is computed anew";
  EXPECT_GT(block->workUnits, 0u);
  expectNoMessages(*session);
}

}  // namespace
}  // namespace hl::test
