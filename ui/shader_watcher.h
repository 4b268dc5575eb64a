#pragma once
// Tells when a shader's source changes on disk. Lives in a thread of its own, because looking through folders blocks.
#include <QFileSystemWatcher>
#include <QObject>
#include <QThread>
#include <QTimer>

namespace hl::ui {

class ShaderWatcher : public QObject {
  Q_OBJECT
 public:
  explicit ShaderWatcher(QObject* parent = nullptr);
  ~ShaderWatcher() override;

 signals:
  /// Once for all changes of a moment.
  void changed();

 private:
  QThread thread_;
};

}  // namespace hl::ui
