#include "ui/technique_dock.h"

#include <QComboBox>
#include <QLabel>
#include <QSignalBlocker>
#include <QSplitter>
#include <QVBoxLayout>

#include "ui/parameter_panel.h"
#include "ui/pass_table.h"
#include "ui/rebuild_bar.h"
#include "ui/work_line.h"

namespace hl::ui {

TechniquePanel::TechniquePanel(Document& document, EngineLink& link, PassModel& passes, QWidget* parent)
    : QWidget(parent),
      document_(document),
      chooser_(new QComboBox(this)),
      summary_(new QLabel(this)),
      parameters_(new ParameterPanel(this)),
      work_(new WorkLine(tr("Bake"), this)) {
  auto* column = new QVBoxLayout(this);
  for (const TechniqueEntry& t : document.catalog().techniques()) {
    chooser_->addItem(QString::fromStdString(t.label), QString::fromStdString(t.id));
    chooser_->setItemData(chooser_->count() - 1, QString::fromStdString(t.summary), Qt::ToolTipRole);
  }
  chooser_->setAccessibleName(tr("Technique"));
  column->addWidget(chooser_);
  summary_->setWordWrap(true);
  summary_->setTextFormat(Qt::PlainText);
  column->addWidget(summary_);
  column->addWidget(work_);
  column->addWidget(new RebuildBar(document, this));

  auto* splitter = new QSplitter(Qt::Vertical, this);
  splitter->addWidget(parameters_);
  auto* below = new QWidget(splitter);
  auto* belowColumn = new QVBoxLayout(below);
  belowColumn->setContentsMargins(0, 0, 0, 0);
  auto* title = new QLabel(tr("Passes, in ms"), below);
  QFont bold = title->font();
  bold.setBold(true);
  title->setFont(bold);
  belowColumn->addWidget(title);
  belowColumn->addWidget(new PassTable(passes, {PassModel::Name, PassModel::Median, PassModel::Skipped}, below));
  splitter->addWidget(below);
  splitter->setStretchFactor(0, 3);
  splitter->setStretchFactor(1, 1);
  splitter->setChildrenCollapsible(false);
  column->addWidget(splitter, 1);

  connect(chooser_, &QComboBox::activated, this, [this] { document_.editTechnique(chooser_->currentData().toString().toStdString()); });
  connect(parameters_, &ParameterPanel::edited, this, [this](const std::map<std::string, std::string>& texts, quint64 drag) {
    const QString what = texts.size() == 1 ? QString::fromStdString(texts.begin()->first) : tr("reset of %1 parameters").arg(texts.size());
    document_.editParameters(texts, what, drag);
  });
  connect(parameters_, &ParameterPanel::message, this, &TechniquePanel::message);
  connect(work_, &WorkLine::cancelWanted, this, [&link] { link.cancelWork(); });
  connect(work_, &WorkLine::restartWanted, this, [&link] { link.restartWork(); });
  connect(&document_, &Document::techniqueChanged, this, &TechniquePanel::readTechnique);
  connect(&document_, &Document::presetChanged, this, [this] { parameters_->setValues(document_.preset().parameters); });
  connect(&document_.pendingRebuild(), &PendingRebuild::changed, this, [this] { parameters_->setWaiting(document_.pendingRebuild().parametersWanted()); });
  readTechnique();
}

void TechniquePanel::readTechnique() {
  const std::string& id = document_.preset().technique;
  if (id != shown_) {
    shown_ = id;
    const TechniqueEntry* entry = document_.catalog().technique(id);
    const QSignalBlocker block(chooser_);
    chooser_->setCurrentIndex(chooser_->findData(QString::fromStdString(id)));
    summary_->setText(entry ? QString::fromStdString(entry->summary) : QString());
    parameters_->setGroups(entry ? entry->groups : std::vector<ParameterGroup>{});
  }
  parameters_->setValues(document_.preset().parameters);
}

void TechniquePanel::showFrame(const FrameResult& frame) { work_->show(frame.technique); }

}  // namespace hl::ui
