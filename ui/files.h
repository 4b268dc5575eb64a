#pragma once
// The files that the window opens and writes. These block: they run in the session's or the file thread, never in the window's.
#include <filesystem>
#include <optional>
#include <string>

#include "engine/experiment/preset.h"
#include "engine/session/session.h"

namespace hl::ui {

/// The image attribute that carries a screenshot's preset, as JSON.
inline constexpr const char* kPresetAttribute = "halflight.preset";

struct OpenedFile {
  std::optional<Preset> preset;  ///< of a preset file or a screenshot
  std::string scene;             ///< else: a scene or mesh to load in place of the current one
};

/// Tells a preset, a scene, a mesh and a screenshot apart; "" is the default preset.
/// @throws Error(BadInput) saying what the file is not.
OpenedFile readAny(const std::filesystem::path&);

/// What the viewport shows, at the frame's own resolution, as PNG with the preset in its metadata.
void writeScreenshot(const FrameResult&, const Preset&, const std::filesystem::path&);
/// The scene's JSON with its edited lights and cameras.
void writeScene(const FrameResult&, const std::filesystem::path&);

}  // namespace hl::ui
