#pragma once
// Parallel coordinates: what was varied, what it costs and how wrong it is, a line a configuration.
#include <QPen>
#include <map>
#include <utility>

#include "ui/palette.h"
#include "ui/sweep_plot.h"

class QCPGraph;

namespace hl::ui {

/// A drag along an axis brushes: lines outside it fade. A click on an axis takes its brush away.
class ParallelPlot : public SweepPlot {
  Q_OBJECT
 public:
  explicit ParallelPlot(PassPalette& techniques, QWidget* parent = nullptr);
  std::string csv() const override;
  QSize pictureSize() const override;

  /// An upright axis: for each configuration a place from 0 to 1, NaN where it has none.
  struct Column {
    QString title;
    std::vector<std::pair<double, QString>> ticks;
    std::vector<double> places;
    std::vector<double> values;  ///< of cost and error; empty for what was varied
  };
  const std::vector<Column>& columns() const { return columns_; }
  /// Places on an axis between which lines stay strong; none.
  void brush(size_t column, std::optional<std::pair<double, double>> between);
  bool isBrushedAway(size_t configuration) const;

 protected:
  void draw() override;
  void showEverything() override;
  void highlight() override;
  const PlotMark* markNear(QPointF pixel) const override;
  bool eventFilter(QObject*, QEvent*) override;

 private:
  struct Line {
    size_t configuration = 0;
    FrontPlace place = FrontPlace::Off;
    QCPGraph* graph = nullptr;
    std::vector<QPointF> points;
  };
  void addVaried();
  void addMeasured(const Front&);
  void drawColumns();
  void addLegend();
  QPen penOf(FrontPlace, QColor technique) const;
  std::optional<size_t> columnAt(QPointF pixel) const;

  PassPalette& techniques_;
  std::vector<Column> columns_;
  std::vector<Line> lines_;
  std::map<size_t, std::pair<double, double>> brushes_;
  QString brushesOf_;  ///< the titles of the columns they were made on
  std::optional<std::pair<size_t, double>> brushing_;
};

}  // namespace hl::ui
