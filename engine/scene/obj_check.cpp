#include "engine/scene/obj_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/scene/text_lines.h"

namespace hl {
namespace {

/// What could be the words of a message: short and printable.
std::string shown(std::string_view word) {
  std::string text(word.substr(0, 40));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';
  return text;
}

class Check {
 public:
  Check(std::string_view text, const std::filesystem::path& file, Progress* progress)
      : lines_(text), file_(file.string()), progress_(progress) {}

  ObjSummary run() {
    std::string_view line;
    while (lines_.next(line)) {
      if (progress_ && lines_.number() % 4096 == 0) progress_->check();
      const std::string_view key = takeWord(line);
      if (key == "v")
        coordinates(line, 3, "a vertex", true), ++found_.vertices;
      else if (key == "vt")
        coordinates(line, 1, "a texture coordinate", false), ++found_.uvs;
      else if (key == "vn")
        coordinates(line, 3, "a normal", false), ++found_.normals;
      else if (key == "f")
        face(line), ++found_.faces;
      else if (key == "usemtl")
        addOnce(found_.materials, restOf(line));
      else if (key == "mtllib")
        addOnce(found_.materialLibraries, restOf(line));
    }
    const std::array<uint64_t, 3> counts = {found_.vertices, found_.uvs, found_.normals};
    for (size_t k = 0; k < 3; ++k)
      if (highest_[k] > counts[k])
        throw badInput(fmt::format("{}:{}: the face refers to {} {}, but the file has {}", file_, highestLine_[k],
                                   kKinds[k], highest_[k], counts[k]));
    if (found_.faces == 0)
      throw badInput(fmt::format("{}: no triangles: the file has {} vertices and no face", file_, found_.vertices));
    return std::move(found_);
  }

 private:
  static constexpr std::array<const char*, 3> kKinds = {"vertex", "texture coordinate", "normal"};

  Error wrong(const std::string& what) const {
    return badInput(fmt::format("{}:{}: {}", file_, lines_.number(), what));
  }

  void coordinates(std::string_view line, int least, const char* what, bool homogeneous) {
    int count = 0;
    for (std::string_view word = takeWord(line); !word.empty() && word.front() != '#'; word = takeWord(line), ++count) {
      float x = 0;
      if (!parseNumber(word, x) || !std::isfinite(x))
        throw wrong(fmt::format("'{}' is not a finite number; {} needs {} of them", shown(word), what, least));
      if (homogeneous && count == 3 && x == 0 && restOf(line).empty())
        throw wrong("a vertex with w = 0 lies at infinity");
    }
    if (count < least) throw wrong(fmt::format("{} needs {} numbers, the line has {}", what, least, count));
  }

  void face(std::string_view line) {
    int corners = 0;
    for (std::string_view word = takeWord(line); !word.empty() && word.front() != '#';
         word = takeWord(line), ++corners) {
      std::string_view rest = word;
      for (size_t k = 0; k < 3 && !(k > 0 && rest.empty()); ++k) {
        const size_t slash = std::min(rest.find('/'), rest.size());
        const std::string_view part = rest.substr(0, slash);
        rest = slash < rest.size() ? rest.substr(slash + 1) : std::string_view{};
        if (part.empty() && k == 1) continue;  // "1//3"
        index(part, k, word);
      }
      if (!rest.empty() || word.back() == '/')
        throw wrong(fmt::format("'{}' is not a face's corner; v, v/vt, v//vn or v/vt/vn is", shown(word)));
    }
    if (corners < 3) throw wrong(fmt::format("a face needs 3 corners, the line has {}", corners));
  }

  void index(std::string_view part, size_t kind, std::string_view word) {
    int64_t i = 0;
    if (!parseNumber(part, i))
      throw wrong(fmt::format("'{}' is not a face's corner; v, v/vt, v//vn or v/vt/vn is", shown(word)));
    const uint64_t count = kind == 0 ? found_.vertices : kind == 1 ? found_.uvs : found_.normals;
    if (i == 0 || i > 0x7fffffff || i < -static_cast<int64_t>(count))
      throw wrong(
          fmt::format("{} index {} is out of range; the file has {} so far and counts from 1", kKinds[kind], i, count));
    if (i > 0 && static_cast<uint64_t>(i) > highest_[kind])
      highest_[kind] = static_cast<uint64_t>(i), highestLine_[kind] = lines_.number();
  }

  static void addOnce(std::vector<std::string>& names, std::string_view name) {
    if (!name.empty() && (names.empty() || names.back() != name) &&
        std::find(names.begin(), names.end(), name) == names.end())
      names.emplace_back(name);
  }

  TextLines lines_;
  std::string file_;
  Progress* progress_;
  ObjSummary found_;
  std::array<uint64_t, 3> highest_{}, highestLine_{};
};

}  // namespace

ObjSummary checkObj(std::string_view text, const std::filesystem::path& file, Progress* progress) {
  return Check(text, file, progress).run();
}

}  // namespace hl
