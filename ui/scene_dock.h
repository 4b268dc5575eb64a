#pragma once
// Scene: which one, its lights, cameras, what it has, and what the import changed.
#include <QWidget>

#include "engine/scene/scene_file.h"
#include "ui/document.h"

class QComboBox;
class QLabel;
class QListWidget;
class QSpinBox;

namespace hl::ui {

class Bookmarks;
class TimePanel;

class ScenePanel : public QWidget {
  Q_OBJECT
 public:
  ScenePanel(Document&, Bookmarks&, QWidget* parent = nullptr);
  /// The scenes there are (from a worker: looking for them touches files).
  void setScenes(const std::vector<SceneListing>&);
  void showFrame(const FrameResult&);
  void readCameras();

 signals:
  void bookmarkChosen(int number);
  void openFileWanted();
  void saveSceneWanted();

 private:
  void readScene();
  void readChooser();

  Document& document_;
  Bookmarks& bookmarks_;
  std::vector<SceneListing> scenes_;
  QComboBox* chooser_;
  QListWidget* cameras_;
  QSpinBox* seed_;
  TimePanel* time_;
  QLabel* facts_;
  QLabel* report_;
  QString factsText_, reportText_;
};

}  // namespace hl::ui
