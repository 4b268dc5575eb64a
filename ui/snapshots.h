#pragma once
// Pictures kept to compare with: what was computed, how, how far off and how fast. Their memory has a bound, and who asks for more is told.
#include <QImage>
#include <QObject>
#include <QString>
#include <memory>
#include <vector>

#include "engine/session/session.h"

namespace hl::ui {

struct Snapshot {
  int id = 0;                          ///< of this run of the program; never used again
  QString name;
  std::shared_ptr<const Image> final, indirect;  ///< linear; the second is irradiance
  std::shared_ptr<const Image> specular;         ///< what lobes reflect of indirect light; null where the scene has no glossy surfaces
  std::shared_ptr<const FrameResult> frame;      ///< its preset, errors, times and provenance; without its pictures
  QImage thumbnail;                    ///< null until it was made
  size_t bytes() const;
};

class Snapshots : public QObject {
  Q_OBJECT
 public:
  static constexpr size_t kMostBytes = size_t{512} << 20;
  explicit Snapshots(QObject* parent = nullptr, size_t mostBytes = kMostBytes) : QObject(parent), mostBytes_(mostBytes) {}

  const std::vector<Snapshot>& all() const { return all_; }
  const Snapshot* find(int id) const;
  size_t bytes() const;
  size_t mostBytes() const { return mostBytes_; }
  /// Of a frame that carries "final", "indirect_irradiance" and, of a scene with glossy surfaces, "specular". Its id; 0 where the bound would be passed, which refused() tells.
  int add(const FrameResult&, const QString& name);
  void rename(int id, const QString& name);
  void remove(int id);
  void setThumbnail(int id, const QImage&);

 signals:
  void changed();
  void refused(const QString& why);

 private:
  std::vector<Snapshot> all_;
  size_t mostBytes_;
  int lastId_ = 0;
};

}  // namespace hl::ui
