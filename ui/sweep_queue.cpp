#include "ui/sweep_queue.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "ui/work_line.h"

namespace hl::ui {
namespace {

enum Column { Name, State, HowFar, Folder, ColumnCount };

QString stateText(SweepJob::State s) {
  switch (s) {
    case SweepJob::State::Waiting:
      return SweepQueue::tr("waits");
    case SweepJob::State::Running:
      return SweepQueue::tr("runs");
    case SweepJob::State::Done:
      return SweepQueue::tr("done");
    case SweepJob::State::Cancelled:
      return SweepQueue::tr("cancelled");
    case SweepJob::State::Failed:
      return SweepQueue::tr("failed");
  }
  return {};
}

}  // namespace

QString progressText(const SweepStatus& s) {
  if (s.total == 0) return {};
  QString text = SweepQueue::tr("%1 of %n runs", nullptr, static_cast<int>(s.total)).arg(s.done);
  if (s.failed) text += SweepQueue::tr(", %1 failed").arg(s.failed);
  if (s.secondsLeft >= 0 && s.done < s.total) text += SweepQueue::tr(", about %1 left").arg(durationText(s.secondsLeft));
  return text;
}

SweepProgressLine::SweepProgressLine(SweepRunner& runner, QWidget* parent)
    : QWidget(parent), runner_(runner), label_(new QLabel(this)), bar_(new QProgressBar(this)), cancel_(new QPushButton(tr("&Cancel"), this)) {
  setObjectName(QStringLiteral("sweepProgress"));
  auto* line = new QHBoxLayout(this);
  line->setContentsMargins(4, 2, 4, 2);
  label_->setTextFormat(Qt::PlainText);
  label_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  label_->setAccessibleName(tr("What the sweep does"));
  bar_->setAccessibleName(tr("Runs that are through"));
  bar_->setMaximumWidth(260);
  bar_->setMaximumHeight(fontMetrics().height() + 6);
  cancel_->setObjectName(QStringLiteral("cancelSweep"));
  cancel_->setToolTip(tr("What is done is kept, and the same experiment into the same folder goes on"));
  line->addWidget(label_, 1);
  line->addWidget(bar_);
  line->addWidget(cancel_);
  connect(cancel_, &QPushButton::clicked, this, [this] {
    cancel_->setEnabled(false);
    runner_.cancel(id_);
  });
  connect(&runner_, &SweepRunner::changed, this, &SweepProgressLine::read);
  connect(&runner_, &SweepRunner::listChanged, this, &SweepProgressLine::read);
  read();
}

void SweepProgressLine::read() {
  const auto& jobs = runner_.jobs();
  const auto runs = std::find_if(jobs.begin(), jobs.end(), [](const SweepJob& j) { return !j.over(); });
  setVisible(runs != jobs.end());
  if (runs == jobs.end()) return;
  if (runs->id != id_) cancel_->setEnabled(true);
  id_ = runs->id;
  const QString doing = QString::fromStdString(runs->status.doing);
  label_->setText(doing.isEmpty() ? tr("%1 waits").arg(runs->name) : QStringLiteral("%1: %2").arg(runs->name, doing));
  label_->setToolTip(label_->text() + QStringLiteral("\n") + tr("The window's own picture rests meanwhile; edits show between two runs"));
  bar_->setRange(0, std::max(1, static_cast<int>(runs->status.total)));
  bar_->setValue(static_cast<int>(runs->status.done));
  bar_->setFormat(progressText(runs->status));
  bar_->setToolTip(progressText(runs->status));
}

SweepQueue::SweepQueue(SweepRunner& runner, QWidget* parent)
    : QWidget(parent), runner_(runner), table_(new QTableWidget(0, ColumnCount, this)), cancel_(new QPushButton(tr("Ca&ncel"), this)), forget_(new QPushButton(tr("&Remove"), this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 4);
  table_->setObjectName(QStringLiteral("sweepQueue"));
  table_->setAccessibleName(tr("Experiments that run, wait and are through"));
  table_->setHorizontalHeaderLabels({tr("Experiment"), tr("State"), tr("How far"), tr("Results")});
  table_->verticalHeader()->hide();
  table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 8);
  table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  table_->setSelectionMode(QAbstractItemView::SingleSelection);
  table_->setTabKeyNavigation(false);
  table_->setWordWrap(false);
  table_->setMinimumHeight(60);
  const int em = fontMetrics().horizontalAdvance(QLatin1Char('0'));
  table_->setColumnWidth(Name, 20 * em);
  table_->setColumnWidth(State, 11 * em);
  table_->setColumnWidth(HowFar, 50 * em);
  table_->horizontalHeader()->setStretchLastSection(true);
  column->addWidget(table_, 1);
  auto* buttons = new QHBoxLayout;
  cancel_->setToolTip(tr("Stops it, or takes it out of the line; what is done is kept"));
  forget_->setToolTip(tr("Out of this list; its folder stays"));
  buttons->addWidget(cancel_);
  buttons->addWidget(forget_);
  buttons->addStretch(1);
  column->addLayout(buttons);
  connect(cancel_, &QPushButton::clicked, this, [this] { runner_.cancel(idAt(table_->currentRow())); });
  connect(forget_, &QPushButton::clicked, this, [this] { runner_.forget(idAt(table_->currentRow())); });
  connect(table_, &QTableWidget::cellClicked, this, [this](int row) { emit chosen(idAt(row)); });
  connect(table_, &QTableWidget::cellActivated, this, [this](int row) { emit chosen(idAt(row)); });
  connect(table_, &QTableWidget::currentCellChanged, this, &SweepQueue::updateButtons);
  connect(&runner_, &SweepRunner::listChanged, this, &SweepQueue::readAll);
  connect(&runner_, &SweepRunner::changed, this, &SweepQueue::readOne);
  readAll();
}

int SweepQueue::idAt(int row) const {
  const QTableWidgetItem* item = row >= 0 ? table_->item(row, Name) : nullptr;
  return item ? item->data(Qt::UserRole).toInt() : 0;
}

void SweepQueue::readAll() {
  const auto& jobs = runner_.jobs();
  table_->setRowCount(static_cast<int>(jobs.size()));
  for (size_t i = 0; i < jobs.size(); ++i) writeRow(static_cast<int>(i), jobs[i]);
  updateButtons();
}

void SweepQueue::readOne(int id) {
  for (int row = 0; row < table_->rowCount(); ++row)
    if (const SweepJob* job = idAt(row) == id ? runner_.job(id) : nullptr) writeRow(row, *job);
  updateButtons();
}

void SweepQueue::writeRow(int row, const SweepJob& job) {
  const QString far = job.over() ? job.message : progressText(job.status);
  const QString texts[ColumnCount] = {job.name, stateText(job.state), far, job.folder};
  for (int c = 0; c < ColumnCount; ++c) {
    QTableWidgetItem* item = table_->item(row, c);
    if (!item) table_->setItem(row, c, item = new QTableWidgetItem);
    if (item->text() != texts[c]) item->setText(texts[c]), item->setToolTip(texts[c]);
  }
  table_->item(row, Name)->setData(Qt::UserRole, job.id);
}

void SweepQueue::updateButtons() {
  const SweepJob* job = runner_.job(idAt(table_->currentRow()));
  cancel_->setEnabled(job && !job->over());
  forget_->setEnabled(job && job->over());
}

}  // namespace hl::ui
