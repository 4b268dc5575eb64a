#pragma once
// One colour a pass, and one a technique, the same everywhere and in every run, told apart by people who see colours differently.
#include <QColor>
#include <QObject>
#include <QString>
#include <map>
#include <string>
#include <vector>

namespace hl::ui {

class Settings;

class PassPalette {
 public:
  /// Number of colours before two passes have to share one.
  static int size();
  static QColor colour(int slot);

  /// Assignments of earlier runs come from `settings` and new ones go there, under `key`; null: this run alone.
  explicit PassPalette(Settings* settings = nullptr, QString key = QStringLiteral("passColours"));
  QColor of(const std::string& pass);

 private:
  Settings* settings_;
  QString key_;
  std::map<std::string, int> slots_;
  std::vector<int> users_;
};

/// Of techniques, beside those of passes.
inline PassPalette techniquePalette(Settings* settings) { return PassPalette(settings, QStringLiteral("techniqueColours")); }

}  // namespace hl::ui
