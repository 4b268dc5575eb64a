#pragma once
// Pass times of the last frames as stacked bars. (Bars, not filled graphs: 20 ms against 423 for 16 passes and 600 frames.)
#include <QWidget>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "engine/gpu/profiler.h"

class QCPBars;
class QCPItemText;
class QCustomPlot;

namespace hl::ui {

class PassPalette;
class PlotExport;

class PassBars : public QWidget {
  Q_OBJECT
 public:
  explicit PassBars(PassPalette&, QWidget* parent = nullptr);
  /// Cheap: draws nothing.
  void add(uint64_t frame, const std::vector<PassTiming>& passes);
  void clear();
  void draw();
  /// Of the frames that are drawn: a line a frame and pass.
  std::string csv() const;
  PlotExport& exporter() { return *export_; }
  size_t frames() const { return history_.size(); }

 protected:
  void changeEvent(QEvent*) override;

 private:
  struct Frame {
    uint64_t number;
    std::map<std::string, double> ms;
  };
  QCPBars* barsOf(const std::string& pass);
  void showValueAt(QPointF);

  PassPalette& palette_;
  QCustomPlot* plot_;
  PlotExport* export_;
  std::deque<Frame> history_;
  std::vector<std::string> order_;
  std::map<std::string, QCPBars*> bars_;
};

}  // namespace hl::ui
