// Texture look-ups on the host: filtering, repetition, direction of v, and the sRGB curve before filtering.
#include <gtest/gtest.h>

#include "engine/scene/texture_load.h"
#include "engine/scene/texture_sampling.h"

namespace hl {
namespace {

Texture grey(int width, int height, std::vector<uint8_t> values, bool srgb = false) {
  Texture t;
  t.width = width, t.height = height, t.srgb = srgb;
  for (const uint8_t v : values) t.rgba.insert(t.rgba.end(), {v, v, v, v});
  return t;
}

TEST(SceneTexture, TexelCentresAreExactAndRowZeroIsOnTop) {
  const Texture t = grey(2, 2, {0, 51, 102, 255});
  EXPECT_FLOAT_EQ(sampleTexture(t, vec2(0.25f, 0.75f)).x, 0);
  EXPECT_FLOAT_EQ(sampleTexture(t, vec2(0.75f, 0.75f)).x, 0.2f);
  EXPECT_FLOAT_EQ(sampleTexture(t, vec2(0.25f, 0.25f)).x, 0.4f);
  EXPECT_FLOAT_EQ(sampleTexture(t, vec2(0.75f, 0.25f)).x, 1);
  EXPECT_FLOAT_EQ(sampleTexture(t, vec2(0.5f, 0.5f)).x, 0.4f);
  EXPECT_FLOAT_EQ(sampleAlpha(t, vec2(0.5f, 0.25f)), 0.7f);
}

TEST(SceneTexture, Repeats) {
  const Texture t = grey(4, 1, {0, 50, 100, 200});
  for (const float shift : {-3.0f, -1.0f, 1.0f, 7.0f})
    for (const float u : {0.0f, 0.0625f, 0.125f, 0.4f, 0.97f})
      EXPECT_NEAR(sampleTexture(t, vec2(u + shift, 0.3f)).x, sampleTexture(t, vec2(u, 0.3f)).x, 1e-5f);
  EXPECT_FLOAT_EQ(sampleTexture(t, vec2(0, 0)).x, 100 / 255.0f);  // between the last and the first
  EXPECT_FLOAT_EQ(sampleTexture(t, vec2(-1e-9f, 0)).x, 100 / 255.0f);
}

TEST(SceneTexture, CurveIsUndoneBeforeFiltering) {
  const Texture t = grey(2, 1, {0, 255}, true);
  EXPECT_FLOAT_EQ(sampleTexture(t, vec2(0.5f, 0.5f)).x, 0.5f);  // not 0.214, the curve of 0.5
  EXPECT_FLOAT_EQ(sampleTexture(t, vec2(0.5f, 0.5f)).w, 0.5f);  // alpha has no curve
  const Texture middle = grey(1, 1, {188}, true);
  EXPECT_NEAR(sampleTexture(middle, vec2(0.3f, 0.9f)).x, 0.5f, 0.004f);
}

TEST(SceneTexture, AlbedoIsTheProductAndCapped) {
  Scene s;
  s.textures = {grey(1, 1, {255}, true)};
  Material m;
  m.albedo = vec3(1.0f, 0.5f, 0.25f);
  m.albedoTexture = 0;
  EXPECT_EQ(albedoAt(s, m, vec2(0.5f)), vec3(kMaxAlbedo, 0.5f, 0.25f));
}

TEST(SceneTexture, ResamplingKeepsTheMeanInLinearLight) {
  std::vector<uint8_t> values;
  for (int i = 0; i < 30 * 20; ++i) values.push_back(static_cast<uint8_t>((i * 37) % 256));
  const Texture t = grey(30, 20, values, true), r = resampled(t, 7, 9);
  const auto mean = [](const Texture& x) {
    double sum = 0;
    for (size_t i = 0; i < x.rgba.size(); i += 4) sum += static_cast<double>(srgbDecodeTable()[x.rgba[i]]);
    return sum / static_cast<double>(x.rgba.size() / 4);
  };
  EXPECT_NEAR(mean(r), mean(t), 2e-3);
}

}  // namespace
}  // namespace hl
