#pragma once
// The scene's time: play, stand still, go to a moment; recorded flights of the camera, and recording one.
#include <QElapsedTimer>
#include <QWidget>

#include "ui/document.h"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QSlider;
class QToolButton;

namespace hl::ui {

class TimePanel : public QWidget {
  Q_OBJECT
 public:
  explicit TimePanel(Document&, QWidget* parent = nullptr);
  void showFrame(const FrameResult&);
  /// The keys of the flight that is being recorded.
  const CameraPath& recording() const { return recording_; }

 private:
  void readScene();
  void readDocument();
  void send(const Playback&);
  void addKey(float time, const Camera&);
  void showRecording();

  Document& document_;
  QToolButton* play_;
  QSlider* slider_;
  QDoubleSpinBox* time_;
  QDoubleSpinBox* rate_;
  QComboBox* path_;
  QPushButton* record_;
  QPushButton* key_;
  QPushButton* keep_;
  QLabel* recorded_;
  CameraPath recording_;
  QElapsedTimer recordingSince_;
  double shown_ = 0;      ///< the newest frame's time
  bool playing_ = false;  ///< as the newest frame says: an animation that ends plays no more
};

/// How long a scene's animations and paths run until they repeat, at least 1 [s].
float longestAnimation(const Scene&);

}  // namespace hl::ui
