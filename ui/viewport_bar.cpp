#include "ui/viewport_bar.h"

#include <QAbstractItemView>
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QRegularExpression>
#include <QSignalBlocker>
#include <QToolButton>

#include "engine/metrics/metrics.h"

namespace hl::ui {
namespace {

constexpr double kExposureLimit = 20;  // stops
constexpr double kHalfStop = 0.5;
const QList<QSize> kResolutions{{320, 180}, {640, 360}, {960, 540}, {1280, 720}, {1920, 1080}, {512, 512}, {1024, 1024}};

QString sizeText(int w, int h) { return QStringLiteral("%1 \u00d7 %2").arg(w).arg(h); }

}  // namespace

ViewportBar::ViewportBar(Document& document, QWidget* parent)
    : QWidget(parent),
      document_(document),
      view_(new QComboBox(this)),
      errorMetric_(new QComboBox(this)),
      exposure_(new QDoubleSpinBox(this)),
      toneMap_(new QComboBox(this)),
      invalid_(new QCheckBox(tr("Invalid pixels"), this)),
      resolution_(new QComboBox(this)),
      figures_(new QLabel(this)) {
  auto* line = new QHBoxLayout(this);
  line->setContentsMargins(6, 3, 6, 3);
  const auto labelled = [&](const QString& text, QWidget* w) {
    auto* label = new QLabel(text, this);
    label->setBuddy(w);
    line->addWidget(label);
    line->addWidget(w);
    w->setAccessibleName(text);
    line->addSpacing(6);
  };
  view_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  view_->setMinimumContentsLength(14);
  view_->view()->setMinimumWidth(fontMetrics().horizontalAdvance(QLatin1Char('0')) * 36);
  labelled(tr("View"), view_);
  errorMetric_->setAccessibleName(tr("Metric of the error view"));
  errorMetric_->setToolTip(tr("Whose map is shown. FLIP and SSIM end at 1 (magma), signed errors run from blue to red, the others end where 98 % of the pixels do"));
  for (const MetricInfo& m : metricInfos())
    errorMetric_->addItem(QString::fromUtf8(m.label.data(), static_cast<qsizetype>(m.label.size())), QString::fromUtf8(m.id.data(), static_cast<qsizetype>(m.id.size())));
  line->addWidget(errorMetric_);
  exposure_->setRange(-kExposureLimit, kExposureLimit);
  exposure_->setSingleStep(kHalfStop);
  exposure_->setDecimals(2);
  exposure_->setSuffix(tr(" stops"));
  exposure_->setKeyboardTracking(false);
  exposure_->setToolTip(tr("Exposure. E adds half a stop, Shift+E takes it away"));
  labelled(tr("Exposure"), exposure_);
  toneMap_->addItems({tr("Linear"), tr("ACES"), tr("Reinhard")});
  toneMap_->setToolTip(tr("Tone map, before the sRGB curve"));
  labelled(tr("Tone map"), toneMap_);
  invalid_->setToolTip(tr("Pixels that are NaN, infinite or negative, in loud colours"));
  line->addWidget(invalid_);
  line->addSpacing(6);
  resolution_->setEditable(true);
  resolution_->setInsertPolicy(QComboBox::NoInsert);
  for (const QSize s : kResolutions) resolution_->addItem(sizeText(s.width(), s.height()), s);
  resolution_->setToolTip(tr("Resolution of the picture; the window only scales it. Others can be typed"));
  labelled(tr("Size"), resolution_);
  figures_->setTextFormat(Qt::PlainText);
  figures_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  figures_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  figures_->setMinimumWidth(fontMetrics().horizontalAdvance(QStringLiteral("00000   000.0 ms")));
  line->addWidget(figures_, 1);

  connect(view_, &QComboBox::activated, this, [this] { changed(tr("view %1").arg(view_->currentText())); });
  connect(errorMetric_, &QComboBox::activated, this, [this] { changed(tr("error map %1").arg(errorMetric_->currentText())); });
  connect(exposure_, &QDoubleSpinBox::valueChanged, this, [this] { changed(tr("exposure")); });
  connect(toneMap_, &QComboBox::activated, this, [this] { changed(tr("tone map %1").arg(toneMap_->currentText())); });
  connect(invalid_, &QCheckBox::toggled, this, [this] { changed(tr("invalid pixels")); });
  connect(resolution_, &QComboBox::textActivated, this, [this](const QString& text) {
    static const QRegularExpression pair(QStringLiteral("^\\s*(\\d{1,5})\\s*[x\u00d7*, ]\\s*(\\d{1,5})\\s*$"));
    const QRegularExpressionMatch m = pair.match(text);
    if (m.hasMatch()) document_.editResolution(m.captured(1).toInt(), m.captured(2).toInt());
    readDocument();
  });
  connect(&document_, &Document::techniqueChanged, this, &ViewportBar::readViews);
  connect(&document_, &Document::displayChanged, this, &ViewportBar::readDocument);
  connect(&document_, &Document::presetChanged, this, &ViewportBar::readDocument);
  readViews();
}

void ViewportBar::readViews() {
  const QSignalBlocker block(view_);
  view_->clear();
  const size_t common = displayViews().size();
  const std::vector<ViewInfo> views = document_.catalog().views(document_.preset().technique);
  for (size_t i = 0; i < views.size(); ++i) {
    if (i == common) view_->insertSeparator(view_->count());
    view_->addItem(QString::fromStdString(views[i].label), QString::fromStdString(views[i].id));
  }
  readDocument();
}

void ViewportBar::readDocument() {
  const Preset& p = document_.preset();
  const QSignalBlocker a(view_), b(exposure_), c(toneMap_), d(invalid_), e(resolution_);
  view_->setCurrentIndex(view_->findData(QString::fromStdString(p.display.view)));
  errorMetric_->setCurrentIndex(errorMetric_->findData(QString::fromStdString(p.display.errorMetric)));
  errorMetric_->setVisible(p.display.view.rfind("error", 0) == 0);
  exposure_->setValue(p.display.exposure);
  toneMap_->setCurrentIndex(static_cast<int>(p.display.toneMap));
  invalid_->setChecked(p.display.showInvalid);
  resolution_->setEditText(sizeText(p.width, p.height));
}

void ViewportBar::changed(const QString& what, quint64 drag) {
  Display display = document_.preset().display;
  display.view = view_->currentData().toString().toStdString();
  display.errorMetric = errorMetric_->currentData().toString().toStdString();
  display.exposure = static_cast<float>(exposure_->value());
  display.toneMap = static_cast<ToneMap>(toneMap_->currentIndex());
  display.showInvalid = invalid_->isChecked();
  document_.editDisplay(display, what, drag);
}

void ViewportBar::addTool(QAction* action) {
  auto* button = new QToolButton(this);
  button->setDefaultAction(action);
  button->setAccessibleName(action->text());
  static_cast<QHBoxLayout*>(layout())->insertWidget(layout()->indexOf(figures_), button);
}

void ViewportBar::showFrame(const FrameResult& f) {
  const QString ms = QString::number(f.frameTime.meanMs, 'f', 1);
  QString warning;
  for (const auto& [name, count] : f.counters)
    if (count > 0 && (name == "nan_inf" || name == "negative")) warning = tr("%1 %2 pixels!   ").arg(count, 0, 'f', 0).arg(name == "negative" ? tr("negative") : tr("NaN or Inf")) + warning;
  // From what is said in full to what has to be said.
  figureTexts_ = {warning + tr("frame %1   %2 ms").arg(f.frame).arg(ms), warning + tr("%1   %2 ms").arg(f.frame).arg(ms)};
  if (!warning.isEmpty()) figureTexts_ << warning.trimmed();
  figures_->setToolTip(tr("Frames since the last reset, and the median time of a frame") + QLatin1Char('\n') + figureTexts_.front());
  fitFigures();
}

void ViewportBar::fitFigures() {
  const QFontMetrics metrics = figures_->fontMetrics();
  for (const QString& text : figureTexts_)
    if (metrics.horizontalAdvance(text) <= figures_->width()) return figures_->setText(text);
  if (!figureTexts_.isEmpty()) figures_->setText(metrics.elidedText(figureTexts_.back(), Qt::ElideRight, figures_->width()));
}

void ViewportBar::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  layout()->activate();  // so that the label has its new width
  fitFigures();
}

}  // namespace hl::ui
