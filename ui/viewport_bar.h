#pragma once
// The line above the picture: view, exposure, tone map, invalid pixels, reference, resolution, frame time.
#include <QWidget>

#include "ui/document.h"

class QAction;
class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QToolButton;

namespace hl::ui {

class ViewportBar : public QWidget {
  Q_OBJECT
 public:
  explicit ViewportBar(Document&, QWidget* parent = nullptr);
  void showFrame(const FrameResult&);
  /// A button for a tool of the viewport.
  void addTool(QAction*);

 protected:
  void resizeEvent(QResizeEvent*) override;

 private:
  /// Shows as much of the frame's figures as there is room for.
  void fitFigures();
  void readDocument();
  void readViews();
  void changed(const QString& what, quint64 drag = 0);

  Document& document_;
  QComboBox* view_;
  QComboBox* errorMetric_;  ///< shown with the error views alone
  QDoubleSpinBox* exposure_;
  QComboBox* toneMap_;
  QCheckBox* invalid_;
  QComboBox* resolution_;
  QLabel* figures_;
  QStringList figureTexts_;  ///< from the longest
};

}  // namespace hl::ui
