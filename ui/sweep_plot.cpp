#include "ui/sweep_plot.h"

#include <qcustomplot.h>

#include <cmath>

#include "ui/plot_export.h"
#include "ui/plot_style.h"

namespace hl::ui {
namespace {

constexpr int kDrawIntervalMs = 100;
constexpr double kNear = 12;       // pixels
constexpr double kClickWithin = 4;  // pixels between press and release

double distance(QPointF a, QPointF b) { return std::hypot(a.x() - b.x(), a.y() - b.y()); }

}  // namespace

SweepPlot::SweepPlot(const QString& id, const QString& accessibleName, QWidget* parent)
    : QWidget(parent), plot_(new QCustomPlot(this)), export_(new PlotExport(*plot_, *this, id, [this] { return csv(); })) {
  setObjectName(id);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(plot_);
  plot_->setMinimumHeight(120);
  plot_->setInteractions(QCP::iRangeDrag | QCP::iRangeZoom);
  plot_->setAutoAddPlottableToLegend(false);
  plot_->setFocusPolicy(Qt::StrongFocus);
  plot_->setAccessibleName(accessibleName);
  // Title, axes, legend, note, one below the other: a legend among the data would hide some.
  title_ = new QCPTextElement(plot_);
  plot_->plotLayout()->insertRow(0);
  plot_->plotLayout()->addElement(0, 0, title_);
  plot_->axisRect()->insetLayout()->take(plot_->legend);
  plot_->plotLayout()->addElement(2, 0, plot_->legend);
  plot_->legend->setFillOrder(QCPLayoutGrid::foColumnsFirst);
  plot_->legend->setMaximumSize(QWIDGETSIZE_MAX - 1, QWIDGETSIZE_MAX - 1);  // without entries it would squeeze all that is above it to its own width
  plot_->legend->setMargins(QMargins(8, 0, 8, 2));
  noteLine_ = new QCPTextElement(plot_);
  plot_->plotLayout()->addElement(3, 0, noteLine_);
  for (const int row : {0, 2, 3}) plot_->plotLayout()->setRowStretchFactor(row, 0.001);
  plot_->plotLayout()->setRowSpacing(0);
  stylePlot(*plot_, *this);
  export_->showEverything = [this] { resetZoom(); };
  plot_->installEventFilter(this);
  connect(plot_, &QCustomPlot::mouseMove, this, [this](QMouseEvent* e) {
    if (e->buttons() & Qt::LeftButton && distance(e->position(), pressed_) > kClickWithin) zoomed_ = true;
    hover(e->position());
  });
  connect(plot_, &QCustomPlot::mouseWheel, this, [this] { zoomed_ = true; });
  connect(plot_, &QCustomPlot::mousePress, this, [this](QMouseEvent* e) { pressed_ = e->position(); });
  connect(plot_, &QCustomPlot::mouseDoubleClick, this, [this] { resetZoom(); });
  connect(plot_, &QCustomPlot::mouseRelease, this, [this](QMouseEvent* e) {
    if (e->button() != Qt::LeftButton || distance(e->position(), pressed_) > kClickWithin) return;
    if (const PlotMark* mark = markNear(e->position())) {
      select(mark->configuration);
      emit chosen(*selected_);
    }
  });
  timer_.setInterval(kDrawIntervalMs);
  timer_.setSingleShot(true);
  connect(&timer_, &QTimer::timeout, this, &SweepPlot::drawNow);
}

SweepPlot::~SweepPlot() = default;

void SweepPlot::setView(std::shared_ptr<const SweepView> view, const PlotChoice& choice) {
  if (choice.problem != choice_.problem || choice.reference != choice_.reference || choice.metric != choice_.metric || choice.cost != choice_.cost) zoomed_ = false;
  view_ = std::move(view);
  choice_ = choice;
  stale_ = true;
  if (isVisible() && !timer_.isActive()) timer_.start();
}

void SweepPlot::showEvent(QShowEvent* event) {
  if (stale_ && !timer_.isActive()) timer_.start();
  QWidget::showEvent(event);
}

void SweepPlot::clear() {
  plot_->clearPlottables();
  plot_->clearItems();
  plot_->legend->clearItems();
  marks_.clear();
  nothing_.clear(), note_.clear();
  for (QCPAxis* axis : {plot_->xAxis, plot_->yAxis}) axis->setVisible(true), axis->grid()->setVisible(true);
}

void SweepPlot::drawNow() {
  stale_ = false;
  clear();
  setTitle({});
  if (!view_ || choice_.problem >= view_->results.problems.size() || view_->results.done() == 0) {
    nothing_ = tr("No run is done yet.");
  } else {
    draw();
  }
  noteLine_->setText(note_);
  noteLine_->setVisible(!note_.isEmpty());
  plot_->legend->setVisible(nothing_.isEmpty() && plot_->legend->itemCount() > 0);
  if (!nothing_.isEmpty()) {
    marks_.clear();
    plot_->clearPlottables(), plot_->clearItems();
    drawNothing(*plot_, nothing_);
  } else {
    if (!zoomed_) showEverything();
    highlight();
  }
  settleLayout(*plot_, plot_->viewport().size());
  plot_->replot(QCustomPlot::rpQueuedReplot);
}

void SweepPlot::resetZoom() {
  zoomed_ = false;
  if (!nothing_.isEmpty()) return;
  showEverything();
  plot_->replot(QCustomPlot::rpQueuedReplot);
}

void SweepPlot::select(std::optional<size_t> configuration) {
  selected_ = configuration;
  if (stale_ || !nothing_.isEmpty()) return;
  highlight();
  plot_->replot(QCustomPlot::rpQueuedReplot);
}

QPointF SweepPlot::pixelOf(const PlotMark& m) const { return {plot_->xAxis->coordToPixel(m.x), plot_->yAxis->coordToPixel(m.y)}; }

const PlotMark* SweepPlot::markNear(QPointF pixel) const {
  const PlotMark* best = nullptr;
  double least = kNear;
  for (const PlotMark& m : marks_)
    if (const double d = distance(pixelOf(m), pixel); d < least) best = &m, least = d;
  return best;
}

void SweepPlot::hover(QPointF at) {
  const PlotMark* mark = markNear(at);
  plot_->setToolTip(mark ? mark->text : QString());
  plot_->setCursor(mark ? Qt::PointingHandCursor : Qt::ArrowCursor);
}

/// Through the configurations in the order of the marks.
void SweepPlot::step(int by) {
  if (marks_.empty()) return;
  const int count = static_cast<int>(marks_.size());
  int at = by > 0 ? -1 : count;
  for (int i = 0; i < count; ++i)
    if (selected_ && marks_[static_cast<size_t>(i)].configuration == *selected_) at = i;
  do at += by;
  while (at >= 0 && at < count && selected_ && marks_[static_cast<size_t>(at)].configuration == *selected_);
  if (at < 0 || at >= count) return;
  const PlotMark& m = marks_[static_cast<size_t>(at)];
  select(m.configuration);
  QToolTip::showText(plot_->mapToGlobal(pixelOf(m).toPoint()), m.text, plot_);
}

bool SweepPlot::eventFilter(QObject* watched, QEvent* event) {
  if (watched == plot_ && event->type() == QEvent::KeyPress) {
    const int key = static_cast<QKeyEvent*>(event)->key();
    if (key == Qt::Key_Right || key == Qt::Key_Left) {
      step(key == Qt::Key_Right ? 1 : -1);
      return true;
    }
    if ((key == Qt::Key_Return || key == Qt::Key_Enter) && selected_) {
      emit chosen(*selected_);
      return true;
    }
  }
  return QWidget::eventFilter(watched, event);
}

void SweepPlot::setTitle(const QString& text) {
  title_->setText(text);
  title_->setVisible(!text.isEmpty());
  QFont f = font();
  f.setBold(true);
  title_->setFont(f);
  title_->setTextColor(ink());
  noteLine_->setTextColor(ink());
  f = font();
  f.setPointSizeF(f.pointSizeF() * 0.9);
  noteLine_->setFont(f);
}

QString SweepPlot::labelOf(size_t configuration) const { return QString::fromStdString(shortLabel(view_->results, configuration)); }

QColor SweepPlot::ink() const { return palette().color(QPalette::Text); }
QColor SweepPlot::ground() const { return palette().color(QPalette::Base); }

void SweepPlot::changeEvent(QEvent* event) {
  if (event->type() == QEvent::PaletteChange || event->type() == QEvent::FontChange) {
    stylePlot(*plot_, *this);
    if (!stale_) drawNow();
  }
  QWidget::changeEvent(event);
}

}  // namespace hl::ui
