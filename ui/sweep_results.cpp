#include "ui/sweep_results.h"

#include <QComboBox>
#include <QFileDialog>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QMetaObject>
#include <QPointer>
#include <QPushButton>
#include <QResizeEvent>
#include <QSignalBlocker>
#include <QSplitter>
#include <QTabWidget>
#include <QTableView>
#include <QVBoxLayout>
#include <algorithm>
#include <new>
#include <utility>

#include "engine/core/error.h"
#include "engine/metrics/metrics.h"
#include "ui/background.h"
#include "ui/sweep_table.h"

namespace hl::ui {
namespace {

QString fromStd(const std::string& s) { return QString::fromStdString(s); }

void select(QComboBox& box, const QVariant& data) {
  const int at = box.findData(data);
  if (at >= 0) box.setCurrentIndex(at);
}

}  // namespace

SweepResultsPanel::SweepResultsPanel(PassPalette& palette, QWidget* parent) : QWidget(parent), palette_(palette) {
  setObjectName(QStringLiteral("sweepResults"));
  worker_.setMaxThreadCount(1);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 4);
  column->addWidget(makeChoices());
  halves_ = new QSplitter(Qt::Horizontal, this);
  halves_->setChildrenCollapsible(false);
  model_ = new SweepTableModel(this);
  table_ = new QTableView(halves_);
  table_->setObjectName(QStringLiteral("sweepTable"));
  table_->setAccessibleName(tr("Configurations with their cost and error"));
  table_->setModel(model_);
  table_->setSortingEnabled(true);
  table_->sortByColumn(-1, Qt::AscendingOrder);
  table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  table_->setSelectionMode(QAbstractItemView::SingleSelection);
  table_->setTabKeyNavigation(false);
  table_->setWordWrap(false);
  table_->verticalHeader()->hide();
  table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  table_->horizontalHeader()->setMinimumSectionSize(fontMetrics().horizontalAdvance(QLatin1Char('0')) * 4);
  table_->setMinimumSize(120, 60);
  halves_->addWidget(table_);
  plots_ = new QTabWidget(halves_);
  plots_->setObjectName(QStringLiteral("sweepPlots"));
  plots_->setDocumentMode(true);
  plots_->hide();
  halves_->addWidget(plots_);
  column->addWidget(halves_, 1);
  connect(table_, &QTableView::clicked, this, [this](const QModelIndex& i) { load(model_->configurationAt(i.row())); });
  connect(table_, &QTableView::activated, this, [this](const QModelIndex& i) {
    if (i.isValid()) load(model_->configurationAt(i.row()));
  });
  show(nullptr);
}

SweepResultsPanel::~SweepResultsPanel() { worker_.waitForDone(); }

QWidget* SweepResultsPanel::makeChoices() {
  auto* box = new QWidget(this);
  auto* column = new QVBoxLayout(box);
  column->setContentsMargins(0, 0, 0, 0);
  auto* first = new QHBoxLayout;
  auto* open = new QPushButton(tr("&Open results..."), box);
  open->setObjectName(QStringLiteral("openResults"));
  open->setToolTip(tr("A folder that a sweep or halflight-cli bench has written; or drop it on the window"));
  about_ = new QLabel(box);
  about_->setTextFormat(Qt::PlainText);
  about_->setAccessibleName(tr("About these results"));
  about_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  first->addWidget(open);
  first->addWidget(about_, 1);
  column->addLayout(first);
  auto* second = new QHBoxLayout;
  const auto chooser = [&](const QString& name, const QString& id, const QString& tip) {
    auto* label = new QLabel(name, box);
    auto* c = new QComboBox(box);
    c->setObjectName(id);
    c->setAccessibleName(QString(name).remove('&'));
    c->setToolTip(tip);
    c->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    c->setMinimumContentsLength(8);
    label->setBuddy(c);
    second->addWidget(label);
    second->addWidget(c, 1);
    connect(c, &QComboBox::activated, this, &SweepResultsPanel::takeChoice);
    return c;
  };
  cost_ = chooser(tr("&Cost"), QStringLiteral("sweepCost"), tr("What stands against the error"));
  const std::pair<QString, FrontAxis> costs[] = {{tr("Total time"), FrontAxis::Total}, {tr("Frame"), FrontAxis::Frame}, {tr("Frame and its share of the bake"), FrontAxis::Amortised}, {tr("Memory"), FrontAxis::Memory}};
  for (const auto& [name, axis] : costs) cost_->addItem(name, static_cast<int>(axis));
  metric_ = chooser(tr("&Metric"), QStringLiteral("sweepMetric"), tr("Of indirect light, over the whole picture"));
  reference_ = chooser(tr("Re&ference"), QStringLiteral("sweepReference"), tr("matched: along the light paths that the technique models; full: along all"));
  problem_ = chooser(tr("&Problem"), QStringLiteral("sweepProblem"), tr("Configurations whose errors can be compared: the same scene, camera, resolution and reference"));
  column->addLayout(second);
  connect(open, &QPushButton::clicked, this, [this] {
    auto* dialog = new QFileDialog(this, tr("Open results"), sweep_ ? fromStd(sweep_->results.folder.parent_path().string()) : QString());
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setFileMode(QFileDialog::Directory);
    dialog->setOption(QFileDialog::ShowDirsOnly);
    connect(dialog, &QFileDialog::fileSelected, this, &SweepResultsPanel::openFolder);
    dialog->open();
  });
  return box;
}

void SweepResultsPanel::openFolder(const QString& folder) {
  worker_.start([this, folder] {
    giveWay();
    SharedSweep read;
    QString why;
    try {
      auto view = std::make_shared<SweepView>();
      view->results = openSweep(folder.toStdString());
      if (view->results.done() == 0) throw badInput(folder.toStdString() + ": this folder holds no runs of its experiment");
      view->summary = summarise(view->results);
      read = std::move(view);
    } catch (const std::bad_alloc&) {
      why = tr("%1: out of memory").arg(folder);
    } catch (const std::exception& e) {
      why = QString::fromUtf8(e.what());
    }
    QMetaObject::invokeMethod(
        this,
        [this, folder, read, why] {
          if (!read) {
            emit refused(why);
            return;
          }
          show(read);
          emit opened(folder);
        },
        Qt::QueuedConnection);
  });
}

/// Thousands of runs take long to give back to the heap.
void SweepResultsPanel::dropElsewhere(SharedSweep sweep) {
  if (sweep) worker_.start([sweep = std::move(sweep)]() mutable { sweep.reset(); });
}

void SweepResultsPanel::show(const SharedSweep& sweep) {
  dropElsewhere(std::exchange(sweep_, sweep));
  if (sweep_) {
    const SweepResults& r = sweep_->results;
    QString text = tr("%1: %2 of %n runs", nullptr, static_cast<int>(r.plan.size())).arg(fromStd(r.folder.string())).arg(r.done());
    if (r.failed()) text += tr(", %1 failed").arg(r.failed());
    text += QStringLiteral("  \u2022  ") + fromStd(r.provenance.device) + QStringLiteral(", ") + fromStd(r.provenance.commit) + (r.provenance.dirty ? tr(" with changes") : QString());
    about_->setText(text);
    about_->setToolTip(text);
  } else {
    about_->setText(tr("No results yet: start an experiment, or open a folder"));
  }
  fillChoices();
  work();
}

void SweepResultsPanel::fillChoices() {
  const QSignalBlocker blocks[] = {QSignalBlocker(problem_), QSignalBlocker(reference_), QSignalBlocker(metric_), QSignalBlocker(cost_)};
  for (QComboBox* c : {problem_, reference_, metric_, cost_}) c->setEnabled(sweep_ != nullptr);
  for (QComboBox* c : {problem_, reference_, metric_}) c->clear();
  if (!sweep_) return;
  const SweepResults& r = sweep_->results;
  for (size_t i = 0; i < r.problems.size(); ++i) problem_->addItem(fromStd(r.problems[i].label), static_cast<qulonglong>(i));
  for (const std::string& reference : r.experiment.references) reference_->addItem(fromStd(reference), fromStd(reference));
  for (const std::string& metric : plottedMetrics(r)) metric_->addItem(fromStd(metric), fromStd(metric));
  for (int i = 0; i < metric_->count(); ++i)
    for (const MetricInfo& m : metricInfos())
      if (metric_->itemData(i).toString().toStdString() == m.id) metric_->setItemData(i, QString::fromUtf8(m.formula.data(), static_cast<qsizetype>(m.formula.size())), Qt::ToolTipRole);
  select(*problem_, static_cast<qulonglong>(choice_.problem));
  select(*reference_, fromStd(choice_.reference));
  select(*metric_, fromStd(choice_.metric));
  select(*cost_, static_cast<int>(choice_.cost));
  choice_.problem = problem_->count() ? problem_->currentData().toULongLong() : 0;
  choice_.reference = reference_->currentData().toString().toStdString();
  choice_.metric = metric_->currentData().toString().toStdString();
}

void SweepResultsPanel::takeChoice() {
  choice_.problem = problem_->currentData().toULongLong();
  choice_.reference = reference_->currentData().toString().toStdString();
  choice_.metric = metric_->currentData().toString().toStdString();
  choice_.cost = static_cast<FrontAxis>(cost_->currentData().toInt());
  work();
}

void SweepResultsPanel::choose(const PlotChoice& choice) {
  choice_ = choice;
  fillChoices();
  work();
}

void SweepResultsPanel::work() {
  const quint64 number = ++asked_;
  if (!sweep_) {
    showRows({}, number);
    return;
  }
  worker_.start([this, sweep = sweep_, choice = choice_, number]() mutable {
    giveWay();
    auto rows = std::make_shared<SweepRows>(sweepRows(*sweep, choice));
    sweep.reset();  // here, where it may take its time
    QMetaObject::invokeMethod(this, [this, rows, number] { showRows(std::move(*rows), number); }, Qt::QueuedConnection);
  });
}

void SweepResultsPanel::showRows(SweepRows rows, quint64 number) {
  if (number != asked_) return;  // something newer is under way
  const bool sameColumns = rows.keys == model_->rows().keys && !model_->rows().rows.empty();
  const QModelIndex current = table_->currentIndex();
  const std::optional<size_t> chosen = current.isValid() ? std::optional(model_->configurationAt(current.row())) : std::nullopt;
  const int column = current.column();
  model_->show(std::move(rows));
  if (chosen && sameColumns)
    if (const int row = model_->rowOf(*chosen); row >= 0) table_->setCurrentIndex(model_->index(row, column));
  if (!sameColumns) {
    const int em = fontMetrics().horizontalAdvance(QLatin1Char('0'));
    for (int c = 0; c < model_->columnCount(); ++c) {
      const QString title = model_->headerData(c, Qt::Horizontal, Qt::DisplayRole).toString();
      const int widest = c < model_->firstFixed() ? 8 : 10;
      table_->setColumnWidth(c, std::max(widest * em, fontMetrics().horizontalAdvance(title) + 4 * em));
    }
  }
  for (SweepPlot* plot : allPlots_) Q_UNUSED(plot);
}

void SweepResultsPanel::load(size_t configuration) {
  if (!sweep_) return;
  for (const PlannedRun& run : sweep_->results.plan)
    if (run.configuration == configuration) {
      emit configurationChosen(run.preset, fromStd(shortLabel(sweep_->results, configuration)));
      return;
    }
}

/// Table and plots beside each other, or one above the other in a dock that is higher than wide.
void SweepResultsPanel::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  halves_->setOrientation(event->size().width() >= event->size().height() ? Qt::Horizontal : Qt::Vertical);
}

}  // namespace hl::ui
