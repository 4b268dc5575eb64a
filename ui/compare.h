#pragma once
// What is compared with what, and how: live picture, references and snapshots, chosen as A and B. Pictures of it are made by a worker thread, the newest
// wanted one at a time.
#include <QObject>
#include <QThreadPool>
#include <set>

#include "ui/comparison.h"
#include "ui/document.h"
#include "ui/image_feed.h"
#include "ui/snapshots.h"

namespace hl::ui {

/// What is compared of a picture.
enum class PicturePart { Final, Indirect, Specular };  ///< radiance; indirect irradiance; indirect radiance that lobes reflect, of scenes with glossy surfaces

struct CompareChoice {
  CompareMode mode = CompareMode::Off;
  QString a = QStringLiteral("live"), b = QStringLiteral("matched");  ///< ids of Compare::sources()
  PicturePart part = PicturePart::Final;
  double gain = 10;       ///< of the difference, 1 to 10
  QString metric = QStringLiteral("relmse");
  double wipe = 0.5;      ///< where the line is, in shares of what is seen of the picture
  double flickerHz = 2;   ///< changes a second
  bool operator==(const CompareChoice&) const = default;
};

struct CompareSource {
  QString id, name;
};

class Compare : public QObject {
  Q_OBJECT
 public:
  static constexpr double kLeastHz = 0.2, kMostHz = 10, kMostGain = 10;
  Compare(EngineLink&, Document&, ImageFeed&, QObject* parent = nullptr);
  ~Compare() override;

  Snapshots& snapshots() { return snapshots_; }
  const CompareChoice& choice() const { return choice_; }
  /// Values out of range are brought into it; a source that is gone becomes "live", a part that is not offered the final picture.
  void choose(const CompareChoice&);
  void swap();
  /// As soon as a frame has come with its linear pictures.
  void takeSnapshot();
  /// live, matched, full, and "snapshot N".
  std::vector<CompareSource> sources() const;
  QString nameOf(const QString& source) const;
  struct Part {
    PicturePart part;
    QString name;
  };
  /// What can be compared: light by lobes where the scene of the newest frame, or of a snapshot, has glossy surfaces.
  std::vector<Part> parts() const;
  /// The linear picture of a source as it stands; null where there is none yet. Live and reference ones come only while someone wants them.
  std::shared_ptr<const Image> image(const QString& source, PicturePart) const;
  /// What errors of A against B are measured with.
  ErrorContext errorContext(const QString& a, const QString& b, PicturePart) const;
  /// The frame a source belongs to: its preset, errors and times. Of a reference the newest one.
  std::shared_ptr<const FrameResult> frameOf(const QString& source) const;
  /// What image() of these needs from the engine.
  static std::set<std::string> imagesOf(const std::set<QString>& sources, PicturePart);

  const ComparisonPictures& pictures() const { return pictures_; }
  /// What a person should know before believing the comparison; "" nothing.
  QString note() const;

 signals:
  void choiceChanged();
  void partsChanged();
  void picturesChanged();
  void referenceNeeded();
  void snapshotTaken(int id);

 private:
  void update();
  void wantImages();
  void tellParts();
  void onFrame();
  void startThumbnail(int id);
  void onDone(const ComparisonJob&, const ComparisonPictures&);

  EngineLink& link_;
  Document& document_;
  ImageFeed& feed_;
  Snapshots snapshots_;
  CompareChoice choice_;
  ComparisonPictures pictures_;
  ComparisonJob shown_;
  std::shared_ptr<const FrameResult> frame_;
  size_t offered_ = 0;  ///< parts() as it was told last
  bool snapshotWanted_ = false, running_ = false, again_ = false;
  ToneMappedImages toneMapped_;  // of the worker thread
  QThreadPool worker_;
};

}  // namespace hl::ui
