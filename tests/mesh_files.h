#pragma once
// Small mesh files and images, written into a test's folder.
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "engine/core/image_io.h"

namespace hl::test {

inline void writeText(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

/// A PNG of `width` x `height` texels; `channels` of them given by f(x, y, channel) in [0, 255].
template <class F>
void writePng(const std::filesystem::path& file, int width, int height, int channels, F&& f) {
  std::filesystem::create_directories(file.parent_path());
  Image image(width, height, channels);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c) image.pixel(x, y)[c] = static_cast<float>(f(x, y, c)) / 255.0f;
  writeImage(file, image);
}

/// A unit square in the plane z = 0 looking at +z, with every texture key an OBJ material may have.
inline const char* kSquareObj =
    "mtllib square.mtl\n"
    "o square\n"
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "vn 0 0 1\n"
    "usemtl paint\n"
    "f 1/1/1 2/2/1 3/3/1 4/4/1\n";

inline std::string base64(const std::string& bytes) {
  static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t v = 0;
    for (size_t k = 0; k < 3; ++k) v = v << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? digits[v >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

/// The same square as a glTF: positions, normals, texture coordinates (v downwards, as glTF has it), 6 indices of 16
/// bits.
struct SquareGltf {
  std::vector<float> positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  std::vector<float> normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  std::vector<float> uvs = {0, 1, 1, 1, 1, 0, 0, 0};
  std::vector<uint16_t> indices = {0, 1, 2, 0, 2, 3};
  std::string material = R"({"name": "paint", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.75, 1]}})";
  std::string node = R"({"name": "square", "mesh": 0})";
  std::string more;  ///< further top-level keys, with a comma before each

  std::string bytes() const {
    std::string b;
    const auto add = [&](const auto& v) { b.append(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(v[0])); };
    add(positions), add(normals), add(uvs), add(indices);
    return b;
  }
  std::string json(const std::string& buffer) const {
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [)" + node + R"(],
 "meshes": [{"name": "square", "primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0}]}],
 "materials": [)" +
           material + R"(],
 "buffers": [)" +
           buffer + R"(],
 "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 48},
                 {"buffer": 0, "byteOffset": 96, "byteLength": 32}, {"buffer": 0, "byteOffset": 128, "byteLength": 12}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
               {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
               {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"},
               {"bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR"}])" +
           more + "}";
  }
  std::string embedded() const {
    const std::string b = bytes();
    return json(R"({"byteLength": )" + std::to_string(b.size()) + R"(, "uri": "data:application/octet-stream;base64,)" +
                base64(b) + "\"}");
  }
  std::string binary() const {
    std::string chunk = bytes(), text = json(R"({"byteLength": )" + std::to_string(chunk.size()) + "}"), out;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto word = [&](uint32_t v) { out.append(reinterpret_cast<const char*>(&v), 4); };
    out = "glTF";
    word(2), word(static_cast<uint32_t>(28 + text.size() + chunk.size()));
    word(static_cast<uint32_t>(text.size())), word(0x4e4f534a), out += text;
    word(static_cast<uint32_t>(chunk.size())), word(0x004e4942), out += chunk;
    return out;
  }
};

}  // namespace hl::test
