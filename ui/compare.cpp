#include "ui/compare.h"

#include <QMetaObject>
#include <algorithm>

#include "ui/background.h"

namespace hl::ui {
namespace {

constexpr int kThumbnailWidth = 128;
const QString kSnapshot = QStringLiteral("snapshot ");

int snapshotId(const QString& source) { return source.startsWith(kSnapshot) ? source.mid(kSnapshot.size()).toInt() : 0; }

std::string imageName(const QString& source, PicturePart part) {
  if (source == QLatin1String("live")) return part == PicturePart::Indirect ? "indirect_irradiance" : part == PicturePart::Specular ? "specular" : "final";
  const std::string base = source == QLatin1String("matched") ? "reference_matched" : "reference";
  return part == PicturePart::Indirect ? base + "_indirect" : part == PicturePart::Specular ? base + "_specular" : base;
}

/// Means of whole blocks, for a small picture without noise of its own.
Image smaller(const Image& in) {
  const int step = std::max(1, in.width / kThumbnailWidth);
  Image out(std::max(1, in.width / step), std::max(1, in.height / step), 3);
  const int rows = std::min(step, in.height), columns = std::min(step, in.width);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int c = 0; c < 3; ++c) {
        float sum = 0;
        for (int j = 0; j < rows; ++j)
          for (int i = 0; i < columns; ++i) sum += in.pixel(std::min(x * step + i, in.width - 1), std::min(y * step + j, in.height - 1))[c];
        out.pixel(x, y)[c] = sum / static_cast<float>(rows * columns);
      }
  return out;
}

bool sameCamera(const Preset& a, const Preset& b) {
  if (a.scene != b.scene || a.camera.has_value() != b.camera.has_value()) return false;
  if (!a.camera) return a.cameraName == b.cameraName;
  return a.camera->position == b.camera->position && a.camera->target == b.camera->target && a.camera->up == b.camera->up &&
         a.camera->verticalFov == b.camera->verticalFov;
}

}  // namespace

Compare::Compare(EngineLink& link, Document& document, ImageFeed& feed, QObject* parent)
    : QObject(parent), link_(link), document_(document), feed_(feed) {
  worker_.setMaxThreadCount(1);
  connect(&link_, &EngineLink::frameReady, this, &Compare::onFrame);
  connect(&document_, &Document::displayChanged, this, &Compare::update);
  connect(&snapshots_, &Snapshots::changed, this, [this] {
    tellParts();
    choose(choice_);  // a source may be gone
  });
}

Compare::~Compare() { worker_.waitForDone(); }

std::vector<CompareSource> Compare::sources() const {
  std::vector<CompareSource> out = {{QStringLiteral("live"), tr("Live")}, {QStringLiteral("matched"), tr("Matched reference")}, {QStringLiteral("full"), tr("Full reference")}};
  for (const Snapshot& s : snapshots_.all()) out.push_back({kSnapshot + QString::number(s.id), s.name});
  return out;
}

std::vector<Compare::Part> Compare::parts() const {
  std::vector<Part> out = {{PicturePart::Final, tr("Final picture")}, {PicturePart::Indirect, tr("Indirect irradiance")}};
  const bool glossy = (frame_ && frame_->features.glossySurfaces) || std::any_of(snapshots_.all().begin(), snapshots_.all().end(), [](const Snapshot& s) { return s.specular != nullptr; });
  if (glossy) out.push_back({PicturePart::Specular, tr("Specular light")});
  return out;
}

/// Another scene may have no glossy surfaces, or be the first that has.
void Compare::tellParts() {
  const size_t now = parts().size();
  if (std::exchange(offered_, now) == now) return;
  emit partsChanged();
  choose(choice_);
}

QString Compare::nameOf(const QString& source) const {
  for (const CompareSource& s : sources())
    if (s.id == source) return s.name;
  return {};
}

std::shared_ptr<const Image> Compare::image(const QString& source, PicturePart part) const {
  if (const int id = snapshotId(source)) {
    const Snapshot* s = snapshots_.find(id);
    return s ? part == PicturePart::Indirect ? s->indirect : part == PicturePart::Specular ? s->specular : s->final : nullptr;
  }
  if (!frame_) return nullptr;
  const auto found = frame_->images.find(imageName(source, part));
  return found == frame_->images.end() ? nullptr : found->second;
}

std::shared_ptr<const FrameResult> Compare::frameOf(const QString& source) const {
  if (const int id = snapshotId(source)) {
    const Snapshot* s = snapshots_.find(id);
    return s ? s->frame : nullptr;
  }
  return frame_;
}

ErrorContext Compare::errorContext(const QString& a, const QString& b, PicturePart part) const {
  ErrorContext out;
  if (const auto frame = frameOf(a)) out.surfaces = part == PicturePart::Specular ? frame->glossy : frame->surfaces;
  if (!frame_ || snapshotId(b)) return out;
  const auto found = frame_->references.find(imageName(b, part));
  if (found != frame_->references.end()) out.truth = found->second;
  return out;
}

std::set<std::string> Compare::imagesOf(const std::set<QString>& sources, PicturePart part) {
  std::set<std::string> out;
  for (const QString& s : sources)
    if (!snapshotId(s)) out.insert(imageName(s, part));
  return out;
}

void Compare::wantImages() {
  std::set<std::string> names;
  if (choice_.mode != CompareMode::Off) names = imagesOf({choice_.a, choice_.b}, choice_.part);
  if (snapshotWanted_) names.insert({"final", "indirect_irradiance"});
  if (snapshotWanted_ && frame_ && frame_->features.glossySurfaces) names.insert("specular");
  feed_.want(this, names);
}

void Compare::choose(const CompareChoice& wanted) {
  CompareChoice next = wanted;
  next.gain = std::clamp(next.gain, 1.0, kMostGain);
  next.wipe = std::clamp(next.wipe, 0.0, 1.0);
  next.flickerHz = std::clamp(next.flickerHz, kLeastHz, kMostHz);
  for (QString* source : {&next.a, &next.b})
    if (nameOf(*source).isEmpty()) *source = QStringLiteral("live");
  const std::vector<Part> offered = parts();
  if (std::none_of(offered.begin(), offered.end(), [&](const Part& p) { return p.part == next.part; })) next.part = PicturePart::Final;
  const bool another = !(next == choice_);
  choice_ = next;
  wantImages();
  const auto truth = [](const QString& s) { return s == QLatin1String("matched") || s == QLatin1String("full"); };
  if (choice_.mode != CompareMode::Off && (truth(choice_.a) || truth(choice_.b))) emit referenceNeeded();
  if (another) emit choiceChanged();
  update();
}

void Compare::swap() {
  CompareChoice c = choice_;
  std::swap(c.a, c.b);
  choose(c);
}

void Compare::takeSnapshot() {
  snapshotWanted_ = true;
  wantImages();
  onFrame();
}

void Compare::onFrame() {
  frame_ = link_.latest();
  if (!frame_) return;
  tellParts();
  // Of glossy scenes what lobes reflect, too: a frame of before it was asked for has not got it.
  if (snapshotWanted_) wantImages();
  if (snapshotWanted_ && frame_->images.count("final") && frame_->images.count("indirect_irradiance") && (!frame_->features.glossySurfaces || frame_->images.count("specular"))) {
    snapshotWanted_ = false;
    if (const int id = snapshots_.add(*frame_, {})) {
      startThumbnail(id);
      emit snapshotTaken(id);
    }
    wantImages();
  }
  update();
}

void Compare::startThumbnail(int id) {
  worker_.start([this, id, image = snapshots_.find(id)->final, display = document_.preset().display] {
    giveWay();
    const Image small = smaller(*image);
    const QImage picture = pictureOf(toneMapOnHost(small, display), small.width, small.height);
    QMetaObject::invokeMethod(this, [this, id, picture] { snapshots_.setThumbnail(id, picture); }, Qt::QueuedConnection);
  });
}

void Compare::update() {
  if (running_) {
    again_ = true;
    return;
  }
  ComparisonJob job;
  job.mode = choice_.mode;
  job.a = image(choice_.a, choice_.part);
  job.b = image(choice_.b, choice_.part);
  job.display = document_.preset().display;
  job.gain = static_cast<float>(choice_.gain);
  job.metric = choice_.metric.toStdString();
  if (job.mode == CompareMode::ErrorMap) job.context = errorContext(choice_.a, choice_.b, choice_.part);
  if (job.mode == CompareMode::Off || !job.a || !job.b) {
    ComparisonPictures none;
    if (job.mode != CompareMode::Off) {
      const QString missing = !job.a ? choice_.a : choice_.b;
      const bool never = choice_.part == PicturePart::Specular && (snapshotId(missing) > 0 || (frame_ && !frame_->features.glossySurfaces));
      none.refused = never ? tr("%1: its scene has no glossy surfaces").arg(nameOf(missing)) : missing == QLatin1String("live") ? tr("Waiting for the picture") : tr("%1: no picture yet").arg(nameOf(missing));
    }
    const bool same = shown_.mode == job.mode && !shown_.a && pictures_.refused == none.refused;
    shown_ = ComparisonJob{};
    shown_.mode = job.mode;
    pictures_ = none;
    if (!same) emit picturesChanged();
    return;
  }
  const bool same = job.a == shown_.a && job.b == shown_.b && job.display == shown_.display && job.mode == shown_.mode && job.gain == shown_.gain && job.metric == shown_.metric;
  if (same) return;
  running_ = true;
  worker_.start([this, job] {
    giveWay();
    const ComparisonPictures made = renderComparison(job, toneMapped_);
    QMetaObject::invokeMethod(this, [this, job, made] { onDone(job, made); }, Qt::QueuedConnection);
  });
}

void Compare::onDone(const ComparisonJob& job, const ComparisonPictures& made) {
  running_ = false;
  if (job.mode == choice_.mode) {
    shown_ = job;
    pictures_ = made;
    emit picturesChanged();
  }
  if (std::exchange(again_, false) || job.mode != choice_.mode) update();
}

QString Compare::note() const {
  if (choice_.mode == CompareMode::Off) return {};
  const auto a = frameOf(choice_.a), b = frameOf(choice_.b);
  if (!a || !b || a == b) return {};
  if (a->preset.scene != b->preset.scene) return tr("A and B show different scenes");
  if (!sameCamera(a->preset, b->preset)) return tr("A and B were taken from different cameras");
  return {};
}

}  // namespace hl::ui
