#include "ui/probes_panel.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "ui/rebuild_bar.h"

namespace hl::ui {
namespace {

const std::string kPlacement = "probes.placement", kManual = "manual";

}  // namespace

ProbesPanel::ProbesPanel(Document& document, QWidget* parent)
    : QWidget(parent),
      document_(document),
      facts_(new QLabel(this)),
      table_(new QTableWidget(0, 3, this)),
      edit_(new QPushButton(tr("&Edit by hand"), this)),
      add_(new QPushButton(tr("Add at &camera"), this)),
      remove_(new QPushButton(tr("&Delete"), this)),
      reset_(new QPushButton(tr("The scene's &own"), this)) {
  auto* column = new QVBoxLayout(this);
  facts_->setWordWrap(true);
  facts_->setTextFormat(Qt::PlainText);
  facts_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  facts_->setAccessibleName(tr("Probes and their coverage"));
  column->addWidget(facts_);
  column->addWidget(new RebuildBar(document, this));
  auto* buttons = new QHBoxLayout;
  edit_->setCheckable(true);
  edit_->setToolTip(tr("In the viewport (H): drag a probe, with Shift up and down, with Ctrl along x, with Alt along z; click a surface to add one in front of it; Delete removes the chosen one"));
  add_->setToolTip(tr("A probe where the camera is"));
  reset_->setToolTip(tr("Those of the scene's file in place of the preset's"));
  for (QPushButton* b : {edit_, add_, remove_, reset_}) buttons->addWidget(b);
  buttons->addStretch(1);
  column->addLayout(buttons);
  table_->setHorizontalHeaderLabels({tr("x [m]"), tr("y [m]"), tr("z [m]")});
  table_->setAccessibleName(tr("Probes, by their places in metres"));
  table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 8);
  table_->horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
  table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  table_->setSelectionMode(QAbstractItemView::SingleSelection);
  table_->setTabKeyNavigation(false);
  column->addWidget(table_, 1);
  connect(edit_, &QPushButton::clicked, this, &ProbesPanel::editWanted);
  connect(add_, &QPushButton::clicked, this, [this] {
    if (const auto camera = document_.camera()) add(camera->position);
  });
  connect(remove_, &QPushButton::clicked, this, [this] {
    if (table_->currentRow() >= 0) remove(static_cast<size_t>(table_->currentRow()));
  });
  connect(reset_, &QPushButton::clicked, this, [this] { document_.editProbes(std::nullopt, false, tr("the scene's probes")); });
  connect(table_, &QTableWidget::cellChanged, this, &ProbesPanel::cellEdited);
  connect(table_, &QTableWidget::currentCellChanged, this, [this](int row) {
    remove_->setEnabled(row >= 0);
    if (!filling_) emit selected(row >= 0 ? std::optional(static_cast<size_t>(row)) : std::nullopt);
  });
  connect(&document_, &Document::probesChanged, this, &ProbesPanel::read);
  connect(&document_, &Document::presetChanged, this, &ProbesPanel::read);
  read();
}

bool ProbesPanel::byHand() const { return document_.parameter(kPlacement) == kManual; }

std::vector<vec3> ProbesPanel::probes() const {
  if (byHand()) return document_.probes();
  return frame_ && frame_->probes ? frame_->probes->positions : document_.probes();
}

void ProbesPanel::edit(std::vector<vec3> probes, const QString& what) { document_.editProbes(std::move(probes), true, what); }

void ProbesPanel::takeOver() {
  if (!byHand() && !probes().empty()) edit(probes(), tr("probes by hand"));
}

void ProbesPanel::add(const vec3& at) {
  std::vector<vec3> all = probes();
  all.push_back(at);
  edit(std::move(all), tr("add a probe"));
  select(document_.probes().size() - 1);
}

void ProbesPanel::move(size_t probe, const vec3& to) {
  std::vector<vec3> all = probes();
  if (probe >= all.size()) return;
  all[probe] = to;
  edit(std::move(all), tr("move probe %1").arg(probe + 1));
}

void ProbesPanel::remove(size_t probe) {
  std::vector<vec3> all = probes();
  if (probe >= all.size()) return;
  all.erase(all.begin() + static_cast<std::ptrdiff_t>(probe));
  edit(std::move(all), tr("delete probe %1").arg(probe + 1));
}

void ProbesPanel::select(std::optional<size_t> probe) {
  const int row = probe ? static_cast<int>(*probe) : -1;
  if (row != table_->currentRow() && row < table_->rowCount()) table_->setCurrentCell(row, 0);
}

void ProbesPanel::setEditing(bool on) { edit_->setChecked(on); }

void ProbesPanel::showFrame(std::shared_ptr<const FrameResult> frame) {
  const bool others = !frame_ || frame_->probes != frame->probes;
  frame_ = std::move(frame);
  if (others) read();
}

void ProbesPanel::read() {
  filling_ = true;
  const std::vector<vec3> all = probes();
  const PlacedProbes* placed = frame_ ? frame_->probes.get() : nullptr;
  QString text;
  if (!placed) {
    text = tr("%n probes by hand. ", nullptr, static_cast<int>(document_.probes().size())) + tr("The technique shown now has placed none.");
  } else {
    // As they were placed: another placement may wait for its rebuild.
    const auto& used = frame_->preset.parameters;
    const ParamInfo* declared = document_.catalog().parameter(document_.preset().technique, kPlacement);
    const auto named = used.find(kPlacement);
    const QString placement = QString::fromStdString(named != used.end() ? named->second : declared ? defaultText(*declared) : std::string()).replace(QLatin1Char('_'), QLatin1Char(' '));
    text = tr("%n probes see %1 % of all surface. Placement: %2 (%3 s); it is chosen under Technique, Probes.", nullptr, static_cast<int>(placed->count()))
               .arg(100 * placed->coverage, 0, 'f', 1)
               .arg(placement)
               .arg(placed->seconds, 0, 'f', 2);
    if (frame_->atlas.area > 0) text += tr(" Seen by none: %1 m².").arg((1 - placed->coverage) * frame_->atlas.area, 0, 'g', 4);
    QStringList left;
    if (placed->rejectedInside > 0) left << tr("%1 inside geometry").arg(placed->rejectedInside);
    if (placed->rejectedNear > 0) left << tr("%1 too near to surfaces").arg(placed->rejectedNear);
    if (placed->merged > 0) left << tr("%1 that see no more than others").arg(placed->merged);
    if (!left.isEmpty()) text += tr(" Left out of %1 places: %2.").arg(placed->candidates).arg(left.join(QStringLiteral(", ")));
    for (const std::string& warning : placed->warnings) text += QStringLiteral("\n") + QString::fromStdString(warning);
  }
  facts_->setText(text);
  table_->setRowCount(static_cast<int>(all.size()));
  for (size_t i = 0; i < all.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      QTableWidgetItem* item = table_->item(static_cast<int>(i), axis);
      if (!item) {
        item = new QTableWidgetItem;
        table_->setItem(static_cast<int>(i), axis, item);
      }
      const QString number = QString::number(static_cast<double>(all[i][axis]), 'g', 6);
      if (item->text() != number) item->setText(number);
      const bool buried = placed && byHand() && placed->count() == all.size() && placed->inside[i];
      item->setForeground(buried ? QBrush(QColor(200, 40, 30)) : QBrush());
      item->setToolTip(buried ? tr("Inside geometry") : QString());
    }
  remove_->setEnabled(table_->currentRow() >= 0);
  reset_->setEnabled(document_.preset().probes.has_value());
  filling_ = false;
}

/// What is no number is put back.
void ProbesPanel::cellEdited(int row, int axis) {
  std::vector<vec3> all = probes();
  if (filling_ || static_cast<size_t>(row) >= all.size()) return;
  bool number = false;
  const float value = table_->item(row, axis)->text().trimmed().toFloat(&number);
  vec3 to = all[static_cast<size_t>(row)];
  if (number && to[axis] != value) {
    to[axis] = value;
    try {
      checkProbes({to});
      move(static_cast<size_t>(row), to);
    } catch (const Error&) {
    }
  }
  read();
}

}  // namespace hl::ui
