#include "ui/regions_editor.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

namespace hl::ui {
namespace {

enum Column { Name, Left, Top, Width, Height, ColumnCount };

int pixels(float share, int of) { return static_cast<int>(std::lround(share * static_cast<float>(of))); }

}  // namespace

RegionsEditor::RegionsEditor(Document& document, QWidget* parent)
    : QWidget(parent), document_(document), table_(new QTableWidget(0, ColumnCount, this)), remove_(new QPushButton(tr("&Remove"), this)), reset_(new QPushButton(tr("The scene's &own"), this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  auto* buttons = new QHBoxLayout;
  auto* draw = new QPushButton(tr("&Draw"), this);
  draw->setToolTip(tr("Drag a rectangle in the picture (R). With Ctrl and Shift held, at any time"));
  auto* append = new QPushButton(tr("&Add"), this);
  append->setToolTip(tr("The middle of the picture; then change its numbers"));
  for (QPushButton* b : {draw, append, remove_, reset_}) buttons->addWidget(b);
  buttons->addStretch(1);
  column->addLayout(buttons);
  table_->setHorizontalHeaderLabels({tr("Region"), tr("Left"), tr("Top"), tr("Width"), tr("Height")});
  table_->setAccessibleName(tr("Regions, in pixels of the picture"));
  table_->verticalHeader()->hide();
  table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 8);
  table_->horizontalHeader()->setSectionResizeMode(Name, QHeaderView::Stretch);
  table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  table_->setTabKeyNavigation(false);
  const int em = fontMetrics().horizontalAdvance(QLatin1Char('0'));
  for (int c = Left; c < ColumnCount; ++c) table_->setColumnWidth(c, 8 * em);
  column->addWidget(table_, 1);
  connect(draw, &QPushButton::clicked, this, &RegionsEditor::drawWanted);
  connect(append, &QPushButton::clicked, this, [this] { add({0.25, 0.25, 0.5, 0.5}); });
  connect(remove_, &QPushButton::clicked, this, [this] {
    std::vector<Region> regions = document_.regions();
    const auto row = static_cast<size_t>(std::max(0, table_->currentRow()));
    if (row >= regions.size()) return;
    regions.erase(regions.begin() + static_cast<std::ptrdiff_t>(row));
    document_.editRegions(regions, tr("remove a region"));
  });
  connect(reset_, &QPushButton::clicked, this, [this] { document_.editRegions(std::nullopt, tr("the scene's regions")); });
  connect(table_, &QTableWidget::cellChanged, this, &RegionsEditor::cellEdited);
  connect(table_, &QTableWidget::currentCellChanged, this, [this](int row) { remove_->setEnabled(row >= 0); });
  connect(&document_, &Document::regionsChanged, this, &RegionsEditor::read);
  connect(&document_, &Document::presetChanged, this, &RegionsEditor::read);
  read();
}

void RegionsEditor::add(const QRectF& shares) {
  std::vector<Region> regions = document_.regions();
  Region r;
  int number = 1;
  do r.name = tr("region %1").arg(number++).toStdString();
  while (std::any_of(regions.begin(), regions.end(), [&](const Region& other) { return other.name == r.name; }));
  r.x = static_cast<float>(shares.x()), r.y = static_cast<float>(shares.y());
  r.width = static_cast<float>(shares.width()), r.height = static_cast<float>(shares.height());
  regions.push_back(r);
  document_.editRegions(regions, tr("draw %1").arg(QString::fromStdString(r.name)));
}

void RegionsEditor::read() {
  filling_ = true;
  const std::vector<Region> regions = document_.regions();
  const Preset& p = document_.preset();
  table_->setRowCount(static_cast<int>(regions.size()));
  for (size_t i = 0; i < regions.size(); ++i) {
    const Region& r = regions[i];
    const QString texts[ColumnCount] = {QString::fromStdString(r.name), QString::number(pixels(r.x, p.width)), QString::number(pixels(r.y, p.height)),
                                        QString::number(pixels(r.width, p.width)), QString::number(pixels(r.height, p.height))};
    for (int c = 0; c < ColumnCount; ++c) {
      QTableWidgetItem* item = table_->item(static_cast<int>(i), c);
      if (!item) {
        item = new QTableWidgetItem;
        table_->setItem(static_cast<int>(i), c, item);
      }
      if (item->text() != texts[c]) item->setText(texts[c]);
    }
  }
  remove_->setEnabled(table_->currentRow() >= 0);
  reset_->setEnabled(document_.preset().regions.has_value());
  filling_ = false;
}

/// What makes no region is put back.
void RegionsEditor::cellEdited(int row, int column) {
  std::vector<Region> regions = document_.regions();
  if (filling_ || static_cast<size_t>(row) >= regions.size()) return;
  Region& r = regions[static_cast<size_t>(row)];
  const QString text = table_->item(row, column)->text().trimmed();
  const Preset& p = document_.preset();
  bool number = false;
  const int value = text.toInt(&number);
  const auto share = [&](int of) { return static_cast<float>(value) / static_cast<float>(of); };
  if (column == Name) r.name = text.toStdString();
  if (column == Left && number) r.x = share(p.width);
  if (column == Top && number) r.y = share(p.height);
  if (column == Width && number) r.width = share(p.width);
  if (column == Height && number) r.height = share(p.height);
  try {
    checkRegions(regions);
    document_.editRegions(regions, tr("region %1").arg(QString::fromStdString(r.name)));
  } catch (const Error&) {
  }
  read();
}

void RegionsEditor::showEvent(QShowEvent* event) {
  emit shown(true);
  QWidget::showEvent(event);
}

void RegionsEditor::hideEvent(QHideEvent* event) {
  emit shown(false);
  QWidget::hideEvent(event);
}

}  // namespace hl::ui
