#include "ui/snapshots.h"

#include <algorithm>

namespace hl::ui {

size_t Snapshot::bytes() const {
  size_t floats = 0;
  for (const auto& image : {final, indirect, specular})
    if (image) floats += image->data.size();
  return floats * sizeof(float) + static_cast<size_t>(thumbnail.sizeInBytes());
}

const Snapshot* Snapshots::find(int id) const {
  const auto found = std::find_if(all_.begin(), all_.end(), [id](const Snapshot& s) { return s.id == id; });
  return found == all_.end() ? nullptr : &*found;
}

size_t Snapshots::bytes() const {
  size_t sum = 0;
  for (const Snapshot& s : all_) sum += s.bytes();
  return sum;
}

int Snapshots::add(const FrameResult& frame, const QString& name) {
  Snapshot s;
  s.final = frame.images.at("final");
  s.indirect = frame.images.at("indirect_irradiance");
  if (frame.features.glossySurfaces) s.specular = frame.images.at("specular");
  if (bytes() + s.bytes() > mostBytes_) {
    const auto mb = [](size_t n) { return static_cast<double>(n) / (1 << 20); };
    emit refused(tr("Snapshots would hold %1 MB; %2 MB is their bound. Delete one first.").arg(mb(bytes() + s.bytes()), 0, 'f', 0).arg(mb(mostBytes_), 0, 'f', 0));
    return 0;
  }
  auto kept = std::make_shared<FrameResult>(frame);
  kept->display.clear();
  kept->display.shrink_to_fit();
  kept->images.clear();
  kept->references.clear();
  s.frame = std::move(kept);
  s.id = ++lastId_;
  s.name = name.isEmpty() ? tr("Snapshot %1, %2").arg(s.id).arg(QString::fromStdString(frame.preset.technique)) : name;
  all_.push_back(std::move(s));
  emit changed();
  return lastId_;
}

void Snapshots::rename(int id, const QString& name) {
  for (Snapshot& s : all_)
    if (s.id == id && !name.trimmed().isEmpty() && s.name != name) {
      s.name = name;
      emit changed();
    }
}

void Snapshots::remove(int id) {
  if (std::erase_if(all_, [id](const Snapshot& s) { return s.id == id; })) emit changed();
}

void Snapshots::setThumbnail(int id, const QImage& picture) {
  for (Snapshot& s : all_)
    if (s.id == id) {
      s.thumbnail = picture;
      emit changed();
    }
}

}  // namespace hl::ui
