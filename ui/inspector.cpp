#include "ui/inspector.h"

#include <QApplication>
#include <QBoxLayout>
#include <QClipboard>
#include <QHeaderView>
#include <QLabel>
#include <QPainter>
#include <QPushButton>
#include <QResizeEvent>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QTableWidget>
#include <algorithm>
#include <cmath>

#include "ui/comparison.h"
#include "ui/pick_overlay.h"

namespace hl::ui {
namespace {

enum Row { Technique, Matched, Full, LessMatched, LessFull, RowCount };
constexpr int kParts = 3, kColumns = 3 * kParts;  // indirect irradiance, the final picture, then light by lobes where there is any, by channel
constexpr int kLargestSide = 8192;
// By technique and reference.
constexpr const char* kImages[3][kParts] = {{"indirect_irradiance", "final", "specular"},
                                            {"reference_matched_indirect", "reference_matched", "reference_matched_specular"},
                                            {"reference_indirect", "reference", "reference_specular"}};

QString number(float v) { return QString::number(static_cast<double>(v), 'g', 5); }

const Image* imageOf(const FrameResult* frame, const char* name, QPoint pixel) {
  if (!frame) return nullptr;
  const auto found = frame->images.find(name);
  if (found == frame->images.end()) return nullptr;
  const Image& image = *found->second;
  return pixel.x() < image.width && pixel.y() < image.height ? &image : nullptr;
}

}  // namespace

Neighbourhood::Neighbourhood(const QString& name, QWidget* parent) : QWidget(parent), name_(name) {
  setAccessibleName(tr("Pixels round it: %1").arg(name));
  setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Fixed);
}

QSize Neighbourhood::sizeHint() const { return {(2 * kRadius + 1) * 9, (2 * kRadius + 1) * 9 + fontMetrics().height() + 2}; }
QSize Neighbourhood::minimumSizeHint() const { return sizeHint(); }

void Neighbourhood::show(const Image* image, QPoint pixel, const hl::Display& display) {
  constexpr int side = 2 * kRadius + 1;
  picture_ = {};
  if (image) {
    Image part(side, side, 3);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const int fromX = pixel.x() + x - kRadius, fromY = pixel.y() + y - kRadius;
        if (fromX >= 0 && fromY >= 0 && fromX < image->width && fromY < image->height) std::copy_n(image->pixel(fromX, fromY), 3, part.pixel(x, y));
      }
    picture_ = pictureOf(toneMapOnHost(part, display), side, side);
  }
  update();
}

void Neighbourhood::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  const QRectF box(0, 0, width(), height() - fontMetrics().height() - 2);
  painter.fillRect(box, QColor(38, 38, 38));
  if (!picture_.isNull()) {
    painter.drawImage(box, picture_);
    const double step = box.width() / (2 * kRadius + 1);
    const QRectF middle(box.x() + kRadius * step, box.y() + kRadius * step, step, step);
    painter.setPen(Qt::black);
    painter.drawRect(middle.adjusted(-1, -1, 1, 1));
    painter.setPen(Qt::white);
    painter.drawRect(middle);
  } else {
    painter.setPen(Qt::gray);
    painter.drawText(box, Qt::AlignCenter, QStringLiteral("-"));
  }
  painter.setPen(palette().color(QPalette::WindowText));
  painter.drawText(QRectF(0, box.bottom(), width(), fontMetrics().height() + 2), Qt::AlignCenter, name_);
}

InspectorPanel::InspectorPanel(EngineLink& link, Document& document, ImageFeed& feed, QWidget* parent)
    : QWidget(parent), link_(link), document_(document), feed_(feed), x_(new QSpinBox(this)), y_(new QSpinBox(this)), copy_(new QPushButton(tr("&Copy as text"), this)),
      trace_(new QPushButton(tr("&Trace the reference"), this)), technique_(new Neighbourhood(tr("Technique"), this)), matched_(new Neighbourhood(tr("Matched"), this)),
      full_(new Neighbourhood(tr("Full"), this)), table_(new QTableWidget(RowCount, kColumns, this)), facts_(new QLabel(this)) {
  parts_ = new QBoxLayout(QBoxLayout::LeftToRight, this);
  parts_->setContentsMargins(4, 4, 4, 4);
  auto* left = new QVBoxLayout;
  auto* line = new QHBoxLayout;
  for (const auto& [box, name] : {std::pair{x_, tr("&x")}, {y_, tr("&y")}}) {
    auto* label = new QLabel(name, this);
    label->setBuddy(box);
    box->setRange(0, kLargestSide - 1);
    box->setAccessibleName(tr("Pixel's %1").arg(QString(name).remove('&')));
    box->setKeyboardTracking(false);
    line->addWidget(label);
    line->addWidget(box);
    connect(box, &QSpinBox::valueChanged, this, [this] { inspect(x_->value(), y_->value()); });
  }
  line->addWidget(copy_);
  line->addStretch(1);
  left->addLayout(line);
  auto* pictures = new QHBoxLayout;
  for (Neighbourhood* n : {technique_, matched_, full_}) pictures->addWidget(n);
  pictures->addStretch(1);
  left->addLayout(pictures);
  left->addWidget(trace_);
  left->addStretch(1);
  parts_->addLayout(left);
  table_->setVerticalHeaderLabels({tr("Technique"), tr("Matched reference"), tr("Full reference"), tr("minus matched"), tr("minus full")});
  table_->setHorizontalHeaderLabels({tr("Indirect R"), tr("G"), tr("B"), tr("Final R"), tr("G"), tr("B"), tr("Specular R"), tr("G"), tr("B")});
  table_->horizontalHeaderItem(0)->setToolTip(tr("Indirect irradiance, linear"));
  table_->horizontalHeaderItem(3)->setToolTip(tr("Radiance towards the camera, linear"));
  table_->horizontalHeaderItem(6)->setToolTip(tr("Indirect radiance that the glossy lobe reflects towards the camera, linear"));
  table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table_->setTabKeyNavigation(false);
  table_->setAccessibleName(tr("Values of the pixel"));
  table_->setMinimumHeight(6 * (fontMetrics().height() + 8));
  for (int c = 0; c < kColumns; ++c) table_->setColumnWidth(c, fontMetrics().horizontalAdvance(QLatin1Char('0')) * 10);
  for (int r = 0; r < RowCount; ++r)
    for (int c = 0; c < kColumns; ++c) {
      auto* item = new QTableWidgetItem;
      item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
      table_->setItem(r, c, item);
    }
  parts_->addWidget(table_, 3);
  facts_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  facts_->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  facts_->setWordWrap(true);
  facts_->setTextFormat(Qt::PlainText);
  facts_->setAccessibleName(tr("About the point"));
  parts_->addWidget(facts_, 2);
  connect(copy_, &QPushButton::clicked, this, [this] { QApplication::clipboard()->setText(text()); });
  connect(trace_, &QPushButton::clicked, this, &InspectorPanel::referenceNeeded);
  connect(&document_, &Document::displayChanged, this, &InspectorPanel::draw);
  draw();
}

void InspectorPanel::inspect(int x, int y) {
  const Preset& p = document_.preset();
  const QPoint wanted(std::clamp(x, 0, p.width - 1), std::clamp(y, 0, p.height - 1));
  const QSignalBlocker a(x_), b(y_);
  x_->setValue(wanted.x()), y_->setValue(wanted.y());
  if (pixel_ != wanted) {
    pixel_ = wanted;
    link_.pick(wanted.x(), wanted.y());
    emit pixelChanged(wanted.x(), wanted.y());
  }
  wantImages();
  draw();
}

void InspectorPanel::wantImages() {
  std::set<std::string> names;
  for (const auto& row : kImages)
    for (int part = 0; pixel_ && isVisible() && part < (glossy() ? kParts : kParts - 1); ++part) names.insert(row[part]);
  feed_.want(this, names);
}

void InspectorPanel::showFrame(std::shared_ptr<const FrameResult> frame) {
  const bool before = glossy();
  frame_ = std::move(frame);
  if (glossy() != before) wantImages();
  if (isVisible()) draw();
}

void InspectorPanel::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  wantImages();
  draw();
}

void InspectorPanel::hideEvent(QHideEvent* event) {
  QWidget::hideEvent(event);
  wantImages();
}

void InspectorPanel::draw() {
  const QPoint at = pixel_.value_or(QPoint());
  const Image* images[3][kParts] = {};
  if (pixel_)
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < kParts; ++c) images[r][c] = imageOf(frame_.get(), kImages[r][c], at);
  const auto put = [&](int row, int column, const QString& text) {
    QTableWidgetItem* item = table_->item(row, column);
    if (item->text() != text) item->setText(text);
  };
  for (int c = 0; c < kColumns; ++c) {
    table_->setColumnHidden(c, c / 3 == 2 && !glossy());
    const auto value = [&](int row) { return images[row][c / 3] ? std::optional<float>(images[row][c / 3]->pixel(at.x(), at.y())[c % 3]) : std::nullopt; };
    for (int r = 0; r < 3; ++r) put(r, c, value(r) ? number(*value(r)) : QStringLiteral("-"));
    for (const int r : {Matched, Full}) put(r == Matched ? LessMatched : LessFull, c, value(Technique) && value(r) ? number(*value(Technique) - *value(r)) : QStringLiteral("-"));
  }
  technique_->show(images[0][1], at, document_.preset().display);
  matched_->show(images[1][1], at, document_.preset().display);
  full_->show(images[2][1], at, document_.preset().display);
  trace_->setVisible(pixel_ && !images[2][1]);
  copy_->setEnabled(pixel_.has_value());
  QStringList facts;
  if (!pixel_) facts << tr("Right click in the picture, or type a pixel's place.");
  if (pixel_ && frame_ && frame_->picked.x == at.x() && frame_->picked.y == at.y()) {
    const PickedPoint& p = frame_->picked;
    const auto vector = [](const vec3& v) { return QStringLiteral("(%1, %2, %3)").arg(number(v.x), number(v.y), number(v.z)); };
    if (p.triangle == kNone)
      facts << tr("no surface");
    else
      facts << tr("position %1 m").arg(vector(p.position)) << tr("normal %1").arg(vector(p.normal)) << tr("triangle %1").arg(p.triangle)
            << tr("lightmap (%1, %2)").arg(number(p.lightmapUv.x), number(p.lightmapUv.y));
    if (const QString more = pickedFacts(*frame_); !more.isEmpty()) facts << more;
  }
  const QString text = facts.join('\n');
  if (facts_->text() != text) facts_->setText(text);
}

QString InspectorPanel::text() const {
  if (!pixel_) return {};
  QStringList lines{tr("Pixel %1, %2").arg(pixel_->x()).arg(pixel_->y())};
  QStringList head{QString()};
  for (const char* name : {"indirect R", "indirect G", "indirect B", "final R", "final G", "final B", "specular R", "specular G", "specular B"})
    if (head.size() <= (glossy() ? kColumns : kColumns - 3)) head << QString::fromLatin1(name);
  lines << head.join('\t');
  for (int r = 0; r < RowCount; ++r) {
    QStringList cells{table_->verticalHeaderItem(r)->text()};
    for (int c = 0; c < (glossy() ? kColumns : kColumns - 3); ++c) cells << table_->item(r, c)->text();
    lines << cells.join('\t');
  }
  lines << facts_->text();
  return lines.join('\n') + '\n';
}

void InspectorPanel::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  // Side by side only where the table keeps its columns.
  parts_->setDirection(width() > fontMetrics().horizontalAdvance(QLatin1Char('0')) * 110 ? QBoxLayout::LeftToRight : QBoxLayout::TopToBottom);
}

}  // namespace hl::ui
