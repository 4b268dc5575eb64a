#include "ui/profiler_dock.h"

#include <QHeaderView>
#include <QLabel>
#include <QLocale>
#include <QSplitter>
#include <QTabWidget>
#include <QTableWidget>
#include <QVBoxLayout>

#include "ui/pass_bars.h"
#include "ui/pass_table.h"

namespace hl::ui {
namespace {

constexpr int kDrawIntervalMs = 100;

}  // namespace

QString bytesText(uint64_t bytes) {
  return QLocale::c().formattedDataSize(static_cast<qint64>(bytes), 1, QLocale::DataSizeIecFormat);
}

ProfilerPanel::ProfilerPanel(PassPalette& palette, PassModel& passes, QWidget* parent)
    : QWidget(parent), bars_(new PassBars(palette, this)), memory_(new QTableWidget(0, 2, this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 4);
  auto* splitter = new QSplitter(Qt::Horizontal, this);
  splitter->addWidget(bars_);
  auto* tabs = new QTabWidget(splitter);
  tabs->setDocumentMode(true);
  tabs->addTab(new PassTable(passes, {PassModel::Name, PassModel::Where, PassModel::Last, PassModel::Median, PassModel::P5, PassModel::P95}, tabs),
               tr("Times"));
  memory_->setHorizontalHeaderLabels({tr("Resource"), tr("Size")});
  memory_->horizontalHeader()->setSectionResizeMode(0, QHeaderView::Stretch);
  memory_->horizontalHeader()->setHighlightSections(false);
  memory_->verticalHeader()->hide();
  memory_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  memory_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  memory_->setSelectionBehavior(QAbstractItemView::SelectRows);
  memory_->setAlternatingRowColors(true);
  memory_->setShowGrid(false);
  memory_->setTabKeyNavigation(false);
  memory_->setAccessibleName(tr("Memory by resource"));
  tabs->addTab(memory_, tr("Memory"));
  splitter->addWidget(tabs);
  splitter->setSizes({1000, 1000});  // halves
  splitter->setChildrenCollapsible(false);
  column->addWidget(splitter);
  timer_.setInterval(kDrawIntervalMs);
  timer_.setSingleShot(true);
  connect(&timer_, &QTimer::timeout, this, &ProfilerPanel::draw);
}

void ProfilerPanel::showFrame(std::shared_ptr<const FrameResult> frame) {
  if (!frame) return;
  if (frame->preset.technique != technique_) {
    technique_ = frame->preset.technique;
    bars_->clear();
  }
  frame_ = std::move(frame);
  bars_->add(frame_->number, frame_->lastPasses);
  stale_ = true;
  if (isVisible() && !timer_.isActive()) timer_.start();
}

void ProfilerPanel::showEvent(QShowEvent* event) {
  if (stale_ && !timer_.isActive()) timer_.start();
  QWidget::showEvent(event);
}

void ProfilerPanel::draw() {
  if (!stale_ || !frame_ || !isVisible()) return;
  stale_ = false;
  bars_->draw();
  showMemory(*frame_);
}

void ProfilerPanel::showMemory(const FrameResult& f) {
  memory_->setRowCount(static_cast<int>(f.memory.size()));
  const auto put = [&](int row, int column, const QString& text) {
    QTableWidgetItem* item = memory_->item(row, column);
    if (!item) {
      item = new QTableWidgetItem;
      if (column == 1) item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
      memory_->setItem(row, column, item);
    }
    if (item->text() != text) item->setText(text);
  };
  for (size_t i = 0; i < f.memory.size(); ++i) {
    put(static_cast<int>(i), 0, QString::fromStdString(f.memory[i].name));
    put(static_cast<int>(i), 1, bytesText(f.memory[i].bytes));
  }
}

}  // namespace hl::ui
