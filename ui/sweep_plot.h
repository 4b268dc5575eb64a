#pragma once
// What all plots of a sweep share: what they show, when they draw, hovering, choosing a configuration, zoom, export.
#include <QString>
#include <QTimer>
#include <QWidget>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/sweep/curves.h"

class QCustomPlot;
class QCPTextElement;

namespace hl::ui {

class PlotExport;

/// Something in a plot that stands for a configuration.
struct PlotMark {
  size_t configuration = 0;
  double x = 0, y = 0;  ///< in the axes' coordinates
  QString text;         ///< what a hovering mouse shows
};

/// Drag moves, the wheel zooms, a double click shows everything again, a click chooses; so do the arrow keys and Enter.
class SweepPlot : public QWidget {
  Q_OBJECT
 public:
  ~SweepPlot() override;
  /// Drawn when it is seen, at most ten times a second. Null: nothing. The zoom stays while the choice does.
  void setView(std::shared_ptr<const SweepView>, const PlotChoice&);
  /// Whether seen or not.
  void drawNow();
  /// Everything in sight again.
  void resetZoom();
  /// Ringed or thick; none.
  void select(std::optional<size_t> configuration);
  std::optional<size_t> selected() const { return selected_; }

  /// Why nothing is drawn, or "". As of the last drawing, like what follows.
  const QString& nothing() const { return nothing_; }
  /// What the picture leaves out, and why, or "".
  const QString& note() const { return note_; }
  const std::vector<PlotMark>& marks() const { return marks_; }
  /// Of a mark on the plot, from its top left corner [pixels].
  QPointF pixelOf(const PlotMark&) const;
  /// The data as drawn, with a line of names first.
  virtual std::string csv() const = 0;
  /// The size at which a picture of it reads well.
  virtual QSize pictureSize() const { return {720, 460}; }
  QCustomPlot& plot() { return *plot_; }
  PlotExport& exporter() { return *export_; }

 signals:
  /// By a click or the Enter key.
  void chosen(size_t configuration);

 protected:
  /// `id`: the name of files and of the widget.
  SweepPlot(const QString& id, const QString& accessibleName, QWidget* parent);

  /// Fills the plot, which is empty, from view_ (not null, with runs) and choice_; fills marks_; sets nothing_ or note_.
  virtual void draw() = 0;
  /// Axes to what is drawn.
  virtual void showEverything() = 0;
  virtual void highlight() = 0;
  /// Null: none near.
  virtual const PlotMark* markNear(QPointF pixel) const;

  void setTitle(const QString&);
  QString labelOf(size_t configuration) const;
  QColor ink() const;
  QColor ground() const;

  void changeEvent(QEvent*) override;
  void showEvent(QShowEvent*) override;
  bool eventFilter(QObject*, QEvent*) override;

  QCustomPlot* plot_;
  std::shared_ptr<const SweepView> view_;
  PlotChoice choice_;
  std::vector<PlotMark> marks_;
  std::optional<size_t> selected_;
  QString nothing_, note_;

 private:
  void clear();
  void hover(QPointF);
  void step(int by);

  PlotExport* export_;
  QCPTextElement* title_;
  QCPTextElement* noteLine_;
  QTimer timer_;
  QPointF pressed_;
  bool stale_ = true, zoomed_ = false;
};

}  // namespace hl::ui
