// Sparse radiance probes through a whole session: what leaks in the picture.
#include <cmath>

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

}  // namespace
}  // namespace hl::test
