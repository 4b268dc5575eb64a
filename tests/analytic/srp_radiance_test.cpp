// Radiance receivers of srp: what lobes reflect of the indirect light, against closed forms and the matched reference.
#include <cmath>
#include <numeric>

#include "engine/passes/gbuffer.h"
#include "engine/techniques/srp/hemisphere_basis.h"
#include "tests/ggx_integral.h"
#include "tests/session_fixture.h"

namespace hl::test {
namespace {

TEST(HemisphereBasis, IsOrthonormalForItsWeightAndFewerDegreesAreItsBeginning) {
  using namespace shared;
  constexpr int kRings = 400, kSteps = 64, kTerms = kHemisphereMaxTerms;
  ASSERT_EQ(hemisphereTerms(kHemisphereMaxDegree), kTerms);
  std::vector<double> gram(kTerms * kTerms, 0.0);
  std::vector<HemisphereTerm> terms;
  for (int j = 0; j < kTerms; ++j) {
    terms.push_back(hemisphereTerm(j));
    const int m = terms.back().m, degree = std::abs(m) + 2 * terms.back().k;
    EXPECT_EQ(hemisphereIndex(degree, m), j);
    EXPECT_LT(j, hemisphereTerms(degree));
    EXPECT_GE(j, degree > 0 ? hemisphereTerms(degree - 1) : 0);
  }
  for (int i = 0; i < kRings; ++i)
    for (int k = 0; k < kSteps; ++k) {
      // z = u^2, so that sqrt(z) dz is a polynomial.
      const double u = (i + 0.5) / kRings, z = u * u, r = std::sqrt(1 - z * z), phi = 2 * kPiDouble * (k + 0.5) / kSteps;
      const double weight = 2 * u * u / kRings * 2 * kPiDouble / kSteps;
      double value[kTerms];
      for (int j = 0; j < kTerms; ++j) value[j] = static_cast<double>(hemisphereValue(terms[static_cast<size_t>(j)], static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi))));
      for (int a = 0; a < kTerms; ++a)
        for (int b = 0; b <= a; ++b) gram[static_cast<size_t>(a * kTerms + b)] += weight * value[a] * value[b];
    }
  for (int a = 0; a < kTerms; ++a)
    for (int b = 0; b <= a; ++b) EXPECT_NEAR(gram[static_cast<size_t>(a * kTerms + b)], a == b ? 1 : 0, 2e-3) << a << ", " << b;
}

class RadianceReceivers : public SessionTest {
 protected:
  /// A closed room of 2 m whose floor is glossy; `white`, `left`: the other materials. Without lights the floor shines as the test's walls do.
  std::string room(const std::string& white, const std::string& left, const std::string& lights, double albedo, double f0, double roughness) {
    return folder.write("glossy.json", R"({"version": 1, "lightmap_uvs": true,
      "shapes": [{"type": "box", "name": "room", "min": [-1, 0, -1], "max": [1, 2, 1], "facing": "inward", "material": "white", "face_materials": {"-x": "left", "-y": "glossy"}}],
      "materials": {"white": )" + white + R"(, "left": )" + left + R"(, "glossy": {"albedo": )" + std::to_string(albedo) + R"(, "specular": )" + std::to_string(f0) + R"(, "roughness": )" +
                                           std::to_string(roughness) + (lights.empty() ? R"(, "emission": 1)" : "") + R"(}}, "lights": [)" + lights + R"(],
      "cameras": [{"name": "floor", "position": [0.7, 1.1, 0.9], "target": [-0.3, 0, -0.3], "vertical_fov_degrees": 60}]})");
  }
  /// The same with a lamp, and a red wall on the left.
  std::string lampRoom() {
    return room(R"({"albedo": 0.7})", R"({"albedo": [0.7, 0.1, 0.1]})", R"({"type": "point", "name": "lamp", "position": [0.3, 1.4, 0.1], "intensity": 5})", 0.3, 0.5, 0.4);
  }
  Preset preset(const std::string& scene, int order) {
    Preset p = smallPreset(scene, "srp");
    p.parameters["lightmap.resolution"] = "32";
    p.parameters["srp.sh_order"] = "3";
    p.parameters["srp.k"] = "4";
    p.parameters["srp.receivers"] = "radiance";
    p.parameters["srp.glossy_order"] = std::to_string(order);
    p.parameters["srp.compression"] = "none";
    return p;
  }
  static double error(Session& session, const std::string& metric) {
    for (const ErrorValue& e : session.measureErrors({metric}))
      if (e.reference == "matched" && e.component == "specular" && e.roi.empty()) return e.value;
    ADD_FAILURE() << "no " << metric << " of what is reflected";
    return NAN;
  }
  /// Norm of the difference from the matched reference, over the reference's.
  static double norm(Session& session) {
    const Image a = session.image("specular"), b = session.image("reference_matched_specular");
    double difference = 0, all = 0;
    for (size_t i = 0; i < b.data.size(); ++i) {
      const auto v = static_cast<double>(a.data[i]), r = static_cast<double>(b.data[i]);
      difference += (v - r) * (v - r), all += r * r;
    }
    return std::sqrt(difference / all);
  }
  /// Sum of the differences' amounts over the sum of `a`.
  static double apart(const Image& a, const Image& b) {
    double difference = 0, all = 0;
    for (size_t i = 0; i < a.data.size(); ++i)
      difference += std::abs(static_cast<double>(a.data[i]) - static_cast<double>(b.data[i])), all += static_cast<double>(a.data[i]);
    return difference / all;
  }
  static double counter(Session& session, const std::string& name) {
    const auto result = session.frame();
    for (const auto& [key, value] : result->counters)
      if (key == name) return value;
    ADD_FAILURE() << "no counter " << name;
    return -1;
  }
};

// All walls shine with radiance 1 and reflect half: what they reflect is 1 from everywhere, and the lobe gives its directional albedo of that.
TEST_F(RadianceReceivers, ConstantRadianceGivesTheDirectionalAlbedo) {
  const std::string wall = R"({"albedo": 0.5, "emission": 1})";
  for (const double roughness : {0.3, 0.9}) {
    const std::string scene = room(wall, wall, "", 0.5, 0.4, roughness);
    for (const bool compressed : {false, true}) {
      auto session = makeSession();
      Preset p = preset(scene, 4);
      if (compressed) p.parameters["srp.compression"] = "cpca", p.parameters["srp.pca_vectors"] = "24";
      session->load(p);
      session->settle();
      expectNoMessages(*session);
      const Image seen = session->image("specular"), position = session->image("position");
      const Camera camera = session->frame()->camera;
      double worst = 0, mean = 0, count = 0;
      for (int y = 0; y < seen.height; y += 3)
        for (int x = 0; x < seen.width; x += 3) {
          const size_t i = static_cast<size_t>(y) * static_cast<size_t>(seen.width) + static_cast<size_t>(x);
          const vec3 at(position.data[i * static_cast<size_t>(position.channels)], position.data[i * static_cast<size_t>(position.channels) + 1], position.data[i * static_cast<size_t>(position.channels) + 2]);
          if (at.y > 1e-3f) {
            ASSERT_EQ(seen.data[i * 3], 0) << "a wall that is not glossy";
            continue;
          }
          const double cosine = static_cast<double>(glm::normalize(camera.position - at).y);
          const double off = static_cast<double>(seen.data[i * 3]) / directionalAlbedo(0.4, cosine, roughness, 200) - 1;
          worst = std::max(worst, std::abs(off)), mean += off, ++count;
        }
      ASSERT_GT(count, 50);
      std::printf("roughness %.1f, %s: mean %+.4f, worst %.4f of the directional albedo\n", roughness, compressed ? "24 vectors" : "uncompressed", mean / count, worst);
      EXPECT_LT(std::abs(mean / count), 0.006);
      EXPECT_LT(worst, 0.015);
    }
  }
}

// A wall that is lit beside others that are nearly black: the lobe's light has an edge, and the band limit blurs it the less the higher the order.
TEST_F(RadianceReceivers, ABrightWallComesNearerWithTheOrder) {
  const std::string scene = room(R"({"albedo": 0.1})", R"({"albedo": 0.8})", R"({"type": "point", "name": "lamp", "position": [0.2, 1, 0.3], "intensity": 5})",
                                 0.05, 0.6, 0.5);
  std::vector<double> errors;
  for (const int order : {0, 4, 7}) {
    auto session = makeSession();
    Preset p = preset(scene, order);
    p.parameters["srp.sh_order"] = "7";
    session->load(p);
    session->settle();
    session->reference();
    expectNoMessages(*session);
    errors.push_back(norm(*session));
    std::printf("order %d: %.4f of the norm, bias %+.4f; %g pixels below 0\n", order, errors.back(), error(*session, "bias"), counter(*session, "negative_reflections"));
    EXPECT_EQ(counter(*session, "reflections_nan_inf"), 0);
    EXPECT_EQ(counter(*session, "reflections_without_texel"), 0);
    if (order == 7) {
      EXPECT_LT(std::abs(error(*session, "bias")), 0.02);
    }
  }
  EXPECT_LT(errors[1], 0.25 * errors[0]);
  EXPECT_LT(errors[2], 0.9 * errors[1]);
  EXPECT_LT(errors[2], 0.06);
}

TEST_F(RadianceReceivers, GlossySurfacesAloneHaveMoreRowsAndTheOthersKeepTheirLight) {
  const std::string scene = lampRoom();
  const auto run = [&](const char* receivers, const char* limit = "0") {
    auto session = makeSession();
    Preset p = quickPreset(scene, "srp");
    p.parameters["srp.compression"] = "none";
    p.parameters["srp.receivers"] = receivers;
    p.parameters["srp.glossy_order"] = "3";
    p.parameters["srp.blur_limit"] = limit;
    session->load(p);
    session->settle();
    expectNoMessages(*session);
    return session;
  };
  auto plain = run("irradiance"), radiance = run("radiance");
  const double receivers = counter(*radiance, "receivers"), glossy = counter(*radiance, "glossy_receivers");
  EXPECT_GT(glossy, 0);
  EXPECT_LT(glossy, 0.3 * receivers);  // one of six walls
  // Rows are kept with as many columns as their cluster has; clusters are alike here.
  const double ratio = counter(*radiance, "uncompressed_bytes") / counter(*plain, "uncompressed_bytes");
  EXPECT_NEAR(ratio, 1 + 10 * glossy / receivers, 0.15 * ratio);
  const Image a = plain->image("indirect_irradiance"), b = radiance->image("indirect_irradiance");
  for (size_t i = 0; i < a.data.size(); ++i) ASSERT_NEAR(b.data[i], a.data[i], 1e-5f * std::abs(a.data[i]) + 1e-7f);
  // The limit is for receivers without reflections alone: walls hardly miss it on the floor.
  const Image limited = run("irradiance", "1")->image("indirect_irradiance"), limitedRadiance = run("radiance", "1")->image("indirect_irradiance");
  std::printf("blur_limit moves light by %.4f; with reflections on the floor by %.4f of that\n", apart(limited, a), apart(limited, limitedRadiance) / apart(limited, a));
  EXPECT_GT(apart(limited, a), 0.005);
  EXPECT_LT(apart(limited, limitedRadiance), 0.7 * apart(limited, a));
  // No glossy surface: nothing but the name differs.
  const auto diffuse = [&](const char* kind) { return settledIndirect(*makeSession(), [&] {
    Preset p = quickPreset("point_light_cube", "srp");
    p.parameters["srp.receivers"] = kind;
    return p;
  }()); };
  EXPECT_EQ(diffuse("irradiance").data, diffuse("radiance").data);
}

TEST_F(RadianceReceivers, AreTheSameToTheBitWhateverMemoryThereIs) {
  const std::string scene = lampRoom();
  std::vector<float> images[2];
  uint64_t units[2] = {};
  for (int i = 0; i < 2; ++i) {
    auto session = makeSession();
    Preset p = quickPreset(scene, "srp");
    p.parameters["srp.receivers"] = "radiance", p.parameters["srp.cache"] = "false";
    p.parameters["srp.sh_order"] = "0", p.parameters["srp.glossy_order"] = "2", p.parameters["srp.k"] = "8", p.parameters["lightmap.resolution"] = "48";
    p.parameters["srp.cluster_size"] = "1024", p.parameters["srp.least_clusters"] = "1", p.parameters["srp.precompute_memory_mb"] = i == 0 ? "512" : "4";
    session->load(p);
    session->settle();
    images[i] = session->image("specular").data;
    units[i] = session->frame()->workUnits;
    ASSERT_GT(units[i], 0u) << session->frame()->message;
  }
  EXPECT_GT(units[1], units[0]);
  EXPECT_EQ(images[0], images[1]);
}

// Two triangles of one wall whose normals differ by less than shows, but in the sign of z, where the frames of their receivers turn half round.
TEST_F(RadianceReceivers, AWallOfTwoNormalsIsOneWall) {
  const auto reflections = [&](const char* x) {
    const std::string corners = std::string("[[-1, 0, 1], [") + x + ", 0, -1], [-1, 2, -1], [" + x + ", 2, 1]]";
    Preset p = quickPreset(folder.write("wall.json", R"({"version": 1, "lightmap_uvs": true, "shapes": [
        {"type": "box", "name": "room", "min": [-1, 0, -1], "max": [1, 2, 1], "facing": "inward", "faces": ["+x", "-y", "+y", "-z", "+z"], "material": "white", "face_materials": {"-z": "red"}},
        {"type": "quad", "name": "wall", "material": "glossy", "corners": )" + corners + R"(}],
      "materials": {"white": {"albedo": 0.7}, "red": {"albedo": [0.7, 0.1, 0.1]}, "glossy": {"albedo": 0.02, "specular": 0.9, "roughness": 0.4}},
      "lights": [{"type": "point", "name": "lamp", "position": [0.3, 1.4, 0.1], "intensity": 5}],
      "cameras": [{"name": "wall", "position": [0.9, 1, 0.1], "target": [-1, 1, 0], "vertical_fov_degrees": 70}]})"), "srp");
    p.parameters["srp.receivers"] = "radiance", p.parameters["srp.compression"] = "none";
    auto session = makeSession();
    session->load(p);
    session->settle();
    return session->image("specular");
  };
  const Image flat = reflections("-1"), bent = reflections("-0.99999976");
  ASSERT_GT(std::accumulate(flat.data.begin(), flat.data.end(), 0.0), 0);
  const double difference = apart(flat, bent);
  std::printf("a wall of two normals: reflections differ by %.4f of their mean\n", difference);
  EXPECT_LT(difference, 0.02);
}

TEST_F(RadianceReceivers, WhatTheDiskHasIsTheSameToTheBit) {
  const std::string scene = lampRoom();
  std::vector<float> images[3];
  for (int i = 0; i < 3; ++i) {
    auto session = makeSession();
    Preset p = quickPreset(scene, "srp");
    p.parameters["srp.receivers"] = "radiance";
    p.parameters["srp.cache"] = "true";
    if (i == 2) p.parameters["srp.glossy_order"] = "2";  // another precomputation
    session->load(p);
    session->settle();
    images[i] = session->image("specular").data;  // before counters are asked for, which takes a frame
    EXPECT_EQ(counter(*session, "clusters_from_disk"), i == 1 ? counter(*session, "clusters") : 0);
    expectNoMessages(*session);
  }
  EXPECT_EQ(images[0], images[1]);
  EXPECT_NE(images[0], images[2]);
}

}  // namespace
}  // namespace hl::test
