#pragma once
// The files that the window writes. These block: they run in the file thread, never in the window's.
#include <filesystem>

#include "engine/experiment/preset.h"
#include "engine/session/session.h"

namespace hl::ui {

/// What the viewport shows, at the frame's own resolution, as PNG with the preset and the provenance in its attributes.
void writeScreenshot(const FrameResult&, const Preset&, const std::filesystem::path&);
/// The scene's JSON with its edited lights and cameras.
void writeScene(const FrameResult&, const std::filesystem::path&);

}  // namespace hl::ui
