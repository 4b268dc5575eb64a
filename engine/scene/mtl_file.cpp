#include "engine/scene/mtl_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/scene/text_lines.h"

namespace hl {
namespace {

/// The file name after a map's options ("-bm 0.5 -o 0 0 0 name"). Options' values are passed over.
std::string mapFile(std::string_view line) {
  for (;;) {
    std::string_view ahead = line;
    const std::string_view word = takeWord(ahead);
    if (word.size() < 2 || word.front() != '-' || !(word[1] >= 'a' && word[1] <= 'z')) break;
    const bool named = word == "-blendu" || word == "-blendv" || word == "-cc" || word == "-clamp" ||
                       word == "-imfchan" || word == "-type" || word == "-colorspace";
    line = ahead;
    if (named) takeWord(line);
    for (float number = 0; !named;) {
      ahead = line;
      if (!parseNumber(takeWord(ahead), number)) break;
      line = ahead;
    }
  }
  std::string name(restOf(line));
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

}  // namespace

std::vector<MtlMaterial> parseMtl(std::string_view text, const std::filesystem::path& file) {
  std::vector<MtlMaterial> materials;
  TextLines lines(text);
  std::string_view line;
  const auto wrong = [&](const std::string& what) {
    return badInput(fmt::format("{}:{}: {}", file.string(), lines.number(), what));
  };
  const auto colour = [&](std::string_view rest, std::string_view key) {
    vec3 c(0.0f);
    int count = 0;
    for (std::string_view word = takeWord(rest); count < 3 && !word.empty() && word.front() != '#';
         word = takeWord(rest), ++count) {
      if (count == 0 && (word == "spectral" || word == "xyz"))
        throw wrong(fmt::format("{} {} is not read; three numbers are", key, word));
      if (!parseNumber(word, c[count]) || !std::isfinite(c[count]) || c[count] < 0)
        throw wrong(fmt::format("{} needs numbers that are finite and not negative", key));
    }
    if (count == 1) return vec3(c.x);
    if (count != 3) throw wrong(fmt::format("{} needs 3 numbers, the line has {}", key, count));
    return c;
  };
  while (lines.next(line)) {
    const std::string_view key = takeWord(line);
    if (key.empty() || key.front() == '#') continue;
    if (key == "newmtl") {
      materials.emplace_back().name = restOf(line);
      if (materials.back().name.empty()) throw wrong("newmtl needs a name");
      continue;
    }
    if (materials.empty()) continue;
    MtlMaterial& m = materials.back();
    const auto map = [&](std::string& into) {
      into = mapFile(line);
      if (into.empty()) throw wrong(fmt::format("{} needs a file name", key));
    };
    if (key == "Kd")
      m.albedo = colour(line, key);
    else if (key == "Ke")
      m.emission = colour(line, key);
    else if (key == "map_Kd")
      map(m.albedoMap);
    else if (key == "norm" || key == "map_Kn" || key == "map_kn")
      map(m.normalMap);
    else if (key == "map_d")
      map(m.alphaMap);
    else if (key == "map_Ke" || key == "bump" || key == "map_bump" || key == "map_Bump")
      m.ignored.emplace_back(key);
  }
  return materials;
}

}  // namespace hl
