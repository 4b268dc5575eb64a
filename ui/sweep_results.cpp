#include "ui/sweep_results.h"

#include <QFileDialog>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QItemSelectionModel>
#include <QLabel>
#include <QMetaObject>
#include <QPushButton>
#include <QResizeEvent>
#include <QSplitter>
#include <QTableView>
#include <QVBoxLayout>
#include <algorithm>
#include <new>
#include <utility>

#include "engine/core/error.h"
#include "ui/background.h"
#include "ui/settings.h"
#include "ui/sweep_plots.h"
#include "ui/sweep_table.h"

namespace hl::ui {
namespace {

QString fromStd(const std::string& s) { return QString::fromStdString(s); }

}  // namespace

SweepResultsPanel::SweepResultsPanel(PassPalette& palette, Settings& settings, QWidget* parent)
    : QWidget(parent), about_(new QLabel(this)), halves_(new QSplitter(Qt::Horizontal, this)), model_(new SweepTableModel(this)), table_(new QTableView(halves_)),
      plots_(new SweepPlots(palette, &settings, halves_)) {
  setObjectName(QStringLiteral("sweepResults"));
  worker_.setMaxThreadCount(1);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 4);
  auto* first = new QHBoxLayout;
  auto* open = new QPushButton(tr("&Open results..."), this);
  open->setObjectName(QStringLiteral("openResults"));
  open->setToolTip(tr("A folder that a sweep or halflight-cli bench has written; or drop it on the window"));
  about_->setTextFormat(Qt::PlainText);
  about_->setAccessibleName(tr("About these results"));
  about_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  first->addWidget(open);
  first->addWidget(about_, 1);
  column->addLayout(first);
  halves_->setChildrenCollapsible(false);
  table_->setObjectName(QStringLiteral("sweepTable"));
  table_->setAccessibleName(tr("Configurations with their cost and error"));
  table_->setModel(model_);
  table_->horizontalHeader()->setSortIndicator(-1, Qt::AscendingOrder);
  table_->setSortingEnabled(true);
  table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  table_->setSelectionMode(QAbstractItemView::SingleSelection);
  table_->setTabKeyNavigation(false);
  table_->setWordWrap(false);
  table_->verticalHeader()->hide();
  table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  table_->horizontalHeader()->setMinimumSectionSize(fontMetrics().horizontalAdvance(QLatin1Char('0')) * 4);
  table_->setMinimumSize(120, 60);
  halves_->addWidget(table_);
  halves_->addWidget(plots_);
  halves_->setStretchFactor(0, 2);
  halves_->setStretchFactor(1, 3);
  halves_->setSizes({450, 550});
  column->addWidget(halves_, 1);
  connect(open, &QPushButton::clicked, this, [this] {
    auto* dialog = new QFileDialog(this, tr("Open results"), sweep_ ? fromStd(sweep_->results.folder.parent_path().string()) : QString());
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setFileMode(QFileDialog::Directory);
    dialog->setOption(QFileDialog::ShowDirsOnly);
    connect(dialog, &QFileDialog::fileSelected, this, &SweepResultsPanel::openFolder);
    dialog->open();
  });
  connect(table_, &QTableView::clicked, this, [this](const QModelIndex& i) { load(model_->configurationAt(i.row())); });
  connect(table_, &QTableView::activated, this, [this](const QModelIndex& i) {
    if (i.isValid()) load(model_->configurationAt(i.row()));
  });
  connect(table_->selectionModel(), &QItemSelectionModel::currentRowChanged, this, [this](const QModelIndex& i) {
    if (i.isValid()) plots_->select(model_->configurationAt(i.row()));
  });
  connect(plots_, &SweepPlots::chosen, this, [this](size_t configuration) {
    if (const int row = model_->rowOf(configuration); row >= 0) table_->setCurrentIndex(model_->index(row, 0));
    load(configuration);
  });
  connect(plots_, &SweepPlots::choiceChanged, this, &SweepResultsPanel::work);
  show(nullptr);
}

SweepResultsPanel::~SweepResultsPanel() { worker_.waitForDone(); }

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
  SharedSweep before = std::exchange(sweep_, sweep);
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
  plots_->setView(sweep_);
  dropElsewhere(std::move(before));
  work();
}

void SweepResultsPanel::work() {
  const quint64 number = ++asked_;
  if (!sweep_) {
    showRows({}, number);
    return;
  }
  worker_.start([this, sweep = sweep_, choice = plots_->choice(), number]() mutable {
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
