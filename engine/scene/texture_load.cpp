#include "engine/scene/texture_load.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/core/image_io.h"
#include "engine/scene/texture_sampling.h"

namespace hl {
namespace {

float linearToSrgb(float c) { return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f; }

uint8_t quantised(float v) { return static_cast<uint8_t>(std::clamp(v, 0.0f, 1.0f) * 255.0f + 0.5f); }

Texture fromImage(const Image& image, const std::filesystem::path& file, std::string name, bool srgb) {
  Texture t;
  t.name = std::move(name);
  t.width = image.width, t.height = image.height, t.srgb = srgb;
  t.rgba.resize(image.pixels() * 4);
  const std::string extension = file.extension().string();
  const bool encode = srgb && (extension == ".exr" || extension == ".hdr" || extension == ".pfm");  // linear files
  const int colours = image.channels >= 3 ? 3 : 1;
  const int alpha = image.channels == 2 || image.channels >= 4 ? colours : -1;
  for (size_t i = 0; i < image.pixels(); ++i) {
    const float* p = image.data.data() + i * static_cast<size_t>(image.channels);
    for (int c = 0; c < 3; ++c) {
      const float v = p[colours == 3 ? c : 0];
      t.rgba[4 * i + static_cast<size_t>(c)] = quantised(encode ? linearToSrgb(std::clamp(v, 0.0f, 1.0f)) : v);
    }
    t.rgba[4 * i + 3] = alpha < 0 ? 255 : quantised(p[alpha]);
  }
  const int longest = std::max(t.width, t.height);
  if (longest <= kMaxTextureSize) return t;
  const auto reduced = [&](int n) { return std::max(1, static_cast<int>(int64_t{n} * kMaxTextureSize / longest)); };
  return resampled(t, reduced(t.width), reduced(t.height));
}

/// For each output texel the input texels it covers, with weights that sum to 1.
struct Span {
  int first = 0;
  std::vector<float> weights;
};
std::vector<Span> spans(int from, int to) {
  std::vector<Span> out(static_cast<size_t>(to));
  const double scale = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    const double begin = i * scale, end = (i + 1) * scale;
    Span& s = out[static_cast<size_t>(i)];
    s.first = static_cast<int>(begin);
    for (int k = s.first; k < from && k < end; ++k)
      s.weights.push_back(static_cast<float>((std::min<double>(end, k + 1) - std::max<double>(begin, k)) / scale));
  }
  return out;
}

}  // namespace

Texture resampled(const Texture& t, int width, int height) {
  Texture out;
  out.name = t.name, out.srgb = t.srgb, out.width = width, out.height = height;
  out.rgba.resize(static_cast<size_t>(width) * static_cast<size_t>(height) * 4);
  const std::vector<Span> columns = spans(t.width, width), rows = spans(t.height, height);
  const auto& decode = srgbDecodeTable();
  for (size_t y = 0; y < rows.size(); ++y)
    for (size_t x = 0; x < columns.size(); ++x) {
      vec4 sum(0.0f);
      for (size_t j = 0; j < rows[y].weights.size(); ++j)
        for (size_t i = 0; i < columns[x].weights.size(); ++i) {
          const size_t row = static_cast<size_t>(rows[y].first) + j, column = static_cast<size_t>(columns[x].first) + i;
          const uint8_t* p = t.rgba.data() + 4 * (row * static_cast<size_t>(t.width) + column);
          const float w = rows[y].weights[j] * columns[x].weights[i];
          const vec3 rgb = t.srgb ? vec3(decode[p[0]], decode[p[1]], decode[p[2]]) : vec3(p[0], p[1], p[2]) / 255.0f;
          sum += w * vec4(rgb, static_cast<float>(p[3]) / 255.0f);
        }
      uint8_t* q = out.rgba.data() + 4 * (y * static_cast<size_t>(width) + x);
      for (int c = 0; c < 3; ++c) q[c] = quantised(t.srgb ? linearToSrgb(sum[c]) : sum[c]);
      q[3] = quantised(sum.w);
    }
  return out;
}

Texture loadTexture(const std::filesystem::path& file, bool srgb) {
  return fromImage(readImage(file), file, file.filename().string(), srgb);
}

Texture loadTexture(std::string_view encoded, const std::string& name, const std::string& extension, bool srgb) {
  // Images are read from files; the name makes the file its content's own, so that two programs at once do no harm.
  const std::filesystem::path file = cacheFolder() / ("embedded-" + hashOf(encoded) + extension);
  writeFileAtomically(file, encoded);
  std::error_code ignored;
  try {
    Texture t = fromImage(readImage(file), file, name, srgb);
    std::filesystem::remove(file, ignored);
    return t;
  } catch (const Error& e) {
    std::filesystem::remove(file, ignored);
    std::string what = e.what();
    if (const size_t at = what.find(file.string()); at != std::string::npos)
      what.replace(at, file.string().size(), name);
    throw Error(e.kind(), what);
  }
}

void setAlpha(Texture& texture, const Texture& mask) {
  bool varies = false;
  for (size_t i = 3; i < mask.rgba.size() && !varies; i += 4) varies = mask.rgba[i] != mask.rgba[3];
  const bool sameSize = mask.width == texture.width && mask.height == texture.height;
  const Texture fitted = sameSize ? mask : resampled(mask, texture.width, texture.height);
  for (size_t i = 0; i < texture.rgba.size(); i += 4) texture.rgba[i + 3] = fitted.rgba[i + (varies ? 3 : 0)];
}

}  // namespace hl
