#pragma once
// What the workbench remembers from run to run. Read once at the start; written by a worker, so that no event of the window waits for a file.
#include <QString>
#include <QThreadPool>
#include <QVariant>

namespace hl::ui {

class Settings {
 public:
  /// "" is the person's own file. Blocking: before the window is shown.
  explicit Settings(const QString& file = {});
  /// Waits for the last write.
  ~Settings();

  QVariant value(const QString& key, const QVariant& otherwise = {}) const { return values_.value(key, otherwise); }
  void setValue(const QString& key, const QVariant& value);
  void remove(const QString& key);

 private:
  void write(const QString& key, const QVariant& value, bool remove);

  QString file_;
  QVariantMap values_;
  QThreadPool writer_;
};

}  // namespace hl::ui
