#include "ui/files.h"

#include <QJsonDocument>
#include <QJsonObject>
#include <cctype>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/image_io.h"
#include "engine/experiment/open_target.h"
#include "engine/scene/scene_file.h"
#include "engine/session/results_json.h"

namespace hl::ui {

FileKind kindOfFile(const std::filesystem::path& path) {
  std::error_code none;
  if (std::filesystem::is_directory(path, none)) return std::filesystem::exists(path / "experiment.json", none) ? FileKind::Results : FileKind::Other;
  if (path.extension() != ".json" || !std::filesystem::is_regular_file(path, none)) return FileKind::Other;
  try {
    const QJsonObject o = QJsonDocument::fromJson(QByteArray::fromStdString(readFile(path))).object();
    return o.contains("base") && !o.contains("scene") ? FileKind::Experiment : FileKind::Other;
  } catch (const Error&) {
    return FileKind::Other;  // whoever opens it says why it cannot be read
  }
}

std::string provenanceJson(const FrameResult& f) { return hl::provenanceJson(f.provenance, f.displayHash); }

void writeScreenshot(const FrameResult& frame, const Preset& preset, const std::filesystem::path& path) {
  if (frame.display.empty()) throw Error(ErrorKind::Run, "screenshot: there is no frame yet");
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension != ".png" && extension != ".exr") throw badInput(path.string() + ": screenshots are written as .png (as shown) or .exr (linear)");
  Image image(frame.width, frame.height, 3);
  if (extension == ".exr") {
    const auto found = frame.images.find("final");
    if (found == frame.images.end()) throw Error(ErrorKind::Run, "screenshot: the frame came without its linear picture");
    image = *found->second;
  } else {
    for (size_t i = 0; i < image.pixels(); ++i)
      for (size_t c = 0; c < 3; ++c) image.data[i * 3 + c] = static_cast<float>(frame.display[i * 4 + c]) / 255.0f;
  }
  image.metadata[kPresetAttribute] = presetJson(preset);
  image.metadata[kProvenanceAttribute] = provenanceJson(frame);
  writeImage(path, image);
}

void writeScene(const FrameResult& frame, const std::filesystem::path& path) {
  if (!frame.scene) throw Error(ErrorKind::Run, "scene: none is loaded yet");
  writeFileAtomically(path, sceneJson(*frame.scene));
}

}  // namespace hl::ui
