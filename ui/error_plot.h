#pragma once
// A metric over time since the last reset, against the matched and the full reference, with the noise floor.
#include <QWidget>
#include <string>
#include <vector>

#include "engine/session/session.h"

class QCustomPlot;
class QCPGraph;

namespace hl::ui {

class PlotExport;

class ErrorPlot : public QWidget {
  Q_OBJECT
 public:
  explicit ErrorPlot(QWidget* parent = nullptr);
  void draw(const std::vector<ConvergencePoint>&, const std::string& metric, const std::string& component, bool byFrames);
  /// What is drawn, as a table.
  std::string csv() const;
  PlotExport& exporter() { return *export_; }

 protected:
  void changeEvent(QEvent*) override;

 private:
  void showEverything();

  QCustomPlot* plot_;
  PlotExport* export_;
  QCPGraph* matched_;
  QCPGraph* full_;
  QCPGraph* floor_;
  std::string metric_;
  bool byFrames_ = false, logarithmic_ = true;
};

}  // namespace hl::ui
