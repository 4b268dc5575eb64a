#include "ui/sweep_dock.h"

#include <QTabWidget>
#include <QVBoxLayout>

#include "ui/sweep_editor.h"
#include "ui/sweep_queue.h"
#include "ui/sweep_results.h"

namespace hl::ui {

SweepPanel::SweepPanel(Document& document, EngineLink& link, Settings& settings, PassPalette& palette, QWidget* parent) : QWidget(parent) {
  runner_ = new SweepRunner(link.sessionOptions(), link.gate(), this);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  column->addWidget(new SweepProgressLine(*runner_, this));
  pages_ = new QTabWidget(this);
  pages_->setObjectName(QStringLiteral("sweepPages"));
  pages_->setDocumentMode(true);
  pages_->setAccessibleName(tr("Sweep"));
  editor_ = new SweepEditor(document, settings, pages_);
  queue_ = new SweepQueue(*runner_, pages_);
  results_ = new SweepResultsPanel(palette, settings, pages_);
  pages_->addTab(editor_, tr("&Experiment"));
  pages_->addTab(queue_, tr("&Queue"));
  pages_->addTab(results_, tr("&Results"));
  column->addWidget(pages_, 1);

  connect(editor_, &SweepEditor::startWanted, this, [this](const QString& name, const Experiment& e, const QString& folder) {
    const bool alone = !runner_->busy();
    const int id = runner_->add(name, e, folder);
    if (alone) shownJob_ = id;  // what comes of it is shown as it comes
    pages_->setCurrentWidget(queue_);
    emit message(alone ? tr("%1 runs; its results go to %2").arg(name, folder) : tr("%1 waits for its turn").arg(name));
  });
  connect(editor_, &SweepEditor::message, this, &SweepPanel::message);
  connect(editor_, &SweepEditor::refused, this, &SweepPanel::refused);
  connect(editor_, &SweepEditor::saved, this, [this](const QString& path) { emit message(tr("Saved %1").arg(path)); });
  connect(editor_, &SweepEditor::opened, this, [this](const QString& path) { emit message(tr("Opened %1").arg(path)); });
  connect(results_, &SweepResultsPanel::refused, this, &SweepPanel::refused);
  connect(results_, &SweepResultsPanel::opened, this, [this](const QString& folder) {
    shownJob_ = 0;
    pages_->setCurrentWidget(results_);
    emit message(tr("Opened %1").arg(folder));
  });
  connect(results_, &SweepResultsPanel::configurationChosen, this, &SweepPanel::presetChosen);
  connect(queue_, &SweepQueue::chosen, this, &SweepPanel::showResultsOf);
  connect(runner_, &SweepRunner::results, this, &SweepPanel::onResults);
  connect(runner_, &SweepRunner::finished, this, &SweepPanel::onFinished);
  connect(runner_, &SweepRunner::busyChanged, this, &SweepPanel::busyChanged);
  connect(runner_, &SweepRunner::changed, this, &SweepPanel::readStatus);
  connect(runner_, &SweepRunner::listChanged, this, &SweepPanel::readStatus);
}

/// The runner first: its thread calls on the others.
SweepPanel::~SweepPanel() { delete runner_; }

void SweepPanel::sweepParameter(const std::string& key) {
  pages_->setCurrentWidget(editor_);
  editor_->addAxis(key);
}

void SweepPanel::openResults(const QString& folder) { results_->openFolder(folder); }

void SweepPanel::openExperiment(const QString& path) {
  pages_->setCurrentWidget(editor_);
  editor_->openExperiment(path);
}

void SweepPanel::onResults(int id, const SharedSweep& sweep) {
  newest_[id] = sweep;
  if (id != shownJob_ && (!results_->sweep() || results_->sweep()->results.folder == sweep->results.folder)) shownJob_ = id;
  if (id == shownJob_) results_->show(sweep);
}

void SweepPanel::onFinished(int id) {
  const SweepJob* job = runner_->job(id);
  if (!job) return;
  if (job->state == SweepJob::State::Failed)
    emit refused(tr("%1: %2").arg(job->name, job->message));
  else
    emit message(tr("%1: %2").arg(job->name, job->message));
  if (job->state == SweepJob::State::Done && id == shownJob_ && pages_->currentWidget() == queue_) pages_->setCurrentWidget(results_);
}

void SweepPanel::showResultsOf(int id) {
  const SweepJob* job = runner_->job(id);
  const auto newest = newest_.find(id);
  if (newest != newest_.end()) {
    shownJob_ = id;
    results_->show(newest->second);
    pages_->setCurrentWidget(results_);
  } else if (job && job->over()) {
    results_->openFolder(job->folder);
  }
}

void SweepPanel::readStatus() {
  QString text;
  for (const SweepJob& j : runner_->jobs())
    if (!j.over()) {
      const QString far = progressText(j.status);
      text = far.isEmpty() ? tr("Sweep") : tr("Sweep: %1").arg(far);
      break;
    }
  emit statusChanged(text);
}

}  // namespace hl::ui
