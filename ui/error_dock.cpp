#include "ui/error_dock.h"

#include <QCheckBox>
#include <QComboBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QSplitter>
#include <QTabWidget>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "engine/metrics/metrics.h"
#include "ui/engine_link.h"
#include "ui/error_plot.h"
#include "ui/work_line.h"

namespace hl::ui {
namespace {

constexpr int kDrawIntervalMs = 100;
enum Column { Component, Metric, Matched, MatchedFloor, Full, FullFloor, ColumnCount };

QString number(double v) { return QString::number(v, 'g', 4); }

}  // namespace

ErrorPanel::ErrorPanel(EngineLink& link, QWidget* parent)
    : QWidget(parent),
      link_(link),
      wanted_(new QCheckBox(tr("Trace the reference"), this)),
      metric_(new QComboBox(this)),
      component_(new QComboBox(this)),
      axis_(new QComboBox(this)),
      table_(new QTableWidget(0, ColumnCount, this)),
      hint_(new QLabel(this)),
      pages_(new QTabWidget(this)),
      plot_(new ErrorPlot(this)),
      work_(new WorkLine(tr("Reference"), this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 4);
  auto* line = new QHBoxLayout;
  wanted_->setToolTip(tr("Trace the reference between frames, once the technique has settled, and measure against it"));
  line->addWidget(wanted_);
  line->addWidget(work_, 1);
  column->addLayout(line);

  auto* splitter = new QSplitter(Qt::Horizontal, this);
  auto* left = new QWidget(splitter);
  auto* leftColumn = new QVBoxLayout(left);
  leftColumn->setContentsMargins(0, 0, 0, 0);
  auto* choices = new QHBoxLayout;
  for (const MetricInfo& m : metricInfos()) {
    metric_->addItem(QString::fromUtf8(m.label.data(), static_cast<qsizetype>(m.label.size())),
                     QString::fromUtf8(m.id.data(), static_cast<qsizetype>(m.id.size())));
    metric_->setItemData(metric_->count() - 1, QString::fromUtf8(m.formula.data(), static_cast<qsizetype>(m.formula.size())), Qt::ToolTipRole);
  }
  metric_->setCurrentIndex(std::max(0, metric_->findData(QStringLiteral("relmse"))));
  metric_->setAccessibleName(tr("Metric"));
  component_->addItem(tr("indirect light"), QStringLiteral("indirect"));
  component_->addItem(tr("specular light"), QStringLiteral("specular"));
  component_->setItemData(1, tr("Indirect light that glossy surfaces reflect by their lobes; only where the camera sees some"), Qt::ToolTipRole);
  component_->addItem(tr("final picture"), QStringLiteral("final"));
  component_->setAccessibleName(tr("Component"));
  axis_->addItem(tr("over time"));
  axis_->addItem(tr("over frames"));
  axis_->setAccessibleName(tr("Axis"));
  for (QComboBox* c : {metric_, component_, axis_}) {
    choices->addWidget(c);
    connect(c, &QComboBox::currentIndexChanged, this, &ErrorPanel::draw);
  }
  choices->addStretch(1);
  leftColumn->addLayout(choices);
  leftColumn->addWidget(plot_, 1);
  splitter->addWidget(left);

  auto* right = new QWidget;
  auto* rightColumn = new QVBoxLayout(right);
  rightColumn->setContentsMargins(0, 0, 0, 0);
  hint_->setWordWrap(true);
  hint_->setForegroundRole(QPalette::PlaceholderText);
  rightColumn->addWidget(hint_);
  table_->setHorizontalHeaderLabels({tr("Of"), tr("Metric"), tr("Matched"), tr("floor"), tr("Full"), tr("floor")});
  table_->horizontalHeaderItem(Matched)->setToolTip(tr("Against a reference limited to the light paths that the technique models: what it gets wrong"));
  table_->horizontalHeaderItem(Full)->setToolTip(tr("Against the full reference: what it gets wrong and what it does not model"));
  for (const int c : {MatchedFloor, FullFloor})
    table_->horizontalHeaderItem(c)->setToolTip(tr("Noise floor: the reference's own variance, in the metric's unit"));
  table_->horizontalHeader()->setHighlightSections(false);
  table_->verticalHeader()->hide();
  table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  table_->setAlternatingRowColors(true);
  table_->setShowGrid(false);
  table_->setTabKeyNavigation(false);
  table_->setAccessibleName(tr("Errors"));
  const int em = fontMetrics().horizontalAdvance(QStringLiteral("0"));
  const int widths[ColumnCount] = {8, 8, 17, 8, 17, 8};
  for (int c = 0; c < ColumnCount; ++c) table_->setColumnWidth(c, widths[c] * em);
  rightColumn->addWidget(table_, 1);
  pages_->addTab(right, tr("Errors"));
  pages_->setDocumentMode(true);
  splitter->addWidget(pages_);
  splitter->setSizes({900, 1100});
  splitter->setChildrenCollapsible(false);
  column->addWidget(splitter, 1);

  connect(wanted_, &QCheckBox::toggled, this, [this](bool on) { link_.setReferenceWanted(on); });
  connect(work_, &WorkLine::cancelWanted, this, [this] { link_.cancelWork(); });
  connect(work_, &WorkLine::restartWanted, this, [this] { link_.restartWork(); });
  timer_.setInterval(kDrawIntervalMs);
  timer_.setSingleShot(true);
  connect(&timer_, &QTimer::timeout, this, &ErrorPanel::draw);
  draw();
}

void ErrorPanel::addPage(QWidget* page, const QString& title) { pages_->addTab(page, title); }

void ErrorPanel::setReferenceWanted(bool wanted) { wanted_->setChecked(wanted); }

void ErrorPanel::showFrame(std::shared_ptr<const FrameResult> frame) {
  frame_ = std::move(frame);
  if (isVisible() && !timer_.isActive()) timer_.start();
}

void ErrorPanel::showEvent(QShowEvent* event) {
  if (!timer_.isActive()) timer_.start();
  QWidget::showEvent(event);
}

void ErrorPanel::draw() {
  static const FrameResult nothing;
  const FrameResult& f = frame_ ? *frame_ : nothing;
  WorkReport reference = f.reference;
  if (reference.label.empty()) reference.label = tr("starts once the technique has settled").toStdString(), reference.done = 0;
  work_->show(reference);
  work_->setVisible(wanted_->isChecked());
  plot_->draw(*f.convergence, metric_->currentData().toString().toStdString(), component_->currentData().toString().toStdString(),
              axis_->currentIndex() == 1);
  fillTable(f);
}

void ErrorPanel::fillTable(const FrameResult& f) {
  const bool bad = std::any_of(f.errors.begin(), f.errors.end(), [](const ErrorValue& e) { return e.nonFinite > 0; });
  hint_->setVisible(f.errors.empty() || bad);
  hint_->setText(bad ? tr("NaN or Inf pixels: these figures are not valid.")
                 : wanted_->isChecked() ? tr("Measured once the reference has its first pass.")
                                        : tr("Trace the reference to measure against it."));
  // One row a component and metric, with both references side by side.
  struct Row {
    const ErrorValue* matched = nullptr;
    const ErrorValue* full = nullptr;
  };
  std::vector<std::pair<std::string, Row>> rows;
  for (const ErrorValue& e : f.errors) {
    const std::string key = e.target + '\n' + e.component + '\n' + e.roi + '\n' + e.metric;
    auto found = std::find_if(rows.begin(), rows.end(), [&](const auto& r) { return r.first == key; });
    if (found == rows.end()) found = rows.insert(rows.end(), {key, {}});
    (e.reference == "full" ? found->second.full : found->second.matched) = &e;
  }
  table_->setRowCount(static_cast<int>(rows.size()));
  const auto put = [&](int row, int c, const QString& text) {
    QTableWidgetItem* item = table_->item(row, c);
    if (!item) {
      item = new QTableWidgetItem;
      if (c >= Matched) item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
      table_->setItem(row, c, item);
    }
    if (item->text() != text) item->setText(text);
  };
  const auto value = [](const ErrorValue* e) {
    if (!e) return QStringLiteral("-");
    return e->standardError > 0 ? QStringLiteral("%1 \u00b1 %2").arg(number(e->value), QString::number(e->standardError, 'g', 2)) : number(e->value);
  };
  for (size_t i = 0; i < rows.size(); ++i) {
    const Row& r = rows[i].second;
    const ErrorValue& any = r.matched ? *r.matched : *r.full;
    const int row = static_cast<int>(i);
    QString of = QString::fromStdString(any.component);
    if (any.target != "image") of = QString::fromStdString(any.target);
    if (!any.roi.empty()) of += QStringLiteral(", ") + QString::fromStdString(any.roi);
    put(row, Component, of);
    put(row, Metric, QString::fromStdString(any.metric));
    put(row, Matched, value(r.matched));
    put(row, MatchedFloor, r.matched && r.matched->noiseFloor > 0 ? QString::number(r.matched->noiseFloor, 'g', 2) : QString());
    put(row, Full, value(r.full));
    put(row, FullFloor, r.full && r.full->noiseFloor > 0 ? QString::number(r.full->noiseFloor, 'g', 2) : QString());
  }
}

}  // namespace hl::ui
