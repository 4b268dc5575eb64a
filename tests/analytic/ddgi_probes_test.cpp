// What probes must do whatever the light is: repeat themselves, mind no camera, survive NaN, stand outside geometry, and refuse what cannot be.
#include <cmath>
#include <limits>

#include "engine/core/hash.h"
#include "tests/session_fixture.h"

namespace hl::test {
namespace {

class DdgiProbesTest : public SessionTest {
 protected:
  Preset small(const std::string& scene = "cornell_box") {
    Preset p = smallPreset(scene, "ddgi");
    p.width = 32, p.height = 24;
    p.parameters["ddgi.rays"] = "64";
    return p;
  }
  static GpuImage view(Session& session, const std::string& id) {
    for (const DebugView& v : session.technique().debugViews())
      if (v.id == id) return v.image;
    ADD_FAILURE() << "no view " << id;
    return {};
  }
  static std::string atlases(Session& session) {
    Hasher h;
    for (const char* id : {"irradiance_atlas", "distance_atlas"}) h.array(session.device().download(view(session, id)).data);
    return h.hex();
  }
  static double counter(const FrameResult& f, const std::string& name) {
    for (const auto& [key, value] : f.counters)
      if (key == name) return value;
    ADD_FAILURE() << "no counter " << name;
    return -1;
  }
  static std::shared_ptr<const FrameResult> frames(Session& session, int n) {
    std::shared_ptr<const FrameResult> f;
    for (int i = 0; i < n; ++i) f = session.frame();
    return f;
  }
};

TEST_F(DdgiProbesTest, SameBitsTwiceAndWhateverTheCameraDoes) {
  auto session = makeSession();
  session->load(small());
  frames(*session, 6);
  const std::string still = atlases(*session);
  session->resetTechnique();
  Camera camera = session->scene().cameras.front();
  for (int i = 0; i < 6; ++i) {
    camera.position = camera.position + vec3(0.03f, 0.01f, 0.05f);
    session->setCamera(camera);
    EXPECT_EQ(session->frame()->frame, static_cast<uint32_t>(i) + 1) << "a camera must not reset the probes";
  }
  EXPECT_EQ(atlases(*session), still);
  expectNoMessages(*session);
}

TEST_F(DdgiProbesTest, BatchesDoNotShow) {
  auto session = makeSession();
  Preset p = small("furnace_box_050");
  p.parameters["ddgi.rays"] = "1024";
  p.parameters["ddgi.spacing"] = "0.17";  // more rays than a batch holds
  p.parameters["ddgi.distance_texels"] = "4";
  session->load(p);
  const auto f = frames(*session, 9);
  EXPECT_GT(counter(*f, "probes") * 1024, 1 << 18);
  const double emission = static_cast<double>(session->scene().materials.front().emission.x);
  const Image e = session->image("indirect_irradiance");
  const double expected = 3.14159265358979 * emission * (1 - std::pow(0.5, 9.0));  // frames without history, a bounce each, at first
  for (size_t i = 0; i < e.pixels(); ++i) ASSERT_NEAR(static_cast<double>(e.data[i * static_cast<size_t>(e.channels)]), expected, 0.05 * expected);
  EXPECT_NEAR(static_cast<double>(meanOf(e).x), expected, 0.01 * expected);
  expectNoMessages(*session);
}

TEST_F(DdgiProbesTest, NanAndInfAreCountedUntilOneReset) {
  auto session = makeSession();
  session->load(small());
  EXPECT_EQ(counter(*frames(*session, 3), "probe_nan"), 0);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const GpuImage atlas = view(*session, "irradiance_atlas");
    const std::vector<float> texels(static_cast<size_t>(atlas.width()) * static_cast<size_t>(atlas.height()) * 4, bad);
    session->device().upload(atlas, 0, texels.data(), texels.size() * sizeof(float));
    const auto ill = frames(*session, 2);
    EXPECT_GT(counter(*ill, "probe_nan") + counter(*ill, "probe_inf"), 0);
    EXPECT_GT(counter(*ill, "nan_inf"), 0);
    session->resetTechnique();
    const auto well = session->frame();
    EXPECT_EQ(counter(*well, "probe_nan") + counter(*well, "probe_inf"), 0);
    EXPECT_EQ(counter(*well, "nan_inf"), 0);
    for (const float v : session->image("indirect_irradiance").data) ASSERT_TRUE(std::isfinite(v));
  }
  expectNoMessages(*session);
}

/// A room with a block that holds whole probes, and a thick wall.
TEST_F(DdgiProbesTest, NoProbeIsAskedFromInsideGeometry) {
  const std::string scene = folder.write("blocks.json", R"({"version": 1, "shapes": [
    {"type": "box", "material": "wall", "min": [-2, -2, -2], "max": [2, 2, 2], "facing": "inward"},
    {"type": "box", "material": "wall", "min": [-1.2, -1.9, -1.3], "max": [1.1, 0.4, 1.2]},
    {"type": "quad", "material": "lamp", "corners": [[-0.3, 1.98, -0.3], [0.3, 1.98, -0.3], [0.3, 1.98, 0.3], [-0.3, 1.98, 0.3]]}],
    "materials": {"wall": {"albedo": [0.7, 0.7, 0.7]}, "lamp": {"albedo": [0, 0, 0], "emission": [10, 10, 10]}},
    "cameras": [{"name": "c", "position": [1.8, 1.6, 1.8], "target": [0, -0.5, 0], "vertical_fov_degrees": 75}]})");
  auto session = makeSession();
  Preset p = small(scene);
  p.parameters["ddgi.spacing"] = "0.125";
  session->load(p);
  session->pick(16, 12);
  const auto f = frames(*session, 12);
  EXPECT_GT(counter(*f, "probes_inside"), 4);
  EXPECT_GT(counter(*f, "relocated_probes"), 4);
  EXPECT_EQ(counter(*f, "pixels_without_probe"), 0);
  EXPECT_EQ(counter(*f, "hits_without_probe"), 0);
  const Image e = session->image("indirect_irradiance");
  for (const float v : e.data) {
    ASSERT_TRUE(std::isfinite(v));
    ASSERT_GT(v, 0.0f);
  }
  ASSERT_EQ(f->pick.samples.size(), 8u);
  float sum = 0;
  for (const PickSample& s : f->pick.samples) sum += s.weight;
  EXPECT_NEAR(sum, 1, 1e-5);
  EXPECT_EQ(f->pick.facts.size(), 10u);
  expectNoMessages(*session);
}

TEST_F(DdgiProbesTest, TooManyProbesAreRefusedWithTheWayOut) {
  auto session = makeSession();
  session->load(small());
  session->setParam("ddgi.spacing", "0.01");
  const auto f = session->frame();
  EXPECT_TRUE(f->techniqueFailed);
  EXPECT_NE(f->message.find("raise ddgi.spacing"), std::string::npos) << f->message;
  session->setParam("ddgi.spacing", "0.25");
  EXPECT_FALSE(session->frame()->techniqueFailed);
  expectNoMessages(*session);
}

TEST_F(DdgiProbesTest, ViewsShowProbesAndMapsHaveNoSeam) {
  auto session = makeSession();
  Preset p = small();
  session->load(p);
  frames(*session, 2);
  for (const char* id : {"probes", "probe_states", "distances"}) {
    Display d = session->preset().display;
    d.view = id;
    session->setDisplay(d);
    session->frame();
    double sum = 0;
    for (const float v : session->image(id).data) {
      ASSERT_TRUE(std::isfinite(v));
      sum += static_cast<double>(v);
      if (std::string(id) == "distances") {
        ASSERT_LE(v, 1.0001f);  // a mean of distances that are cut there, to rounding
      }
    }
    EXPECT_GT(sum, 0) << id;
  }
  // Each border texel repeats an interior one of its own tile: corners the opposite corner.
  const Image atlas = session->device().download(view(*session, "irradiance_atlas"));
  const int texels = 6, side = texels + 2;
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(atlas.pixel(0, 0)[c], atlas.pixel(texels, texels)[c]);
    EXPECT_EQ(atlas.pixel(side - 1, 0)[c], atlas.pixel(1, texels)[c]);
    for (int i = 1; i <= texels; ++i) {
      EXPECT_EQ(atlas.pixel(i, 0)[c], atlas.pixel(texels + 1 - i, 1)[c]);
      EXPECT_EQ(atlas.pixel(side - 1, i)[c], atlas.pixel(texels, texels + 1 - i)[c]);
    }
  }
  expectNoMessages(*session);
}

}  // namespace
}  // namespace hl::test
