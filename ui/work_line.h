#pragma once
// A long work's progress: what, how far, time left, Cancel.
#include <QWidget>

#include "engine/session/session.h"

class QLabel;
class QProgressBar;
class QToolButton;

namespace hl::ui {

class WorkLine : public QWidget {
  Q_OBJECT
 public:
  explicit WorkLine(const QString& name, QWidget* parent = nullptr);
  void show(const WorkReport&);

 signals:
  void cancelWanted();
  void restartWanted();

 private:
  QString name_;
  QLabel* label_;
  QProgressBar* bar_;
  QToolButton* cancel_;
  QToolButton* restart_;
};

/// "40 s", "3 min 20 s", "1 h 5 min".
QString durationText(double seconds);

}  // namespace hl::ui
