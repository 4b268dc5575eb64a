#include "ui/rebuild_bar.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QLocale>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/document.h"
#include "ui/work_line.h"

namespace hl::ui {
namespace {

constexpr int kPatienceMs = 300;

/// Three digits: "27 MB".
QString bytesText(double bytes) {
  const auto digits = [](double v) { return QString::number(v, 'f', v < 10 ? 1 : 0); };
  if (bytes >= 1e9) return QStringLiteral("%1 GB").arg(digits(bytes / 1e9));
  return bytes >= 1e6 ? QStringLiteral("%1 MB").arg(digits(bytes / 1e6)) : QStringLiteral("%1 kB").arg(digits(bytes / 1e3));
}

QString raysText(double rays) {
  if (rays >= 1e9) return RebuildBar::tr("%1 thousand million rays").arg(rays / 1e9, 0, 'f', 1);
  if (rays >= 1e6) return RebuildBar::tr("%1 million rays").arg(rays / 1e6, 0, 'f', rays < 1e7 ? 1 : 0);
  return RebuildBar::tr("%1 rays").arg(QLocale::c().toString(rays, 'f', 0));
}

QString forecastLine(const RebuildForecast& f) {
  if (!f.refused.empty()) return RebuildBar::tr("Cannot be: %1").arg(QString::fromStdString(f.refused));
  QString warnings;
  for (const std::string& w : f.warnings) warnings += QStringLiteral("\n") + QString::fromStdString(w);
  if (f.seconds < 0) return RebuildBar::tr("Rebuild") + warnings;
  const QString time = durationText(f.seconds);
  QString text = f.work.atMost ? RebuildBar::tr("Rebuild: at most about %1").arg(time) : RebuildBar::tr("Rebuild: about %1").arg(time);
  if (f.basis == ForecastBasis::Calibrated) text += RebuildBar::tr(" (a rough guess: no such work was done here yet)");
  if (f.basis == ForecastBasis::OtherScene) text += RebuildBar::tr(" (by another scene's speed)");
  text += QStringLiteral("; ") + raysText(f.work.rays) + QStringLiteral(", ") + bytesText(f.work.bytes);
  if (f.work.bytesBefore > 0) text += RebuildBar::tr(" (%1 before compression)").arg(bytesText(f.work.bytesBefore));
  if (f.work.bytesOfFrames > 0) text += RebuildBar::tr(", %1 for its frames").arg(bytesText(f.work.bytesOfFrames));
  if (f.work.bytesMore > 0) text += RebuildBar::tr(", at most %1 more").arg(bytesText(f.work.bytesMore));
  return text + warnings;
}

QString partsText(const RebuildForecast& f) {
  QString text;
  for (const auto& [name, seconds] : f.parts) text += RebuildBar::tr("%1: %2 s").arg(QString::fromStdString(name)).arg(seconds, 0, 'f', 2) + QStringLiteral("\n");
  return text.trimmed();
}

}  // namespace

RebuildBar::RebuildBar(Document& document, QWidget* parent)
    : QFrame(parent), document_(document), label_(new QLabel(this)), rebuild_(new QPushButton(tr("Re&build"), this)), revert_(new QPushButton(tr("Re&vert"), this)) {
  setFrameShape(QFrame::StyledPanel);
  auto* column = new QVBoxLayout(this);
  label_->setWordWrap(true);
  label_->setTextFormat(Qt::PlainText);
  label_->setAccessibleName(tr("What a rebuild takes"));
  column->addWidget(label_);
  auto* line = new QHBoxLayout;
  line->addStretch(1);
  rebuild_->setToolTip(tr("Precompute with the values as they stand now"));
  revert_->setToolTip(tr("Back to the values that the picture was made with"));
  line->addWidget(rebuild_);
  line->addWidget(revert_);
  column->addLayout(line);
  connect(rebuild_, &QPushButton::clicked, this, [this] { document_.pendingRebuild().make(); });
  connect(revert_, &QPushButton::clicked, this, [this] { document_.revertRebuild(); });
  connect(&document_.pendingRebuild(), &PendingRebuild::changed, this, &RebuildBar::refresh);
  patience_.setSingleShot(true);
  patience_.setInterval(kPatienceMs);
  connect(&patience_, &QTimer::timeout, this, [this] {
    if (!document_.pendingRebuild().waits() || document_.pendingRebuild().forecast()) return;
    label_->setText(tr("Rebuild: being estimated"));
    label_->setToolTip({});
    rebuild_->setEnabled(true);
    setVisible(true);
  });
  refresh();
}

QString RebuildBar::text() const { return label_->text(); }

void RebuildBar::refresh() {
  const PendingRebuild& pending = document_.pendingRebuild();
  if (!pending.waits()) {
    patience_.stop();
    setVisible(false);
  } else if (const auto& f = pending.forecast()) {
    patience_.stop();
    label_->setText(forecastLine(*f));
    label_->setToolTip(partsText(*f));
    rebuild_->setEnabled(f->refused.empty());
    setVisible(true);
  } else if (!patience_.isActive()) {
    patience_.start();
  }
}

}  // namespace hl::ui
