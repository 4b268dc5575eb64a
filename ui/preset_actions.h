#pragma once
// Opening and saving: presets, scenes, meshes, screenshots; recent files; what is dropped on the window.
#include <QObject>
#include <QString>

#include "engine/experiment/preset.h"
#include "ui/document.h"

class QMenu;
class QMimeData;
class QWidget;

namespace hl::ui {

class Settings;

class PresetActions : public QObject {
  Q_OBJECT
 public:
  PresetActions(Document&, EngineLink&, Settings&, QWidget* window);
  void fill(QMenu& fileMenu);
  void setPresets(const std::vector<PresetListing>&);
  void openPath(const QString& path);
  /// True for what could be opened, by its looks; whether it is any good is told when it was read.
  static bool acceptable(const QMimeData&);
  void drop(const QMimeData&);

 public slots:
  void openFile();
  void openSceneFile();
  void save();
  void saveAs();
  void saveSceneAs();
  void takeScreenshot();

 private:
  void remember(const QString& path);
  void fillRecent();
  QString startFolder() const;

  Document& document_;
  EngineLink& link_;
  Settings& settings_;
  QWidget* window_;
  QMenu* recent_ = nullptr;
  QMenu* presets_ = nullptr;
};

}  // namespace hl::ui
