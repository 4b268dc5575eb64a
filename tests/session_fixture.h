#pragma once
// A Session under validation with a cache folder of its own, and scenes written on the spot.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "engine/core/files.h"
#include "engine/core/log.h"
#include "engine/session/session.h"

namespace hl::test {

/// Removes its folder on the way out.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "halflight-test-XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }
  std::string write(const std::string& name, const std::string& text) const {
    writeFileAtomically(path_ / name, text);
    return (path_ / name).string();
  }

 private:
  std::filesystem::path path_;
};

class SessionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    setenv("HALFLIGHT_CACHE", folder.path().c_str(), 1);
    setLogLevel(LogLevel::Error);
  }

  /// Every session of these tests runs under validation and synchronisation validation.
  std::unique_ptr<Session> makeSession(const std::string& tracer = "auto") {
    SessionOptions options;
    options.device.validation = true;
    options.tracer = tracer;
    return std::make_unique<Session>(options);
  }
  static void expectNoMessages(Session& session) {
    for (const std::string& message : session.device().takeValidationMessages()) ADD_FAILURE() << message;
  }

  /// Indirect irradiance of the settled picture.
  static Image settledIndirect(Session& session, const Preset& preset) {
    session.load(preset);
    session.settle();
    expectNoMessages(session);
    return session.image("indirect_irradiance");
  }

  TemporaryFolder folder;
};

/// Small enough for a test, large enough to be right: what each technique needs to run quickly.
inline Preset smallPreset(const std::string& scene, const std::string& technique) {
  Preset p;
  p.scene = scene;
  p.technique = technique;
  p.width = 48, p.height = 36;
  p.parameters["direct.samples"] = "16";
  p.parameters["reference.samples"] = "64";
  p.parameters["reference.direct_samples"] = "16";
  if (technique == "radiosity") {
    p.parameters["lightmap.resolution"] = "48";
    p.parameters["radiosity.samples"] = "256";
  }
  if (technique == "srp") {
    p.parameters["lightmap.resolution"] = "48";
    p.parameters["probes.spacing"] = "0.25";
    p.parameters["srp.sh_order"] = "6";
    p.parameters["srp.receiver_rays"] = "256";
    p.parameters["srp.probe_rays"] = "256";
    p.parameters["srp.cluster_size"] = "128";  // so few receivers would otherwise be two clusters of half the room each
    p.parameters["srp.cache"] = "false";
  }
  if (technique == "ddgi") {
    p.parameters["ddgi.spacing"] = "0.25";
    p.parameters["ddgi.rays"] = "128";
    p.parameters["ddgi.hysteresis"] = "0.95";
    p.parameters["ddgi.distance_texels"] = "10";
  }
  if (technique == "surfels") {
    p.parameters["surfels.max_surfels"] = "4096";
    p.parameters["surfels.radius_pixels"] = "2.5";
    p.parameters["surfels.young_rays"] = "0";  // rays for what a moving camera comes to see
    p.parameters["surfels.ray_budget"] = "6";
    p.parameters["surfels.window_growth"] = "64";
    p.parameters["surfels.settle_frames"] = "128";
  }
  return p;
}

/// For what holds at any quality (same bits, finite, linear in light): the same paths with fewer samples.
inline Preset quickPreset(const std::string& scene, const std::string& technique) {
  Preset p = smallPreset(scene, technique);
  if (technique == "radiosity" || technique == "srp") p.parameters["lightmap.resolution"] = "32";
  if (technique == "radiosity") p.parameters["radiosity.samples"] = "64";
  if (technique == "srp") p.parameters["srp.sh_order"] = "3", p.parameters["srp.receiver_rays"] = "64", p.parameters["srp.cluster_size"] = "64";
  if (technique == "ddgi") p.parameters["ddgi.rays"] = "32", p.parameters["ddgi.hysteresis"] = "0.8";
  if (technique == "surfels") p.parameters["surfels.ray_budget"] = "2", p.parameters["surfels.settle_frames"] = "32";
  return p;
}

inline vec3 meanOf(const Image& image) {
  double sum[3] = {0, 0, 0};
  for (size_t i = 0; i < image.pixels(); ++i)
    for (size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(image.data[i * static_cast<size_t>(image.channels) + c]);
  const double n = static_cast<double>(image.pixels());
  return vec3(static_cast<float>(sum[0] / n), static_cast<float>(sum[1] / n), static_cast<float>(sum[2] / n));
}

}  // namespace hl::test
