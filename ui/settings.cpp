#include "ui/settings.h"

#include <QSettings>
#include <memory>

namespace hl::ui {
namespace {

std::unique_ptr<QSettings> openFile(const QString& file) {
  if (file.isEmpty()) return std::make_unique<QSettings>(QStringLiteral("halflight"), QStringLiteral("workbench"));
  return std::make_unique<QSettings>(file, QSettings::IniFormat);
}

}  // namespace

Settings::Settings(const QString& file) : file_(file) {
  writer_.setMaxThreadCount(1);  // writes keep their order
  const auto stored = openFile(file_);
  for (const QString& key : stored->allKeys()) values_[key] = stored->value(key);
}

Settings::~Settings() { writer_.waitForDone(); }

void Settings::setValue(const QString& key, const QVariant& value) {
  if (values_.value(key) == value) return;
  values_[key] = value;
  write(key, value, false);
}

void Settings::remove(const QString& key) {
  if (values_.remove(key) > 0) write(key, {}, true);
}

void Settings::write(const QString& key, const QVariant& value, bool remove) {
  writer_.start([file = file_, key, value, remove] {
    const auto stored = openFile(file);
    if (remove)
      stored->remove(key);
    else
      stored->setValue(key, value);
  });
}

}  // namespace hl::ui
