#include "engine/scene/gltf_container.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>

#include "engine/core/error.h"

namespace hl {
namespace {

constexpr uint32_t kMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;

int base64Digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

void append(std::string& out, uint32_t word) { out.append(reinterpret_cast<const char*>(&word), 4); }

}  // namespace

GltfContainer openGltf(std::string_view bytes, const std::filesystem::path& file) {
  GltfContainer c;
  const std::string extension = file.extension().string();
  c.binary = bytes.substr(0, 4) == "glTF";
  if (!c.binary) {
    if (extension == ".glb" || extension == ".GLB")
      throw badInput(fmt::format("{}: not a glb file: it does not begin with 'glTF'", file.string()));
    c.json = bytes;
    return c;
  }
  const auto wrong = [&](const std::string& what) { return badInput(fmt::format("{}: {}", file.string(), what)); };
  const auto word = [&](size_t at) {
    uint32_t v = 0;
    std::memcpy(&v, bytes.data() + at, 4);
    return v;
  };
  if (bytes.size() < 20) throw wrong("cut off: a glb file has at least 20 bytes");
  if (word(4) != 2) throw wrong(fmt::format("glb version {} is not read; 2 is", word(4)));
  if (word(8) != bytes.size())
    throw wrong(fmt::format("cut off or damaged: its header says {} bytes, it has {}", word(8), bytes.size()));
  const size_t jsonLength = word(12), at = 20 + jsonLength;
  if (word(16) != kJsonChunk || at > bytes.size()) throw wrong("damaged: its first chunk is no JSON of that length");
  c.json = bytes.substr(20, jsonLength);
  if (at == bytes.size()) return c;
  if (at + 8 > bytes.size() || word(at + 4) != kBinaryChunk || at + 8 + size_t{word(at)} > bytes.size())
    throw wrong("damaged: its second chunk is no binary one of that length");
  c.chunk = bytes.substr(at + 8, word(at));
  c.hasChunk = true;
  return c;
}

std::string wrapGltf(const GltfContainer& c, std::string json) {
  if (!c.binary) return json;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const size_t padding = (4 - c.chunk.size() % 4) % 4;
  std::string out;
  append(out, kMagic), append(out, 2);
  append(out, static_cast<uint32_t>(20 + json.size() + (c.hasChunk ? 8 + c.chunk.size() + padding : 0)));
  append(out, static_cast<uint32_t>(json.size())), append(out, kJsonChunk);
  out += json;
  if (!c.hasChunk) return out;
  append(out, static_cast<uint32_t>(c.chunk.size() + padding)), append(out, kBinaryChunk);
  out += c.chunk;
  out.append(padding, '\0');
  return out;
}

bool decodeDataUri(std::string_view uri, std::string& out) {
  constexpr std::string_view kMark = ";base64,";
  const size_t mark = uri.find(kMark);
  if (uri.substr(0, 5) != "data:" || mark == std::string_view::npos) return false;
  uint32_t bits = 0;
  int have = 0;
  for (const char c : uri.substr(mark + kMark.size())) {
    if (c == '=') break;
    const int digit = base64Digit(c);
    if (digit < 0) return false;
    bits = bits << 6 | static_cast<uint32_t>(digit);
    if ((have += 6) < 8) continue;
    have -= 8;
    out.push_back(static_cast<char>(bits >> have & 0xff));
  }
  return true;
}

}  // namespace hl
