#pragma once
// The files that the window writes. These block: they run in the file thread, never in the window's.
#include <filesystem>

#include "engine/experiment/preset.h"
#include "engine/session/session.h"

namespace hl::ui {

/// What a path that was dropped or typed is to the window.
enum class FileKind {
  Results,     ///< a folder that a sweep has written
  Experiment,
  Other,       ///< for openTarget(), which says what is wrong with it
};
FileKind kindOfFile(const std::filesystem::path&);

/// Where a frame's numbers come from, as one JSON object.
std::string provenanceJson(const FrameResult&);
/// By the extension: PNG of what the viewport shows, at the frame's own resolution, or EXR of the linear picture; preset and provenance in attributes.
void writeScreenshot(const FrameResult&, const Preset&, const std::filesystem::path&);
/// The scene's JSON with its edited lights and cameras.
void writeScene(const FrameResult&, const std::filesystem::path&);

}  // namespace hl::ui
