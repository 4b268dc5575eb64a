#pragma once
// Cameras under the keys 1 to 9, by scene: the person's own, else the scene's.
#include <map>
#include <optional>
#include <string>

#include "engine/scene/scene.h"

namespace hl::ui {

class Settings;

class Bookmarks {
 public:
  static constexpr int kCount = 9;
  explicit Bookmarks(Settings& settings) : settings_(settings) {}
  /// `number` from 1.
  std::optional<Camera> stored(const std::string& scene, int number) const;
  void store(const std::string& scene, int number, const Camera&);
  void forget(const std::string& scene, int number);

 private:
  Settings& settings_;
};

}  // namespace hl::ui
