#pragma once
// A metric over time since the last reset, against the matched and the full reference, with the noise floor.
#include <QWidget>
#include <vector>

#include "engine/session/session.h"

class QCustomPlot;
class QCPGraph;

namespace hl::ui {

class ErrorPlot : public QWidget {
  Q_OBJECT
 public:
  explicit ErrorPlot(QWidget* parent = nullptr);
  void draw(const std::vector<ConvergencePoint>&, const std::string& metric, const std::string& component, bool byFrames);
  void exportTo(const QString& file);

 protected:
  void changeEvent(QEvent*) override;

 private:
  QCustomPlot* plot_;
  QCPGraph* matched_;
  QCPGraph* full_;
  QCPGraph* floor_;
};

}  // namespace hl::ui
