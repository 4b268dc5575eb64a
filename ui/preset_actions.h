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

class ImageFeed;
class Settings;

class PresetActions : public QObject {
  Q_OBJECT
 public:
  PresetActions(Document&, EngineLink&, ImageFeed&, Settings&, QWidget* window);
  void fill(QMenu& fileMenu);
  void setPresets(const std::vector<PresetListing>&);
  /// Experiments and folders of results are passed on, everything else is opened.
  void openPath(const QString& path);
  /// True for what could be opened, by its looks; whether it is any good is told when it was read.
  static bool acceptable(const QMimeData&);
  void drop(const QMimeData&);

 signals:
  void experimentOpened(const QString& path);
  void resultsOpened(const QString& folder);

 public slots:
  void openFile();
  void openSceneFile();
  void save();
  void saveAs();
  void saveSceneAs();
  void takeScreenshot();

 private:
  void remember(const QString& path);
  void onFrame();
  void writeScreenshot();
  void fillRecent();
  QString startFolder() const;

  Document& document_;
  EngineLink& link_;
  ImageFeed& feed_;
  Settings& settings_;
  QWidget* window_;
  QMenu* recent_ = nullptr;
  QMenu* presets_ = nullptr;
  // A screenshot on its way: the frame of the moment, as soon as one came with its linear picture, and where it goes, once that was chosen.
  bool shotWanted_ = false;
  std::shared_ptr<const FrameResult> shot_;
  QString shotPath_;
};

}  // namespace hl::ui
